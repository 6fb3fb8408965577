//! Stratified sampling: the strata whose cases are simulated, and the fraction of the other cases.
//!
//! A selection decides on cases before anything is simulated. The cases that it takes are those of the whole campaign, with the same
//! numbers. It counts them by *position*: position 0 is the first case that it takes.

use std::fmt;
use std::ops::Range;

use super::interval::Rate;
use super::plan::Plan;
use super::plan::faults::KINDS;
use super::plan::strata::{self, Share, Stratum};
use super::stratified::Part;
use super::tally::{Group, Tally};

/// Strata that are simulated, with the share of each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    strata: Vec<(Stratum, Share)>,
    /// Interval of numbers at which cases of other strata are simulated, too: those whose numbers are multiples of it.
    others: Option<u64>,
}

/// Reason why names select nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SelectionError(String);

impl Selection {
    /// Selection by names, `KIND` or `KIND:SENSOR`, in the order of the plan's strata. With `others`, it also takes every `others`th number
    /// of the other strata.
    ///
    /// # Errors
    /// A name is not that of a stratum, or no case of the plan can be of that stratum.
    pub fn new(plan: &Plan, names: &[String], others: Option<u64>) -> Result<Self, SelectionError> {
        let all = plan.strata();
        let mut selected = vec![false; all.len()];
        for name in names {
            let mut is_possible = false;
            for (flag, (stratum, _)) in selected.iter_mut().zip(&all) {
                if name == stratum.kind.name() || *name == stratum.to_string() {
                    *flag = true;
                    is_possible = true;
                }
            }
            if !is_possible {
                return Err(refusal(plan, name));
            }
        }
        let strata = all.into_iter().zip(selected);
        Ok(Self {
            strata: strata
                .filter_map(|(entry, flag)| flag.then_some(entry))
                .collect(),
            others,
        })
    }

    /// Returns true if the case with a number is simulated.
    pub fn has(&self, number: u64, stratum: Stratum) -> bool {
        self.lists(stratum)
            || self
                .others
                .is_some_and(|every| number.is_multiple_of(every))
    }

    fn lists(&self, stratum: Stratum) -> bool {
        self.strata.iter().any(|(listed, _)| *listed == stratum)
    }

    /// Returns the numbers of the cases at a range of positions.
    pub fn numbers(&self, plan: &Plan, positions: Range<u64>) -> Vec<u64> {
        let mut numbers = Vec::new();
        let taken = (0..).filter(|&number| self.has(number, plan.stratum(number)));
        // Positions are 64-bit numbers. `skip` and `take` count only to what a pointer of the computer can hold.
        for (position, number) in (0..positions.end).zip(taken) {
            if position >= positions.start {
                numbers.push(number);
            }
        }
        numbers
    }

    /// Returns its strata with their shares, for a column of a shard.
    pub fn only(&self) -> String {
        let listed = |(stratum, share): &(Stratum, Share)| format!("{stratum}@{share}");
        self.strata.iter().map(listed).collect::<Vec<_>>().join(" ")
    }

    /// Returns the interval of numbers at which cases of other strata are simulated, for another column.
    pub const fn others(&self) -> Option<u64> {
        self.others
    }

    /// Parses the values of these columns.
    pub fn parse(only: &str, others: Option<u64>) -> Option<Self> {
        let listed = |text: &str| {
            let (stratum, share) = text.split_once('@')?;
            Some((Stratum::parse(stratum)?, Share::parse(share)?))
        };
        Some(Self {
            strata: only.split(' ').map(listed).collect::<Option<_>>()?,
            others,
        })
        .filter(|selection| selection.others != Some(0))
    }

