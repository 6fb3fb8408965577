//! Summary of rows: counts, rates with their bounds, and quantiles, by kind of fault, with and without encoders.

use std::collections::BTreeMap;

use cophase_scene::file::FaultName;

use super::interval::Rate;
use super::judge::Verdict;
use super::plan::faults::KINDS;
use super::row::Row;
use super::shards::{Header, Shard};

/// Faulty runs of one kind.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Number of all runs.
    pub runs: u64,
    /// Number of runs in which a crank was beyond its limit.
    pub beyond_limit: u64,
    /// Rate of detection in time, among those of these runs that are judged on it.
    pub in_time: Rate,
    /// Rate of right names, among faults that were reported or had to be.
    pub named: Rate,
    /// Turns from the limit to three ticks before the detection, smallest first.
    pub turns: Vec<f64>,
    /// Largest ratio of the tilt to the limit, for the tilt that the bound applies to.
    pub tilt_over_limit: f64,
    /// Largest ratio of the tilt to the limit after the drives were off.
    pub off_over_limit: f64,
    /// Ratios of the tilt to its bound, smallest first.
    pub tilt_over_bound: Vec<f64>,
    /// Rate of runs in which an axis was left running.
    pub left_running: Rate,
    /// Numbers of the cases that failed, by the way in which they did. [`Tally::breaks_claim`] returns whether an entry breaks a claim.
    pub failed: BTreeMap<Failure, Vec<u64>>,
}

/// Way in which a faulty run failed, the ones that are most worth a replay first. Wrong names, of which the claim allows some, and what no
/// monitor can detect are last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Failure {
    /// Detected too late.
    Late,
    /// Not detected.
    Missed,
    /// An axis was left running.
    LeftRunning,
    /// Tilted beyond its bound.
    Tilted,
    /// Tilted after its stop.
    TiltsOn,
    /// Something was reported before the fault.
    Early,
    /// The simulation diverged.
    Diverged,
    /// Detected under a wrong name.
    Misnamed,
    /// Not detected in time, where no monitor can.
    NotDecidable,
}

impl Failure {
    /// Returns the name, as the list of failures shows it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Late => "late",
            Self::Missed => "missed",
            Self::LeftRunning => "left running",
            Self::Tilted => "tilted beyond its bound",
            Self::TiltsOn => "tilted after its stop",
            Self::Early => "reported before it",
            Self::Diverged => "diverged",
            Self::Misnamed => "misnamed",
            Self::NotDecidable => "not decidable",
        }
    }
}

impl Group {
    fn take(&mut self, row: &Row) {
        self.runs += 1;
        self.beyond_limit += u64::from(row.is_beyond_limit());
        if let Some(in_time) = row.in_time {
            self.in_time.count(in_time);
            // A fault that was not detected at all counts as missed instead.
            if !in_time && row.verdict != Verdict::Missed {
                self.fail(Failure::Late, row);
            }
        }
        match row.verdict {
            Verdict::Right => self.named.count(true),
            Verdict::Misnamed | Verdict::Missed => self.named.count(false),
            _ => {}
        }
        match row.verdict {
            Verdict::Misnamed => self.fail(Failure::Misnamed, row),
            Verdict::Missed => self.fail(Failure::Missed, row),
            Verdict::NotDecidable => self.fail(Failure::NotDecidable, row),
            Verdict::FalseTrip => self.fail(Failure::Early, row),
            Verdict::Diverged => self.fail(Failure::Diverged, row),
            _ => {}
        }
        self.turns.extend(row.turns_from_limit);
        let over_limit = |mrad: f64| mrad / row.limit_mrad;
        let tilt = over_limit(row.bounded_tilt_mrad());
        self.tilt_over_limit = self.tilt_over_limit.max(tilt);
        let off = row.tilt_off_mrad.map_or(0.0, over_limit);
        self.off_over_limit = self.off_over_limit.max(off);
        if row.bound_mrad > 0.0 {
            self.tilt_over_bound.push(row.tilt_over_bound());
            if row.tilt_over_bound() > 1.0 {
                self.fail(Failure::Tilted, row);
            }
        }
        if row.tilts_after_stop() {
            self.fail(Failure::TiltsOn, row);
        }
        self.left_running.count(row.left_running);
        if row.left_running {
            self.fail(Failure::LeftRunning, row);
        }
    }

    fn fail(&mut self, what: Failure, row: &Row) {
        self.failed.entry(what).or_default().push(row.number);
    }

    fn finish(&mut self) {
        self.turns.sort_by(f64::total_cmp);
        self.tilt_over_bound.sort_by(f64::total_cmp);
    }

