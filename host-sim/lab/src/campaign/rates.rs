//! Rates over all faulty runs, for the table of a campaign with chosen strata.

use std::fmt::Write as _;

use super::selection::Selection;
use super::stratified::{self, Estimate, Part};
use super::table::in_columns;
use super::tally::{Group, Tally};

/// Returns the number of faulty runs of a group that had an event.
type Count = fn(&Group) -> u64;

/// Events whose rates are shown.
const EVENTS: [(&str, Count); 3] = [
    ("not detected in time", |group| {
        group.in_time.of - group.in_time.hits
    }),
    ("not rightly named", |group| {
        group.named.of - group.named.hits
    }),
    ("left running", |group| group.left_running.hits),
];

const HEADER: [&str; 7] = [
    "event",
    "stratum",
    "share",
    "runs",
    "events",
    "rate in the stratum (95 %)",
    "rate over all faulty runs (95 %)",
];

/// Returns the table of rates, and a note on what these strata cannot show.
pub fn text(selection: &Selection, tally: &Tally) -> String {
    let mut rows = vec![HEADER.map(str::to_owned).to_vec()];
    for (event, count) in EVENTS {
        let (listed, others) = selection.parts(tally, count);
        for (name, part) in &listed {
            rows.push(single(event, name, part));
        }
        let mut parts: Vec<_> = listed.into_iter().map(|(_, part)| part).collect();
        if parts.len() > 1 {
            rows.push(total(event, "these together", &parts));
        }
        if let Some(part) = others {
            rows.push(single(event, "others", &part));
            parts.push(part);
            rows.push(total(event, "all", &parts));
        }
    }
    let mut text = in_columns(&rows);
    let left_out = selection.share_left_out();
    if left_out > 0.0 {
        let _ = writeln!(
            text,
            "\nThe other strata, {:.3} % of all faulty runs, were not simulated, and what they add to a rate over all faulty runs is not known. \
             With --others K, 1 in K of their cases is simulated too.",
            left_out * 100.0
        );
    }
    let _ = writeln!(
        text,
        "\nFalse trips: {} of {} clean runs of these cases. Machines are drawn to fit the fault: for a rate over all clean runs, \
         run a campaign without --only.",
        tally.false_trips.hits, tally.false_trips.of
    );
    text
}

/// Returns the row of one stratum.
fn single(event: &str, name: &str, part: &Part) -> Vec<String> {
    let [inside, over_all] = [part.inside(), part.contribution()].map(shown);
    row(event, name, part, inside, over_all)
}

/// Returns a row of the table.
fn row(event: &str, name: &str, part: &Part, inside: String, over_all: String) -> Vec<String> {
    vec![
        event.to_owned(),
        name.to_owned(),
        format!("{:.3} %", part.share * 100.0),
        part.rate.of.to_string(),
        part.rate.hits.to_string(),
        inside,
        over_all,
    ]
}

/// Returns the row of several strata together.
fn total(event: &str, name: &str, parts: &[Part]) -> Vec<String> {
    let mut all = Part::default();
    for part in parts {
        all.share += part.share;
        all.rate.of += part.rate.of;
        all.rate.hits += part.rate.hits;
    }
    // Runs of several strata have no common rate until each stratum is weighted with its share.
    row(
        event,
        name,
        &all,
        String::new(),
        shown(stratified::sum(parts)),
    )
}

/// Formats an estimate: `2.0e-5 (9.1e-6 to 3.8e-5)`.
fn shown(estimate: Option<Estimate>) -> String {
    match estimate {
        Some(Estimate { rate, low, high }) => {
            format!("{} ({} to {})", number(rate), number(low), number(high))
        }
        None => "no runs".to_owned(),
    }
}

/// Formats a number: two significant digits below 0.01, and else three decimals.
fn number(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if value < 0.01 {
        format!("{value:.1e}")
    } else {
        format!("{value:.3}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::interval::Rate;
    use super::super::plan::Plan;
    use super::*;
    use cophase_scene::file::FaultName;

    /// If this fails, the table multiplies a rate by a wrong share, or states a rate of a part as one of all faulty runs.
    #[test]
    fn a_stratum_contributes_its_rate_times_its_share() {
        let group = Group {
            runs: 10_000,
            in_time: Rate {
                hits: 8_991,
                of: 9_000,
            },
            ..Group::default()
        };
        let tally = Tally {
            groups: vec![
                ((FaultName::Runaway, false), group.clone()),
                ((FaultName::Stuck, true), group),
            ],
            is_selected: true,
            ..Tally::default()
        };
        let table = |others| {
            let plan = Plan::new(1, None).unwrap();
            let names = ["runaway:index".to_owned()];
            text(&Selection::new(&plan, &names, others).unwrap(), &tally)
        };
        let cells = |text: &str, name: &str| {
            let line = text.lines().find(|line| line.contains(name));
            let cells = line.map(|line| line.split('|').map(|cell| cell.trim().to_owned()));
            cells.map_or(Vec::new(), |cells| cells.skip(3).collect())
        };
        // 9 of 10,000, in a stratum of one case in 45. The Poisson interval of 9 is 4.115 to 17.08 (a table of chi-square: half of 8.231
        // and 34.17).
        let alone = table(None);
        let expected = ["2.222 %", "10000", "9", "9.0e-4 (4.1e-4 to 1.7e-3)"];
        let own = cells(&alone, "| runaway:index");
        assert_eq!(own[..4], expected);
        assert_eq!(own[4], "2.0e-5 (9.1e-6 to 3.8e-5)");
        assert!(!alone.contains("together"), "{alone}");
        assert!(
            alone.contains("97.778 % of all faulty runs, were not simulated"),
            "{alone}"
        );
        // All other cases, 44 of 45, have the same counts.
        let all = table(Some(10));
        assert_eq!(cells(&all, "| runaway:index"), own);
        assert_eq!(cells(&all, "| others")[..3], ["97.778 %", "10000", "9"]);
        let sum = cells(&all, "| all");
        assert_eq!(sum[..4], ["100.000 %", "20000", "18", ""]);
        assert!(sum[4].starts_with("9.0e-4 ("), "{sum:?}");
        assert!(!all.contains("not simulated"), "{all}");
    }
}
