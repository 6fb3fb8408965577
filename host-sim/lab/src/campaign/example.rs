//! The run of a campaign that is most worth a replay.

use std::fmt;

use cophase_scene::file::FaultName;

use super::plan::strata::sensor;
use super::row::Row;
use super::tally::{Failure, Tally};

/// Run to examine alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// Number of its case.
    pub number: u64,
    /// True for the clean run of the case.
    pub clean: bool,
    /// Kind of its fault, true if the axes have encoders, and its distinction.
    what: Option<(FaultName, bool, &'static str)>,
}

impl fmt::Display for Example {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.what {
            Some((kind, encoder, what)) => {
                let (name, with) = (kind.name(), sensor(encoder));
                write!(f, "case {}: {name} ({with}), {what}", self.number)
            }
            None => write!(f, "case {}: clean, something reported", self.number),
        }
    }
}

/// Returns the run of a campaign that is most worth a replay: one that is not as claimed, else a misnamed one, else the one with the latest
/// detection. None without rows.
pub fn example(tally: &Tally) -> Option<Example> {
    // A clean run in which something was reported has no failure as its rank, so it is before all.
    let tripped = tally.tripped.first().map(|&number| {
        let example = Example {
            number,
            clean: true,
            what: None,
        };
        (None, example)
    });
    let entries = tally.groups.iter().flat_map(|((kind, encoder), group)| {
        let entry = move |(&failure, cases): (&Failure, &Vec<u64>)| {
            let example = Example {
                number: *cases.first()?,
                clean: false,
                what: Some((*kind, *encoder, failure.name())),
            };
            Some((Some(failure), example))
        };
        group.failed.iter().filter_map(entry)
    });
    (tripped.into_iter().chain(entries))
        .min_by_key(|(rank, _)| *rank)
        .map(|(_, example)| example)
        .or_else(|| latest(tally.latest.as_ref()?))
}

/// Returns the run with the latest detection.
fn latest(row: &Row) -> Option<Example> {
    let what = match row.turns_from_limit {
        Some(_) => "detected the latest",
        None => "as claimed",
    };
    Some(Example {
        number: row.number,
        clean: false,
        what: Some((row.kind?, row.encoder, what)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::plan::Plan;
    use crate::campaign::run_all;
    use crate::campaign::shards::{Header, Shard};

    /// If this fails, the case that a campaign offers for a replay has nothing to see, or another case has what the words say.
    #[test]
    fn failures_are_offered_before_slow_detections() {
        let plan = Plan::new(5, None).unwrap();
        let rows = run_all(&plan, 0..6, &|| {}).unwrap();
        let header = Header::new(&plan, None, 0..6, 6);
        let shard = Shard { header, rows };
        let offered = |tally: &Tally| example(tally).unwrap();

        let as_claimed = Tally {
            groups: Vec::new(),
            tripped: Vec::new(),
            ..Tally::new(&shard)
        };
        let slowest = offered(&as_claimed);
        let turns = |number: u64| {
            let row = shard
                .rows
                .iter()
                .find(|row| row.number == number && !row.clean);
            row.unwrap().turns_from_limit
        };
        assert!((0..6).all(|number| turns(number) <= turns(slowest.number)));
        assert!(turns(slowest.number).is_some(), "{slowest}");

        let fails = |what: Failure| {
            let mut tally = Tally::new(&shard);
            let ((kind, encoder), mut group) = tally.groups[0].clone();
            group.failed = [(Failure::Misnamed, vec![3]), (what, vec![4, 5])].into();
            tally.groups = vec![((kind, encoder), group)];
            tally
        };
        let (kind, encoder) = fails(Failure::Late).groups[0].0;
        let named = format!("{} ({})", kind.name(), sensor(encoder));
        for (what, said) in [
            (Failure::Late, format!("case 4: {named}, late")),
            (Failure::Misnamed, format!("case 4: {named}, misnamed")),
            (Failure::Diverged, format!("case 4: {named}, diverged")),
        ] {
            assert_eq!(offered(&fails(what)).to_string(), said);
        }
        let tripped = Tally {
            tripped: vec![2],
            ..fails(Failure::Late)
        };
        let tripped = offered(&tripped);
        assert!(tripped.clean && tripped.number == 2, "{tripped}");
    }
}