    /// Quantile of sorted values: the smallest value that at least a fraction `part` of them does not exceed. The quantile of 1 is the
    /// largest.
    pub fn quantile(sorted: &[f64], part: f64) -> Option<f64> {
        let at = (part * sorted.len() as f64).ceil() as usize;
        sorted.get(at.clamp(1, sorted.len().max(1)) - 1).copied()
    }
}

/// Figures of a campaign.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Faulty runs by kind, with and without encoders, in the order of the kinds.
    pub groups: Vec<((FaultName, bool), Group)>,
    /// All faulty runs together.
    pub all: Group,
    /// Rate of clean runs with any other verdict than clean. Moot runs are left out.
    pub false_trips: Rate,
    /// Numbers of these cases.
    pub tripped: Vec<u64>,
    /// Simulated time of all runs, s.
    pub simulated_s: f64,
    /// True if the rows are from chosen strata. Then [`Self::all`] gives no rate over all cases.
    pub is_selected: bool,
    /// The faulty run whose detection came the most turns after the limit was passed; any faulty run if none was passed.
    pub latest: Option<Row>,
}

/// Smallest fraction of faults that must be named rightly.
const MIN_NAMED: f64 = 0.99;

impl Tally {
    /// Tally of a shard's rows.
    pub fn new(shard: &Shard) -> Self {
        let mut counter = Counter::new(&shard.header);
        counter.add(&shard.rows);
        counter.finish()
    }

    /// Returns true if all claims hold.
    pub fn is_kept(&self) -> bool {
        let breaks = |&what: &Failure| self.breaks_claim(what);
        self.false_trips.hits == 0 && !self.all.failed.keys().any(breaks)
    }

    /// Returns true if an entry of [`Group::failed`] breaks a claim. What no monitor can detect breaks none. Wrong names do so only if there
    /// are more of them than claimed. That claim is on all cases, so chosen strata cannot break it.
    pub fn breaks_claim(&self, what: Failure) -> bool {
        let named = self.all.named.part().is_none_or(|part| part >= MIN_NAMED);
        match what {
            Failure::NotDecidable => false,
            Failure::Misnamed => !(named || self.is_selected),
            _ => true,
        }
    }
}

/// Tally of rows that come one part after the other, in their order.
#[derive(Debug, Default)]
pub struct Counter {
    tally: Tally,
    groups: BTreeMap<(usize, bool), Group>,
}

impl Counter {
    /// Tally without rows.
    pub fn new(header: &Header) -> Self {
        let tally = Tally {
            is_selected: header.selection.is_some(),
            ..Tally::default()
        };
        Self {
            tally,
            ..Self::default()
        }
    }

    /// Counts the next rows.
    pub fn add(&mut self, rows: &[Row]) {
        let tally = &mut self.tally;
        for row in rows {
            tally.simulated_s += row.simulated_s;
            let Some(kind) = row.kind else {
                if row.verdict == Verdict::Moot {
                    continue;
                }
                let tripped = row.verdict != Verdict::Clean;
                tally.false_trips.count(tripped);
                if tripped {
                    tally.tripped.push(row.number);
                }
                continue;
            };
            let place = KINDS.iter().position(|&other| other == kind);
            let key = (place.unwrap_or(KINDS.len()), row.encoder);
            self.groups.entry(key).or_default().take(row);
            tally.all.take(row);
            let turns = |row: &Row| row.turns_from_limit.unwrap_or(f64::NEG_INFINITY);
            let is_later = |last: &Row| turns(last).total_cmp(&turns(row)).is_le();
            if tally.latest.as_ref().is_none_or(is_later) {
                tally.latest = Some(row.clone());
            }
        }
    }

    /// Returns the tally of all rows.
    pub fn finish(self) -> Tally {
        let Self { mut tally, groups } = self;
        tally.all.finish();
        tally.groups = groups
            .into_iter()
            .filter_map(|((place, encoder), mut group)| {
                group.finish();
                Some(((*KINDS.get(place)?, encoder), group))
            })
            .collect();
        tally
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a quantile is that of a neighbouring value, and the table may leave out the slowest detection.
    #[test]
    fn quantiles_are_values_of_the_sample() {
        let sorted: Vec<f64> = (1..=200).map(f64::from).collect();
        for (part, value) in [(0.5, 100.0), (0.95, 190.0), (0.99, 198.0), (1.0, 200.0)] {
            assert_eq!(Group::quantile(&sorted, part), Some(value));
        }
        assert_eq!(Group::quantile(&[], 0.5), None);
        assert_eq!(Group::quantile(&[3.0], 0.01), Some(3.0));
    }
}
