//! Figures of a campaign as a Markdown table that is readable in a terminal, too.

use std::fmt::Write as _;

use super::interval::Rate;
use super::plan::strata::sensor;
use super::rates;
use super::shards::{Header, MACHINES};
use super::tally::{Failure, Group, Tally};

/// Largest number of cases that are listed for each failure.
const MAX_NAMED: usize = 12;

/// Returns the complete text: the runs, the table, and the failures.
pub fn text(header: &Header, tally: &Tally) -> String {
    let mut text = String::new();
    let cases = header.numbers.end - header.numbers.start;
    let _ = writeln!(
        text,
        "{cases} faulty runs and {cases} clean ones, {:.1} hours simulated: cases {} to {} of seed {}, {}{}.\n",
        tally.simulated_s / 3600.0,
        header.numbers.start,
        header.numbers.end.saturating_sub(1),
        header.seed,
        match header.scene.as_str() {
            MACHINES => "machines drawn".to_owned(),
            scene => format!("scene {scene}"),
        },
        match &header.selection {
            Some(selection) => format!(", counted among {selection}"),
            None => String::new(),
        }
    );
    let mut rows = vec![HEADER.map(str::to_owned).to_vec()];
    for ((kind, encoder), group) in &tally.groups {
        rows.push(row(kind.name(), sensor(*encoder), group));
    }
    let all = if tally.is_selected { "these" } else { "all" };
    rows.push(row(all, "", &tally.all));
    text.push_str(&in_columns(&rows));
    text.push('\n');
    match &header.selection {
        Some(selection) => text.push_str(&rates::text(selection, tally)),
        None => rates_over_all(&mut text, tally),
    }
    failures(&mut text, header, tally);
    text
}

/// Writes the rates of a campaign that simulates all cases.
fn rates_over_all(text: &mut String, tally: &Tally) {
    let _ = writeln!(
        text,
        "False trips: {} of {} clean runs; {}.",
        tally.false_trips.hits,
        tally.false_trips.of,
        bounds(tally.false_trips)
    );
    let _ = writeln!(
        text,
        "Detected in time: {} of {} in which a crank passed its limit; {}.",
        tally.all.in_time.hits,
        tally.all.in_time.of,
        bounds(tally.all.in_time)
    );
    let _ = writeln!(
        text,
        "Rightly named: {} of {}; {}.",
        tally.all.named.hits,
        tally.all.named.of,
        bounds(tally.all.named)
    );
    let _ = writeln!(
        text,
        "Left running: {} of {}; {}.",
        tally.all.left_running.hits,
        tally.all.left_running.of,
        bounds(tally.all.left_running)
    );
}

const HEADER: [&str; 14] = [
    "fault",
    "seen by",
    "runs",
    "beyond limit",
    "in time",
    "turns, half",
    "95 %",
    "99 %",
    "all",
    "named rightly",
    "at least",
    "tilt/limit",
    "tilt/bound",
    "off/limit",
];

fn row(name: &str, with: &str, group: &Group) -> Vec<String> {
    let turns = |part| {
        Group::quantile(&group.turns, part).map_or(String::new(), |turns| format!("{turns:.2}"))
    };
    let named = group
        .named
        .part()
        .map_or(String::new(), |part| format!("{:.2} %", part * 100.0));
    let at_least = match group.named.of {
        0 => String::new(),
        _ => format!("{:.2} %", group.named.bounds().0 * 100.0),
    };
    let over_bound = Group::quantile(&group.tilt_over_bound, 1.0).unwrap_or_default();
    vec![
        name.to_owned(),
        with.to_owned(),
        group.runs.to_string(),
        group.beyond_limit.to_string(),
        group.in_time.hits.to_string(),
        turns(0.5),
        turns(0.95),
        turns(0.99),
        turns(1.0),
        named,
        at_least,
        format!("{:.2}", group.tilt_over_limit),
        format!("{over_bound:.2}"),
        format!("{:.2}", group.off_over_limit),
    ]
}

fn bounds(rate: Rate) -> String {
    let (low, high) = rate.bounds();
    format!(
        "the rate is {:.3} to {:.3} % (95 %)",
        low * 100.0,
        high * 100.0
    )
}

