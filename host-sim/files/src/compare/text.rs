//! A comparison in words.

use std::fmt::Write;

use super::{ColumnDifference, Comparison, EdgeComparison, Matching, Origin};

/// Summary of a comparison, several lines.
pub fn summary(comparison: &Comparison) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_summary(comparison, &mut text);
    text
}

fn write_summary(comparison: &Comparison, text: &mut String) -> std::fmt::Result {
    for (name, run) in ["A", "B"].iter().zip(&comparison.runs) {
        writeln!(
            text,
            "{name}  {}: {} rows, {} to {} s, one every {} ms",
            run.path,
            run.rows,
            digits(run.from_s),
            digits(run.to_s),
            digits(run.spacing_s * 1e3),
        )?;
    }
    let origin = comparison.times_from.name();
    writeln!(text, "Times are counted since {origin}.")?;
    let how = match comparison.matching {
        Matching::CommonRows => "at which both have a row",
        Matching::BetweenRowsOfSecond => {
            "of rows of A; between rows of B, integers, states and measured phase errors are held, and other columns interpolated"
        }
        Matching::BetweenRowsOfFirst => {
            "of rows of B; between rows of A, integers, states and measured phase errors are held, and other columns interpolated"
        }
    };
    writeln!(
        text,
        "Compared at {} times {how}, {} to {} s.\n",
        comparison.points,
        digits(comparison.from_s),
        digits(comparison.to_s)
    )?;
    writeln!(
        text,
        "{:<22} {:>10} {:>12} {:>12} {:>12} {:>12}",
        "column", "tolerance", "largest B-A", "at, s", "rms", "beyond at, s"
    )?;
    for column in &comparison.columns {
        write_column(column, text)?;
    }
    text.push('\n');
    for surplus in &comparison.surplus {
        let changes = match &surplus.changes {
            Some((at_s, column)) => format!("{column} changes at {} s", digits(*at_s)),
            None => "nothing changes there".to_owned(),
        };
        writeln!(
            text,
            "Only {} covers {} to {} s; {changes}.",
            surplus.of,
            digits(surplus.from_s),
            digits(surplus.to_s)
        )?;
    }
    match &comparison.events {
        Some(events) if events.at_s.is_none() => {
            writeln!(
                text,
                "Events: {} states and faults, all equal.",
                events.equal
            )?;
        }
        Some(events) => {
            let [first, second] = events
                .events
                .each_ref()
                .map(|event| event.as_deref().unwrap_or("no further event"));
            writeln!(
                text,
                "Events: {} equal; then A has {} and B {} more. A: {first}. B: {second}.",
                events.equal, events.first_has, events.second_has
            )?;
        }
        None => writeln!(text, "Events: not compared, as a run has no report.json.")?,
    }
    match &comparison.edges {
        Some(edges) => write_edges(edges, text)?,
        None => writeln!(text, "Edges: not compared, as a run has no steps.vcd.")?,
    }
    let Some(part) = &comparison.parts else {
        return writeln!(text, "The runs are equal within the tolerances.");
    };
    writeln!(
        text,
        "The runs part at {} s: {}.",
        digits(part.at_s),
        part.what
    )?;
    if let (Origin::PowerUp, [Some(first), Some(second)]) = (
        comparison.times_from,
        comparison.runs.each_ref().map(|run| run.starts_s),
    ) && first != second
    {
        writeln!(
            text,
            "A leaves idle at {} s, and B at {} s; --from start counts times from there.",
            digits(first),
            digits(second)
        )?;
    }
    Ok(())
}

fn write_column(column: &ColumnDifference, text: &mut String) -> std::fmt::Result {
    let name = &column.name;
    if column.compared == 0 {
        return writeln!(text, "{name:<22} not compared, as a run has no values");
    }
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), digits);
    write!(
        text,
        "{name:<22} {:>10} {:>12} {:>12} {:>12} {:>12}",
        digits(column.tolerance),
        number(column.max),
        number(column.max_at_s),
        number(column.rms),
        number(column.exceeds_at_s),
    )?;
    if let Some([first, second]) = &column.values {
        write!(text, "  A {first}, B {second}")?;
    }
    text.push('\n');
    Ok(())
}

fn write_edges(edges: &EdgeComparison, text: &mut String) -> std::fmt::Result {
    if edges.from_s >= edges.to_s {
        return writeln!(
            text,
            "Edges: not compared, as the windows of both steps.vcd have no time in common."
        );
    }
    write!(
        text,
        "Edges from {} to {} s: {} equal, {} shifted (by at most {} ns), {} only in A, {} only in B",
        digits(edges.from_s),
        digits(edges.to_s),
        edges.total(|wire| wire.equal),
        edges.total(|wire| wire.shifted),
        edges.max_shift_ns(),
        edges.total(|wire| wire.only_first),
        edges.total(|wire| wire.only_second),
    )?;
    let first = edges
        .wires
        .iter()
        .filter_map(|wire| Some((wire.differs_at_s?, &wire.name)))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    match first {
        Some((at_s, name)) => writeln!(
            text,
            "; the first that differs is of {name}, at {at_s:.9} s."
        )?,
        None => writeln!(text, ".")?,
    }
    if !edges.unknown.is_empty() {
        writeln!(
            text,
            "Not compared: {}, unknown in a run.",
            edges.unknown.join(", ")
        )?;
    }
    Ok(())
}

/// Formats a number with as many digits as a table needs.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.abs() >= 1e-3 && value.abs() < 1e7 {
        let text = format!("{value:.6}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{value:.3e}")
}
