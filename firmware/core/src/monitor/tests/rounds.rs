//! Cranks by index alone whose flags are at different angles: a limit may be exceeded before the round is over.

use super::*;

/// Cranks whose flags are a quarter of a turn apart, homed.
fn apart(tilt_mrad: f64, cycle_steps: u32) -> Cranks {
    let flags = [0.0, 0.25, 0.5, 0.75, 0.0, 0.0];
    let mut settings = settings(4, tilt_mrad, 5.0, 180.0);
    for (axis, flag) in settings.axes.iter_mut().zip(flags) {
        axis.index_turns = Some(flag);
        axis.cycle_steps = cycle_steps;
    }
    let mut cranks = Cranks::new(configured(&settings), 0.01);
    cranks.flags = flags;
    cranks.homed()
}

/// If this fails, the crank that took the platform beyond a limit is named up to a turn later.
#[test]
fn a_crank_that_exceeds_a_limit_is_named_at_once() {
    let lost = |i: usize, t: f64| if i == 1 && t > 2.1 { 0.02 } else { 0.0 };
    let found = apart(3.0, 64).turn(150, lost);
    let (tick, first) = found.first().expect("it is beyond its limit");
    assert_eq!(
        (first.fault.kind, first.fault.axis),
        (FaultKind::LostSteps, Some(1)),
        "{found:?}"
    );
    assert!(
        *tick < 250,
        "in tick {tick}, and the next flag comes at 250"
    );
}

/// If this fails, a crank whose reading is within a limit only by its error stops the machine up to a turn after its pulse shows that.
#[test]
fn the_limits_are_tightened_as_soon_as_a_crank_has_moved() {
    let mut cranks = apart(3.0, 0);
    let tightened = cranks.monitor.single_axis_limit(1).to_num::<f64>();
    let limit = true_alone(4, 1);
    assert!(limit > tightened * 1.02, "{tightened}, {limit}");
    let by = 0.5 * (tightened + limit);
    let moved = |i: usize, t: f64| if i == 1 && t > 2.1 { by } else { 0.0 };
    let found = cranks.turn(150, moved);
    let (tick, first) = found.first().expect("it may be beyond its limit");
    assert_eq!(first.fault.axis, Some(1));
    assert!(!first.within_limits);
    assert!(
        *tick < 250,
        "in tick {tick}, and the next flag comes at 250"
    );
}

/// If this fails, cranks that fall back together tilt the platform in the readings, as the first of them is detected before the others.
#[test]
fn cranks_that_fall_back_together_are_compared_once_all_are_detected() {
    let mut settings = settings(4, 3.0, 5.0, 180.0);
    for axis in &mut settings.axes {
        axis.cycle_steps = 0;
    }
    let mut cranks = Cranks::new(configured(&settings), 0.0005);
    // Their pulses come some ticks apart.
    let apart = |i: usize| 0.001 * i as f64;
    cranks.before = core::array::from_fn(apart);
    assert_eq!(cranks.turn(2450, |i, _| apart(i)), []);
    cranks.monitor.settle();
    let found = cranks.turn(2000, |i, t| apart(i) - if t > 1.5 { 0.03 } else { 0.0 });
    assert_eq!(found, []);
    let by = cranks.monitor.phase_error()[0].to_num::<f64>();
    assert!((by + 0.03).abs() < 1e-4, "{by}");
}

/// If this fails, cranks that all lag more from turn to turn tilt the platform in the readings, as the others were measured earlier.
#[test]
fn a_lag_that_grows_alike_is_no_tilt_within_a_round() {
    // A round ends with axis 1, nine tenths of a turn before axis 0 passes its flag.
    let flags = [0.9, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut settings = settings(2, 0.4, 5.0, 180.0);
    for (axis, flag) in settings.axes.iter_mut().zip(flags) {
        axis.index_turns = Some(flag);
    }
    let mut cranks = Cranks::new(configured(&settings), 0.01);
    cranks.flags = flags;
    let mut cranks = cranks.homed();
    // It grows by 1.3 degrees a turn after 20 turns.
    let lag = |_: usize, t: f64| {
        let grows = (t - 1.5).clamp(0.0, 20.0);
        -0.0037 * (grows * grows / 40.0 + (t - 21.5).max(0.0))
    };
    assert_eq!(cranks.turn(4000, lag), []);
}

/// If this fails, a machine that stops in homing for a pulse that is overdue does not say what the crank did, although its next pulse shows it.
#[test]
fn a_crank_that_is_overdue_in_homing_gets_its_name_as_its_pulse_comes() {
    let mut cranks = Cranks::new(monitor(4, 3.0, 5.0, 15.0), 0.01);
    let lost = |i: usize, t: f64| if i == 1 && t > 1.5 { -0.04 } else { 0.0 };
    let found = cranks.turn(250, lost);
    let kinds: Vec<_> = found
        .iter()
        .map(|(_, found)| (found.fault.kind, found.fault.axis, found.supersedes))
        .collect();
    assert_eq!(
        kinds,
        [
            (FaultKind::IndexTimeout, Some(1), false),
            (FaultKind::LostSteps, Some(1), true)
        ]
    );
}

/// If this fails, a lag that readings cannot distinguish from none widens the limits, and a crank beyond its limit is detected a turn late.
#[test]
fn a_lag_that_grows_by_less_than_a_reading_error_widens_no_limit() {
    let mut cranks = apart(3.0, 0);
    let beyond = cranks.monitor.single_axis_limit(1).to_num::<f64>() + 0.25 / 360.0;
    let off = |i: usize, t: f64| {
        let moved = if i == 1 && t > 4.1 { beyond } else { 0.0 };
        moved - 0.2 / 360.0 * (t - 1.2).max(0.0)
    };
    let found = cranks.turn(400, off);
    let (tick, first) = found.first().expect("it is beyond its limit");
    assert_eq!(first.fault.axis, Some(1));
    assert!(!first.within_limits);
    assert!(
        *tick < 450,
        "in tick {tick}, and the next flag comes at 450"
    );
}

/// If this fails, cranks of a machine that lacks a sensor are never compared with each other, and corrections never come.
#[test]
fn a_round_does_not_wait_for_an_axis_without_a_sensor() {
    let mut settings = settings(4, 3.0, 5.0, 180.0);
    settings.axes[3].index_turns = None;
    let mut cranks = Cranks::new(configured(&settings), 0.01).homed();
    let before = cranks.monitor.rounds();
    assert_eq!(cranks.turn(500, |_, _| 0.0), []);
    assert_eq!(cranks.monitor.rounds() - before, 5);
}