/// Writes the failures, each with cases to replay. Those that break a claim come first. Wrong names within the claim are listed apart, and so is
/// what no monitor can detect.
fn failures(text: &mut String, header: &Header, tally: &Tally) {
    let scene = match header.scene.as_str() {
        MACHINES => "",
        _ => "SCENE ",
    };
    let replay = format!(
        "cophase campaign {scene}--seed {} --replay NUMBER",
        header.seed
    );
    let (mut broken, mut within, mut hidden) = (Vec::new(), Vec::new(), Vec::new());
    for ((kind, encoder), group) in &tally.groups {
        let with = sensor(*encoder);
        for (&what, cases) in &group.failed {
            let lines = if tally.breaks_claim(what) {
                &mut broken
            } else if what == Failure::NotDecidable {
                &mut hidden
            } else {
                &mut within
            };
            lines.push(format!(
                "- {} ({with}), {}: {}",
                kind.name(),
                what.name(),
                list(cases)
            ));
        }
    }
    if !tally.tripped.is_empty() {
        broken.push(format!(
            "- clean (--clean), something reported: {}",
            list(&tally.tripped)
        ));
    }
    let misnamed = if tally.is_selected {
        "Misnamed, of which the claim allows 1 in 100 over all faulty runs"
    } else {
        "Misnamed, within the 1 in 100 that is claimed"
    };
    let not_decidable = "Not detected in time, where no monitor can by an index alone";
    for (heading, lines) in [
        ("Not as claimed", broken),
        (misnamed, within),
        (not_decidable, hidden),
    ] {
        if !lines.is_empty() {
            let lines = lines.join("\n");
            let _ = writeln!(
                text,
                "\n{heading}, by case (`{replay}` shows one):\n\n{lines}"
            );
        }
    }
}

fn list(cases: &[u64]) -> String {
    let shown: Vec<_> = cases
        .iter()
        .take(MAX_NAMED)
        .map(ToString::to_string)
        .collect();
    let rest = cases.len().saturating_sub(MAX_NAMED);
    let more = if rest > 0 {
        format!(" and {rest} more")
    } else {
        String::new()
    };
    format!("{} ({}{more})", cases.len(), shown.join(", "))
}

/// Returns a Markdown table whose columns are as wide as their contents. Numbers are aligned to the right.
pub(super) fn in_columns(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<_> = (0..columns).map(width).collect();
    let mut text = String::new();
    for (number, row) in rows.iter().enumerate() {
        for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            let _ = if column < 2 {
                write!(text, "| {cell:width$} ")
            } else {
                write!(text, "| {cell:>width$} ")
            };
        }
        text.push_str("|\n");
        if number == 0 {
            for (column, &width) in widths.iter().enumerate() {
                let dashes = "-".repeat(width);
                let _ = if column < 2 {
                    write!(text, "| {dashes} ")
                } else {
                    write!(text, "| {}: ", &dashes[1..])
                };
            }
            text.push_str("|\n");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::plan::Plan;
    use cophase_scene::file::FaultName;

    /// If this fails, the list of what is not as claimed contradicts the exit status of the campaign.
    #[test]
    fn misnamed_faults_within_the_claim_are_listed_separately() {
        let plan = Plan::new(5, None).unwrap();
        let header = Header::new(&plan, None, 0..100, 100);
        let of = |named: u64, what: Failure| {
            let mut group = Group::default();
            for number in 0..100 {
                group.named.count(number < named);
            }
            group.failed.insert(what, vec![7]);
            let tally = Tally {
                groups: vec![((FaultName::Slip, false), group.clone())],
                all: group,
                ..Tally::default()
            };
            let mut text = String::new();
            failures(&mut text, &header, &tally);
            (text, tally.is_kept())
        };
        let within = "\nMisnamed, within the 1 in 100 that is claimed, by case (`cophase campaign --seed 5 --replay NUMBER` shows one):\n\n- slip (index), misnamed: 1 (7)\n";
        assert_eq!(of(99, Failure::Misnamed), (within.to_owned(), true));
        for (named, what) in [
            (98, Failure::Misnamed),
            (99, Failure::Late),
            (100, Failure::LeftRunning),
        ] {
            let (text, is_kept) = of(named, what);
            assert!(text.starts_with("\nNot as claimed, by case"), "{text}");
            assert!(!is_kept, "{what:?}");
        }
    }
}
