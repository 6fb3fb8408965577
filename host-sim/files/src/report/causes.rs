//! Probabilities of the causes of a fault's name, from the campaigns of `docs/campaign.md`.
//!
//! In a campaign, the true cause of each fault is known. So a campaign counts how often a cause gets a name: the likelihood of the
//! cause. If all causes are equally frequent, the likelihoods are proportional to the probabilities of the causes (Bayes' theorem).

use std::cmp::Ordering;

use cophase_core::monitor::alternatives;
use cophase_core::settings::AxisSettings;
use cophase_core::supervisor::{Fault, FaultKind};
use serde::Serialize;

/// Numbers of faulty runs. [The manual](../../../docs/campaign.md#what-a-name-means) has the command that writes them.
const COUNTED: &str = include_str!("../../../../docs/causes.csv");

/// Runs with a name below which their causes are not compared.
const MIN_RUNS: u32 = 50;

/// Row of [`COUNTED`].
struct Counted {
    name: &'static str,
    /// `encoder` if the axis has one beside its index, else `index`.
    sensor: &'static str,
    /// `ahead` or `behind`: the sense in which the cause moves the crank. Empty if it moves none.
    sense: &'static str,
    cause: &'static str,
    runs: u32,
}

fn counted() -> impl Iterator<Item = Counted> {
    COUNTED.lines().skip(1).filter_map(|line| {
        let mut cells = line.split(',');
        Some(Counted {
            name: cells.next()?,
            sensor: cells.next()?,
            sense: cells.next()?,
            cause: cells.next()?,
            runs: cells.next()?.parse().ok()?,
        })
    })
}

/// Returns the probability of each cause, 0 to 1, if the name of the fault and `others` are the only causes and equally frequent. The
/// most probable comes first. It is empty for a name that is rare in the campaigns.
fn probabilities(
    fault: &Fault,
    has_encoder: bool,
    others: &[&'static str],
) -> Vec<(&'static str, f64)> {
    let sensor = if has_encoder { "encoder" } else { "index" };
    let name = fault.kind.name();
    let fits_sense = |row: &Counted| match row.sense {
        "ahead" => fault.size >= 0,
        "behind" => fault.size <= 0,
        _ => true,
    };
    let (mut all, mut likelihoods) = (0, Vec::new());
    for cause in [name].iter().chain(others) {
        let of_cause = || counted().filter(|row| row.sensor == sensor && row.cause == *cause);
        let named = of_cause().filter(|row| row.name == name && fits_sense(row));
        let named: u32 = named.map(|row| row.runs).sum();
        let drawn: u32 = of_cause().map(|row| row.runs).sum();
        if named > 0 {
            all += named;
            likelihoods.push((*cause, f64::from(named) / f64::from(drawn)));
        }
    }
    if all < MIN_RUNS {
        return Vec::new();
    }
    let sum: f64 = likelihoods.iter().map(|(_, likelihood)| likelihood).sum();
    likelihoods.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let normalise = |(cause, likelihood)| (cause, likelihood / sum);
    likelihoods.into_iter().map(normalise).collect()
}

/// Kind of fault that may be behind the name of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Cause {
    pub kind: &'static str,
    /// Probability, 0 to 1, if all causes are equally frequent; `None` if the campaigns do not show it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
}

/// Returns true if a kind is a cause: a campaign draws it. An index timeout is none, as it only names what a sensor shows.
fn is_cause(kind: &str) -> bool {
    counted().any(|row| row.cause == kind)
}

/// Returns the causes that the sensors of the fault's axis cannot distinguish, the most probable first. The name of the fault is one of
/// them if it is a cause. It is empty if there is no other, and for the names of limits, which state no cause.
pub(super) fn causes(fault: &Fault, axes: &[AxisSettings]) -> Vec<Cause> {
    let is_limit = matches!(
        fault.kind,
        FaultKind::Tilt | FaultKind::Warp | FaultKind::HomingRangeExceeded
    );
    let axis = fault.axis.filter(|_| !is_limit);
    let Some(settings) = axis.and_then(|axis| axes.get(axis)) else {
        return Vec::new();
    };
    let others: Vec<_> = alternatives(fault, settings).map(FaultKind::name).collect();
    if others.is_empty() {
        return Vec::new();
    }
    // No campaign draws axes without an index.
    let known = if settings.index_turns.is_some() {
        probabilities(fault, settings.encoder, &others)
    } else {
        Vec::new()
    };
    let probability = |kind| known.iter().find(|(cause, _)| *cause == kind);
    let mut causes: Vec<_> = [fault.kind.name()]
        .into_iter()
        .chain(others)
        .filter(|kind| is_cause(kind))
        .map(|kind| Cause {
            kind,
            probability: (!known.is_empty()).then(|| probability(kind).map_or(0.0, |(_, p)| *p)),
        })
        .collect();
    // A stable sort: without probabilities the name stays first.
    causes.sort_by(|a, b| {
        b.probability
            .partial_cmp(&a.probability)
            .unwrap_or(Ordering::Equal)
    });
    causes
}