    /// Returns the counts of an event among faulty runs: for each stratum with its name, and for the others if they are simulated.
    pub fn parts(
        &self,
        tally: &Tally,
        count: fn(&Group) -> u64,
    ) -> (Vec<(String, Part)>, Option<Part>) {
        let rate_of = |is_in: &dyn Fn(Stratum) -> bool| {
            let mut rate = Rate::default();
            for ((kind, encoder), group) in &tally.groups {
                let (kind, encoder) = (*kind, *encoder);
                if is_in(Stratum { kind, encoder }) {
                    rate.of += group.runs;
                    rate.hits += count(group);
                }
            }
            rate
        };
        let part = |(stratum, share): &(Stratum, Share)| {
            let part = Part {
                share: share.part(),
                rate: rate_of(&|other| other == *stratum),
            };
            (stratum.to_string(), part)
        };
        let others = Part {
            share: self.others_share(),
            rate: rate_of(&|other| !self.lists(other)),
        };
        let has_others = self.others.is_some() && others.share > 0.0;
        (
            self.strata.iter().map(part).collect(),
            has_others.then_some(others),
        )
    }

    /// Returns the share of all strata that are not listed.
    fn others_share(&self) -> f64 {
        let listed: f64 = self.strata.iter().map(|(_, share)| share.part()).sum();
        // Shares add up to 1, except for rounding.
        if listed > 1.0 - 1e-9 {
            0.0
        } else {
            1.0 - listed
        }
    }

    /// Returns the share of the strata of which no case is simulated.
    pub fn share_left_out(&self) -> f64 {
        match self.others {
            Some(_) => 0.0,
            None => self.others_share(),
        }
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self
            .strata
            .iter()
            .map(|(stratum, _)| stratum.to_string())
            .collect();
        write!(f, "{}", names.join(", "))?;
        let others = |every| write!(f, ", and 1 in {every} of the others");
        self.others.map_or(Ok(()), others)
    }
}

