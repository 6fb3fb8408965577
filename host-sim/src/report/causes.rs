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

/// Numbers of faulty runs by cause, of faults with this name as an encoder or an index alone names them. The most frequent come first.
fn counted(name: FaultKind, has_encoder: bool) -> impl Iterator<Item = (&'static str, u32)> {
    let sensor = if has_encoder { "encoder" } else { "index" };
    COUNTED.lines().filter_map(move |line| {
        let mut cells = line.split(',');
        let is_it = cells.next() == Some(name.name()) && cells.next() == Some(sensor);
        let (cause, runs) = (cells.next()?, cells.next()?.parse().ok()?);
        is_it.then_some((cause, runs))
    })
}

/// Share of each cause of a name, 0 to 1, among the causes that the sensors cannot distinguish: the name itself, and `others`. Empty for
/// a name that campaigns hardly had.
fn shares(name: FaultKind, has_encoder: bool, others: &[&str]) -> Vec<(&'static str, f64)> {
    let is_alike = |cause: &str| cause == name.name() || others.contains(&cause);
    let alike: Vec<_> = counted(name, has_encoder)
        .filter(|(cause, _)| is_alike(cause))
        .collect();
    let all: u32 = alike.iter().map(|(_, runs)| runs).sum();
    if all < LEAST_RUNS {
        return Vec::new();
    }
    let share = |(cause, runs)| (cause, f64::from(runs) / f64::from(all));
    alike.into_iter().map(share).collect()
}

/// A sentence about the shares of the causes, with those of at least one in 100.
pub(super) fn causes_in_words(name: FaultKind, has_encoder: bool, others: &[&str]) -> String {
    let shares: Vec<_> = shares(name, has_encoder, others)
        .into_iter()
        .map(|(cause, share)| (cause, (100.0 * share).round()))
        .filter(|&(_, percent)| percent >= 1.0)
        .map(|(cause, percent)| format!("{percent} {cause}"))
        .collect();
    if shares.is_empty() {
        return String::new();
    }
    let causes = shares.join(", ");
    format!(" Causes of 100 such faults in the campaign: {causes}.")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If shares were of the other sensor, or did not add up, a user would be given a wrong probability.
    #[test]
    fn shares_are_of_the_sensor_and_add_up() {
        let others = ["stuck", "slip"];
        let [index, encoder] = [false, true].map(|has| shares(FaultKind::LostSteps, has, &others));
        for shares in [&index, &encoder] {
            assert_eq!(shares[0].0, "lost-steps", "{shares:?}");
            let sum: f64 = shares.iter().map(|(_, share)| share).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{shares:?}");
        }
        // An index alone does not show whether a crank was held, or lost steps.
        assert!(index[0].1 < 0.9, "{index:?}");
        assert!(encoder[0].1 > index[0].1, "{encoder:?}");
    }

    #[test]
    fn a_name_without_enough_runs_has_no_share() {
        assert!(shares(FaultKind::Warp, true, &["slip"]).is_empty());
        let words = causes_in_words(FaultKind::IndexTimeout, false, &["stuck", "index-missing"]);
        assert!(
            words.contains(" index-missing") && words.contains(" stuck"),
            "{words}"
        );
    }
}