/// Returns a sentence about the probabilities of causes, with those of at least 1 %. It is empty if fewer than two remain.
pub(super) fn causes_in_words(causes: &[Cause]) -> String {
    let likely: Vec<_> = causes
        .iter()
        .filter_map(|cause| Some((cause.kind, (100.0 * cause.probability?).round())))
        .filter(|&(_, percent)| percent >= 1.0)
        .map(|(cause, percent)| format!("{cause} {percent} %"))
        .collect();
    if likely.len() < 2 {
        return String::new();
    }
    let likely = likely.join(", ");
    format!(" If all of them are equally frequent, their probabilities are: {likely}.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_core::units::Turns;
    use cophase_scene::library;
    use host_sim::checked::Checked;

    fn fault(kind: FaultKind, size: f64) -> Fault {
        Fault::new(kind).with_size(Turns::from_num(size))
    }

    /// If this fails, a user examines the coupling where the drive is as likely, or the reverse.
    #[test]
    fn ahead_rules_out_stuck_and_behind_rules_out_runaway() {
        let ahead = fault(FaultKind::Slip, 0.05);
        let behind = fault(FaultKind::Slip, -0.05);
        let others = ["runaway", "stuck"];
        let causes = |fault| probabilities(fault, false, &others);
        let names = |fault| {
            causes(fault)
                .iter()
                .map(|(cause, _)| *cause)
                .collect::<Vec<_>>()
        };
        assert_eq!(names(&ahead).len(), 2, "{:?}", causes(&ahead));
        assert!(names(&ahead).contains(&"runaway"), "{:?}", causes(&ahead));
        assert_eq!(names(&behind), ["slip", "stuck"], "{:?}", causes(&behind));
        assert!(causes(&ahead)[1].1 > 0.2 && causes(&behind)[1].1 < 0.1);
    }

    /// If this fails, probabilities belong to another sensor, or do not add up to 1.
    #[test]
    fn probabilities_depend_on_the_sensor_and_sum_to_one() {
        let lost = fault(FaultKind::LostSteps, -0.02);
        let [index, encoder] =
            [false, true].map(|has| probabilities(&lost, has, &["stuck", "slip"]));
        for causes in [&index, &encoder] {
            assert_eq!(causes[0].0, "lost-steps", "{causes:?}");
            let sum: f64 = causes.iter().map(|(_, probability)| probability).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{causes:?}");
        }
        // An index alone does not show whether a crank was held, or lost steps.
        assert!(
            encoder[0].1 > index[0].1 && index[0].1 < 0.9,
            "{index:?} {encoder:?}"
        );
    }

    /// If this fails, probabilities follow from a few runs by chance.
    #[test]
    fn a_name_with_few_runs_has_no_probabilities() {
        let tilt = fault(FaultKind::Tilt, 0.0);
        let runs: u32 = counted()
            .filter(|row| row.name == "tilt")
            .map(|row| row.runs)
            .sum();
        assert!((1..MIN_RUNS).contains(&runs), "{runs}");
        assert!(probabilities(&tilt, true, &["runaway", "swapped-wiring"]).is_empty());
    }
    /// If this fails, a report states that a stuck crank has a probability of 0 to be what it was named.
    #[test]
    fn a_name_that_no_campaign_draws_is_no_cause() {
        let timeout = fault(FaultKind::IndexTimeout, -0.1).on_axis(0);
        let checked = Checked::new(library::find("default").unwrap().scene()).unwrap();
        let axes = &checked.settings.axes;
        let kinds = causes(&timeout, axes).into_iter().map(|cause| cause.kind);
        let mut kinds: Vec<_> = kinds.collect();
        kinds.sort_unstable();
        assert_eq!(
            kinds,
            ["index-missing", "lost-steps", "runaway", "slip", "stuck"]
        );
    }
}