/// Explains why a name selects nothing, and lists names that would select something.
fn refusal(plan: &Plan, name: &str) -> SelectionError {
    let (kind_name, sensor_name) = match name.split_once(':') {
        Some((kind_name, sensor_name)) => (kind_name, Some(sensor_name)),
        None => (name, None),
    };
    let listed = |names: Vec<String>| names.join(", ");
    let Some(kind) = strata::kind(kind_name) else {
        let kinds = KINDS.map(|kind| kind.name().to_owned()).to_vec();
        return SelectionError(format!(
            "there is no kind of fault `{kind_name}`; give one of {}",
            listed(kinds)
        ));
    };
    if sensor_name.is_some_and(|sensor_name| !["index", "encoder"].contains(&sensor_name)) {
        return SelectionError(format!(
            "`{name}` names no sensor; give `{kind_name}:index`, `{kind_name}:encoder`, or `{kind_name}` for both"
        ));
    }
    let strata = plan.strata();
    let possible = strata.iter().map(|(stratum, _)| stratum);
    SelectionError(match plan.scene() {
        Some(scene) => format!(
            "no case of the scene `{}` is of `{name}`: its axes, its sensors, or its model level exclude that; give one of {}",
            scene.name,
            listed(possible.map(ToString::to_string).collect())
        ),
        None => format!(
            "no case is of `{name}`: that fault is drawn only for axes whose sensors can show it; give {}",
            listed(
                possible
                    .filter(|stratum| stratum.kind == kind)
                    .map(|stratum| format!("`{stratum}`"))
                    .collect()
            )
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::super::stratified;
    use super::*;
    use cophase_scene::file::FaultName;

    fn selection(plan: &Plan, names: &[&str], others: Option<u64>) -> Selection {
        let names: Vec<_> = names.iter().map(ToString::to_string).collect();
        Selection::new(plan, &names, others).unwrap()
    }

    fn plan(seed: u64) -> Plan {
        Plan::new(seed, None).unwrap()
    }

    /// If this fails, shards of a selection overlap or leave gaps, or a kind without a sensor does not select both of its strata.
    #[test]
    fn positions_count_only_selected_cases() {
        let plan = plan(3);
        let selection = selection(&plan, &["slip", "runaway:index"], Some(40));
        assert_eq!(
            selection.to_string(),
            "slip:index, slip:encoder, runaway:index, and 1 in 40 of the others"
        );
        let all = selection.numbers(&plan, 0..90);
        let [first, rest] = [0..35, 35..90].map(|positions| selection.numbers(&plan, positions));
        assert_eq!(all, [first, rest].concat());
        let expected: Vec<_> = (0..=all[89])
            .filter(|&number| {
                let Stratum { kind, encoder } = plan.stratum(number);
                let is_listed = match kind {
                    FaultName::Slip => true,
                    FaultName::Runaway => !encoder,
                    _ => false,
                };
                is_listed || number % 40 == 0
            })
            .collect();
        assert_eq!(all, expected);
    }

    #[test]
    fn written_columns_parse_to_the_same_selection() {
        for others in [None, Some(25)] {
            let selection = selection(&plan(1), &["slip", "reversed:encoder"], others);
            let read = Selection::parse(&selection.only(), selection.others());
            assert_eq!(read, Some(selection));
        }
        assert_eq!(Selection::parse("slip:index@1/45", Some(0)), None);
        assert_eq!(Selection::parse("slip:index", None), None);
    }

    /// Rate of a rare event: an extra pulse that comes three times. By the definition of the plan, it is a third of a fifteenth of all
    /// cases.
    const KNOWN_RATE: f64 = 1.0 / 45.0;

    fn is_event(plan: &Plan, number: u64) -> bool {
        let kind = plan.stratum(number).kind;
        kind == FaultName::IndexExtra && plan.case(number).fault().count == Some(3)
    }

    /// If this fails, the estimate is biased, or its interval contains the rate too rarely. The event has a known rate. It occurs in the
    /// stratum that is oversampled, and in the others.
    #[test]
    fn estimates_are_unbiased_and_intervals_cover_the_rate() {
        const CAMPAIGNS: u64 = 200;
        const CASES: u64 = 200;
        let (mut total, mut squares, mut covered) = (0.0, 0.0, 0);
        for seed in 0..CAMPAIGNS {
            let plan = plan(seed);
            let selection = selection(&plan, &["index-extra:index"], Some(4));
            let mut tally = Tally::default();
            for number in selection.numbers(&plan, 0..CASES) {
                let Stratum { kind, encoder } = plan.stratum(number);
                let key = (kind, encoder);
                if tally.groups.iter().all(|(other, _)| *other != key) {
                    tally.groups.push((key, Group::default()));
                }
                let group = tally.groups.iter_mut().find(|(other, _)| *other == key);
                let group = &mut group.unwrap().1;
                group.runs += 1;
                group.left_running.count(is_event(&plan, number));
            }
            let (listed, others) = selection.parts(&tally, |group| group.left_running.hits);
            let parts = [listed[0].1, others.unwrap()];
            let runs: u64 = parts.iter().map(|part| part.rate.of).sum();
            assert_eq!(runs, CASES);
            let estimate = stratified::sum(&parts).unwrap();
            total += estimate.rate;
            squares += (estimate.rate - KNOWN_RATE).powi(2);
            covered += u64::from(estimate.low <= KNOWN_RATE && KNOWN_RATE <= estimate.high);
        }
        let count = CAMPAIGNS as f64;
        let mean = total / count;
        // The margin is three standard deviations of the mean, from the scatter of the campaigns about the rate.
        let margin = 3.0 * squares.sqrt() / count;
        assert!((mean - KNOWN_RATE).abs() < margin, "{mean}, {margin}");
        // The margin is narrow enough to show a wrong share of either part.
        assert!(margin < 0.15 * KNOWN_RATE, "{margin}");
        // With 95 % each, 16 or more of 200 are outside in one of 20 such tests. The seeds are fixed, so the result is always the same.
        assert!(covered >= CAMPAIGNS - 15, "{covered}");
    }
}
