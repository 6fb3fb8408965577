//! Cranks that run away, watched by an index alone, and noise that resembles them.

use super::*;

/// Returns the errors of cranks of which axis 2 turns at `ratio` times its speed from a time on, turns.
fn runs_away(ratio: f64, from: f64) -> impl Fn(usize, f64) -> f64 {
    move |i, t| {
        if i == 2 {
            (ratio - 1.0) * (t - from).max(0.0)
        } else {
            0.0
        }
    }
}

/// If this fails, a crank that runs at some ratio of its speed, from some place of its turn on, counts as noise. At twice its speed one
/// pulse comes in its place, and one more between.
#[test]
fn an_index_detects_a_runaway_at_any_speed_within_a_turn() {
    let speed = 0.01;
    let mut worst = f64::MIN;
    for hundredths in (110..=450).step_by(3) {
        let ratio = f64::from(hundredths) / 100.0;
        for place in [0.02, 0.1, 0.23, 0.37, 0.48, 0.55, 0.61, 0.7, 0.83, 0.97] {
            let mut cranks = Cranks::new(monitor(4, 3.0, 5.0, 15.0), speed).homed();
            let from = 2.0 + place;
            let found = cranks.turn(400, runs_away(ratio, from));
            let stop = found.iter().find(|(_, finding)| !finding.within_limits);
            let (tick, finding) = stop.expect("reported");
            assert_eq!(finding.fault.axis, Some(2), "ratio {ratio}, from {place}");
            let beyond = from + true_alone(4, 2) / (ratio - 1.0);
            let late = f64::from(*tick + 1) * speed - beyond;
            worst = worst.max(late);
            // One tick for the tick that is over, and one for the pulse at its end.
            assert!(
                late < 1.0 + 2.0 * speed,
                "{late} turns: ratio {ratio}, from {place}, {found:?}"
            );
        }
    }
    assert!(
        worst > 0.9,
        "{worst}: some take a turn, or nothing was tried"
    );
}

/// If this fails, noise on a line once a turn counts as a crank that runs away, and stops the machine.
#[test]
fn noise_once_a_turn_is_no_crank_that_runs() {
    for place in [0.1, 0.3, 0.45, 0.51, 0.55, 0.62, 0.7, 0.9] {
        let mut cranks = Cranks::new(monitor(4, 3.0, 5.0, 15.0), 0.01).homed();
        let noise = move |i: usize, t: f64, pulse: Option<IndexPulse>| {
            let now = t > 2.0 && (t.fract() - place).abs() < 0.0051;
            pulse.or((i == 2 && now).then_some(IndexPulse { cycle: 100 }))
        };
        let found = cranks.turn_with(250, |_, _| 0.0, noise);
        assert!(!found.is_empty());
        let kinds: Vec<_> = found.iter().map(|(_, found)| found.fault.kind).collect();
        assert!(
            kinds.iter().all(|&kind| kind == FaultKind::IndexExtra),
            "at {place}: {kinds:?}"
        );
    }
}

/// If this fails, a crank that runs away is called a slip, and its drive stays on: a flag that shows it a whole turn ahead shows no phase
/// error, so no limit is exceeded then.
#[test]
fn a_runaway_that_was_stopped_for_as_a_slip_is_named_within_two_turns() {
    for (ratio, place) in [(1.5, 0.0), (1.55, 0.16), (1.6, 0.32), (1.75, 0.66)] {
        let mut cranks = Cranks::new(monitor(4, 3.0, 5.0, 15.0), 0.01).homed();
        let from = 2.0 + place;
        let found = cranks.turn(400, runs_away(ratio, from));
        let stop = found.first().expect("it is stopped for").0;
        let named = found
            .iter()
            .find(|(_, finding)| finding.fault.kind == FaultKind::Runaway);
        let (tick, named) = named.expect("it gets its name");
        assert_eq!((named.fault.axis, named.supersedes), (Some(2), true));
        assert!(tick - stop <= 200, "ratio {ratio}, from {place}: {found:?}");
    }
}
