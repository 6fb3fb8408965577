//! How often each cause was behind a name, in the campaigns of `docs/campaign.md`.
//!
//! A campaign knows the true cause of each fault, and draws all kinds about equally often. So these shares are the probabilities of the
//! causes of a name, if nothing is known about a machine beforehand.

use cophase_core::supervisor::FaultKind;

/// Rows of sensor, name, cause, and number of faulty runs. [The manual](../../../docs/campaign.md#what-a-name-means) has the command that
/// writes it.
const COUNTED: &str = include_str!("../../../docs/causes.csv");

/// Runs of a name below which a percentage says nothing.
const LEAST_RUNS: u32 = 50;

/// Causes of faults with this name, as an encoder or an index alone names them: the most frequent first, with the share of each, 0 to 1.
/// Empty for a name that campaigns hardly had.
pub fn causes(name: FaultKind, has_encoder: bool) -> Vec<(&'static str, f64)> {
    let sensor = if has_encoder { "encoder" } else { "index" };
    let counted: Vec<(&str, u32)> = COUNTED
        .lines()
        .filter_map(|line| {
            let mut cells = line.split(',');
            let is_it = cells.next() == Some(name.name()) && cells.next() == Some(sensor);
            let (cause, runs) = (cells.next()?, cells.next()?.parse().ok()?);
            is_it.then_some((cause, runs))
        })
        .collect();
    let all: u32 = counted.iter().map(|(_, runs)| runs).sum();
    if all < LEAST_RUNS {
        return Vec::new();
    }
    let share = |(cause, runs)| (cause, f64::from(runs) / f64::from(all));
    counted.into_iter().map(share).collect()
}

/// A sentence about the causes that were behind at least one of 100 faults with this name; nothing if there is only one.
pub(super) fn causes_in_words(name: FaultKind, has_encoder: bool) -> String {
    let percent = |(cause, share): (_, f64)| (cause, (100.0 * share).round());
    let shares: Vec<_> = causes(name, has_encoder)
        .into_iter()
        .map(percent)
        .filter(|&(_, percent)| percent >= 1.0)
        .map(|(cause, percent)| format!("{cause} {percent}"))
        .collect();
    match shares.len() {
        0 | 1 => String::new(),
        _ => format!(
            " Causes of 100 such names in the campaign: {}.",
            shares.join(", ")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If shares were of another sensor or did not add up, a user would be given a wrong probability.
    #[test]
    fn shares_are_of_the_sensor_and_add_up() {
        for has_encoder in [false, true] {
            for name in FaultKind::ALL {
                let causes = causes(name, has_encoder);
                let sum: f64 = causes.iter().map(|(_, share)| share).sum();
                assert!(causes.is_empty() || (sum - 1.0).abs() < 1e-12, "{sum}");
                assert!(causes.is_sorted_by(|a, b| a.1 >= b.1), "{causes:?}");
            }
        }
        let [index, encoder] =
            [false, true].map(|has_encoder| causes(FaultKind::LostSteps, has_encoder));
        // An index alone does not show whether a crank was held or lost steps.
        assert!(index[0].1 < 0.9, "{index:?}");
        assert!(encoder[0].1 > index[0].1, "{encoder:?}");
        assert_eq!(index[0].0, "lost-steps");
    }

    #[test]
    fn a_name_with_one_cause_needs_no_sentence() {
        assert_eq!(causes_in_words(FaultKind::StopInput, true), "");
        let words = causes_in_words(FaultKind::IndexTimeout, false);
        assert!(words.contains("index-missing") && words.contains("stuck"), "{words}");
    }
}
