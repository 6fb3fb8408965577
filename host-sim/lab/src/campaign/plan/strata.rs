//! Strata of a plan: its cases by kind of fault and by sensor, as in the campaign's table, and the share of each.
//!
//! A share is exact. Kind and drives are drawn first for a case, each with equal probabilities, and later draws do not change them.

use std::fmt;

use cophase_scene::file::FaultName;

use super::faults::KINDS;

/// Cases of one kind of fault, on axes with an index sensor alone or with an encoder too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stratum {
    /// Kind of the fault.
    pub kind: FaultName,
    /// True if the axes have encoders.
    pub encoder: bool,
}

/// Returns the name of the best sensor of an axis, as in the table.
pub const fn sensor(encoder: bool) -> &'static str {
    if encoder { "encoder" } else { "index" }
}

/// Returns the kind with a name.
pub fn kind(name: &str) -> Option<FaultName> {
    KINDS.into_iter().find(|kind| kind.name() == name)
}

impl Stratum {
    /// Parses `KIND:SENSOR`.
    pub fn parse(text: &str) -> Option<Self> {
        let (name, sensor_name) = text.split_once(':')?;
        let encoder = [false, true]
            .into_iter()
            .find(|&encoder| sensor(encoder) == sensor_name)?;
        Some(Self {
            kind: kind(name)?,
            encoder,
        })
    }
}

impl fmt::Display for Stratum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.kind.name(), sensor(self.encoder))
    }
}

/// Probability that a case is of a stratum, as a fraction: `of` / `among`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Numerator.
    pub of: u64,
    /// Denominator, not 0.
    pub among: u64,
}

impl Share {
    /// Parses `OF/AMONG`, a fraction of more than 0 and at most 1.
    pub fn parse(text: &str) -> Option<Self> {
        let (of, among) = text.split_once('/')?;
        let (of, among) = (of.parse().ok()?, among.parse().ok()?);
        (0 < of && of <= among).then_some(Self { of, among })
    }

    /// Returns the fraction as a number.
    pub fn part(self) -> f64 {
        self.of as f64 / self.among as f64
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.of, self.among)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Plan;
    use super::*;
    use cophase_scene::library;
    use host_sim::checked::Checked;

    fn plans() -> [Plan; 2] {
        let scene = library::find("default").unwrap().scene();
        [None, Some(Checked::new(scene).unwrap())].map(|checked| Plan::new(9, checked).unwrap())
    }

    /// If this fails, a campaign of chosen strata simulates cases of other strata.
    #[test]
    fn the_stratum_of_a_number_is_that_of_its_case() {
        for plan in plans() {
            for number in 0..150 {
                let case = plan.case(number);
                let Stratum { kind, encoder } = plan.stratum(number);
                assert_eq!(kind, case.fault().kind, "{number}");
                assert_eq!(encoder, case.scene.axes.encoder, "{number}");
            }
        }
    }

    /// If this fails, rates of strata are added with wrong weights.
    #[test]
    fn each_stratum_occurs_in_proportion_to_its_share() {
        const CASES: u64 = 100_000;
        for plan in plans() {
            let strata = plan.strata();
            let sum: f64 = strata.iter().map(|(_, share)| share.part()).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            let mut counts = vec![0_u64; strata.len()];
            for number in 0..CASES {
                let stratum = plan.stratum(number);
                let at = strata.iter().position(|(other, _)| *other == stratum);
                counts[at.unwrap()] += 1;
            }
            for ((stratum, share), count) in strata.iter().zip(counts) {
                let expected = share.part() * CASES as f64;
                // The margin is four standard deviations. With thirty counts, one in 500 plans has a count outside, and the seed of this
                // plan is fixed.
                let margin = 4.0 * (expected * (1.0 - share.part())).sqrt();
                let difference = (count as f64 - expected).abs();
                assert!(difference < margin, "{stratum}: {count}, not {expected}");
            }
        }
    }

    #[test]
    fn written_names_and_shares_parse_to_the_same_values() {
        for (stratum, share) in plans()[0].strata() {
            assert_eq!(Stratum::parse(&stratum.to_string()), Some(stratum));
            assert_eq!(Share::parse(&share.to_string()), Some(share));
        }
        for text in ["0/3", "4/3", "1/0", "1", "x/2"] {
            assert_eq!(Share::parse(text), None, "{text}");
        }
    }
}
