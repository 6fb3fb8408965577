//! `docs/reproduced.md` as text.

use std::fmt::Write;

use super::{Figure, Section, Tolerance};

const HEAD: &str = "# Published figures, reproduced

`cophase reproduced --out docs/reproduced.md` writes this page. It compares published figures with those of this project. The published ones
are printed by the source of a machine, or were calculated from it independently of this project. A tolerance is half a unit of the figure's last
place, unless the source's list gives another one. The named test asserts each figure. Printed figures that do not follow from their own inputs are explained in
[the design command](design-command.md#where-the-print-and-we-differ).
";

/// Writes the page.
#[must_use]
pub fn write_page(sections: &[Section]) -> String {
    let mut page = HEAD.to_owned();
    let all = || sections.iter().flat_map(|section| &section.figures);
    let missed = all()
        .filter(|figure| figure.tolerance == Tolerance::NotReproduced)
        .count();
    // Writing to a String does not fail.
    let _ = writeln!(
        page,
        "\n{} of {} figures are reproduced. The remaining {missed} have the reason beside them.",
        all().count() - missed,
        all().count()
    );
    for section in sections {
        let _ = write_section(&mut page, section);
    }
    page
}

fn write_section(page: &mut String, section: &Section) -> std::fmt::Result {
    writeln!(
        page,
        "\n## {}\n\n{}\n\n    {}\n",
        section.title, section.source, section.command
    )?;
    writeln!(
        page,
        "| item | quantity | published or calculated | ours | difference | tolerance | test | |"
    )?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- | --- |")?;
    for figure in &section.figures {
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | `{}` | {} |",
            figure.item,
            figure.what,
            list(&figure.published, plain),
            list(&figure.ours, seven),
            difference(figure),
            tolerance(figure.tolerance),
            figure.test.1,
            figure.note
        )?;
    }
    Ok(())
}

fn list(values: &[f64], text: fn(f64) -> String) -> String {
    let all: Vec<String> = values.iter().copied().map(text).collect();
    all.join(", ")
}

/// Formats a published value with its own digits.
fn plain(value: f64) -> String {
    minus(format!("{value}"))
}

/// Formats a value with seven digits, without zeros at the end.
fn seven(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let before = value.abs().log10().floor() as i32 + 1;
    let digits = (7 - before).clamp(0, 12) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    minus(text.to_owned())
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

fn difference(figure: &Figure) -> String {
    match figure.difference() {
        // A smaller difference is rounding, which may differ on another platform.
        off if off < 1e-9 => "0".to_owned(),
        off => format!("{off:.1e}"),
    }
}

fn tolerance(tolerance: Tolerance) -> String {
    match tolerance {
        Tolerance::Absolute(max) if max < 1e-4 => format!("{max:e}"),
        Tolerance::Absolute(max) => format!("{max}"),
        Tolerance::Relative(max) => format!("{} %", seven(100.0 * max)),
        Tolerance::NotReproduced => "**not reproduced**".to_owned(),
    }
}
