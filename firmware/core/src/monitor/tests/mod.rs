//! Tests of the monitor with cranks whose errors are known.

mod cranks;
mod encoders;
mod index_timeout;
mod indistinguishable;
mod judge;
mod rounds;
mod runaways;
mod slips;
mod ticks;
mod trajectories;

use super::*;
use crate::commanded::TickPhase;
use cranks::*;
use std::vec::Vec;

/// If this fails, the interpolation inside the tick is wrong, and the phase error changes with the speed by up to a tick's turns.
#[test]
fn drift_is_measured_to_a_cycle_at_any_speed() {
    for speed in [0.0005, 0.013, 0.1, 0.4] {
        let mut cranks = Cranks::new(monitor(4, 100.0, 90.0, 180.0), speed);
        let errors = [0.01, -0.02, 0.003, 0.0, 0.0, 0.0];
        cranks.before = errors;
        let ticks = (3.0 / speed) as u32 + 1;
        assert_eq!(cranks.turn(ticks, |i, _| errors[i]), []);
        assert!(cranks.monitor.is_homed());
        for (actual, expected) in cranks.monitor.phase_error().iter().zip(errors) {
            let error = actual.to_num::<f64>() - expected;
            // The pulse's own cycle, rounded down, and the interpolation's 24 bits.
            let bound = speed / f64::from(TICK_CYCLES) + speed * (-24.0_f64).exp2() + 1e-11;
            assert!(error.abs() < bound, "{error:e} at {speed} turns a tick");
        }
    }
}

/// A tilt limit in mrad is met at the amplitude that geometry gives, neither before nor after.
#[test]
fn tilt_trips_at_its_limit() {
    // Mode 1 of one axis in three with the error e is 2/3 e. The maximum of s(α) at λ = 0.3 is found by fine search.
    let max_travel = (0..100_000)
        .map(|i| {
            let alpha = f64::from(i) * core::f64::consts::PI / 100_000.0;
            let (sin, cos) = alpha.sin_cos();
            sin + 0.3 * sin * cos / (1.0 - 0.09 * sin * sin).sqrt()
        })
        .fold(0.0, f64::max);
    let limit_mrad = 3.0;
    let amplitude = limit_mrad * 1e-3 * 0.25 / 0.02 / max_travel / core::f64::consts::TAU;
    for (part, trips) in [(0.99, false), (1.01, true)] {
        let error = -1.5 * amplitude * part;
        let fault = found_in_homing(
            monitor(3, limit_mrad, 90.0, 180.0),
            [0.0, 0.0, error, 0.0, 0.0, 0.0],
            300,
        );
        assert_eq!(fault.is_some(), trips, "at {part} of the limit");
        if let Some((tick, kind, axis)) = fault {
            assert_eq!((kind, axis), (FaultKind::HomingRangeExceeded, Some(2)));
            assert!(tick <= 206, "two turns and five ticks, and not {tick}");
        }
    }
}

/// Cranks whose phase errors have no fault kind of their own: all drift slowly, or one against the other.
#[test]
fn warp_tilt_and_common_lag_have_limits_of_their_own() {
    let trips = |limits: [f64; 3], off: fn(usize) -> f64| {
        let mut monitor = monitor(4, limits[0], limits[1], limits[2]);
        for axis in &mut monitor.axes {
            axis.config.gate = Turns::lit("0.25"); // no slow slip is named
        }
        let mut cranks = Cranks::new(monitor, 0.01).homed();
        let from = f64::from(cranks.tick) * 0.01;
        let found = cranks.turn(2000, move |i, t| off(i) * (t - from).max(0.0));
        found
            .first()
            .map(|(_, finding)| (finding.fault.kind, finding.within_limits))
    };
    let bent: fn(usize) -> f64 = |i| if i % 2 == 0 { 0.001 } else { -0.001 };
    assert_eq!(
        trips([30.0, 5.0, 180.0], bent),
        Some((FaultKind::Warp, false))
    );
    let tilted: fn(usize) -> f64 = |i| [0.001, 0.0, -0.001, 0.0][i];
    assert_eq!(
        trips([3.0, 80.0, 180.0], tilted),
        Some((FaultKind::Tilt, false))
    );
    let late: fn(usize) -> f64 = |_| -0.001;
    assert_eq!(
        trips([3.0, 5.0, 5.0], late),
        Some((FaultKind::CommonLag, false))
    );
    assert_eq!(
        trips([3.0, 5.0, 19.0], late),
        None,
        "20 turns make 7.2 degrees"
    );
}

/// All axes lag alike, and the pulses of one turn fall into two ticks. If this fails, new and old readings are compared and show a tilt
/// that does not exist, or a crank that jumps with all others is named.
#[test]
fn a_lag_in_common_is_no_ones_own() {
    let mut cranks = Cranks::new(monitor(4, 0.05, 0.05, 180.0), 0.01).homed();
    let from = f64::from(cranks.tick) * 0.01;
    let small = |i: usize| [0.0, -1e-6, 1e-6, 0.0][i];
    let found = cranks.turn(10_000, move |i, t| -0.0037 * (t - from) + small(i));
    assert_eq!(found, []);
    // Now the same at once, further than the gate of a pulse's place.
    let (from, was) = (f64::from(cranks.tick) * 0.01, -0.0037 * 100.0);
    let jump = move |t: f64| if t > from + 0.5 { -0.02 } else { 0.0 };
    assert_eq!(cranks.turn(500, move |i, t| was + small(i) + jump(t)), []);
}

/// If this fails, a crank that failed alone counts as a lag of all, or cranks that all stand together as one that failed.
#[test]
fn a_lag_is_of_all_axes_only_if_each_shows_it() {
    let first = |limits: [f64; 3], off: &dyn Fn(usize, f64) -> f64, dead: Option<usize>| {
        let mut cranks = Cranks::new(monitor(4, limits[0], limits[1], limits[2]), 0.01).homed();
        let from = f64::from(cranks.tick) * 0.01 + 0.4;
        let found = cranks.turn_with(
            600,
            |i, t| off(i, (t - from).max(0.0)),
            |i, _, pulse| pulse.filter(|_| dead != Some(i)),
        );
        let (_, finding) = found.first().expect("something is found");
        (finding.fault.kind, finding.all_lag)
    };
    let tight = [3.0, 5.0, 15.0];
    // All stand: each pulse is overdue.
    let stand = |_: usize, t: f64| -t;
    assert_eq!(first(tight, &stand, None), (FaultKind::IndexTimeout, true));
    // All but one stand, for each axis as the one that turns.
    for goes_on in 0..4 {
        let off = move |i: usize, t: f64| if i == goes_on { 0.0 } else { -t };
        assert!(!first(tight, &off, None).1, "axis {goes_on} goes on");
    }
    // One stands, or its sensor is dead. The others are behind by 1 degree, which is no lag.
    for alone in 0..4 {
        let one = move |i: usize, t: f64| {
            if i == alone {
                -t
            } else {
                (-t).max(-1.0 / 360.0)
            }
        };
        assert_eq!(first(tight, &one, None), (FaultKind::IndexTimeout, false));
        let none = |_: usize, _: f64| 0.0;
        assert_eq!(
            first(tight, &none, Some(alone)),
            (FaultKind::IndexTimeout, false)
        );
    }
    // Pulses show a lag that grows by 3.6 degrees a turn. A lead is no lag.
    let slow = |_: usize, t: f64| -0.01 * t;
    assert_eq!(
        first([3.0, 5.0, 5.0], &slow, None),
        (FaultKind::CommonLag, true)
    );
    let ahead = |_: usize, t: f64| 0.01 * t;
    assert_eq!(
        first([3.0, 5.0, 5.0], &ahead, None),
        (FaultKind::CommonLag, false)
    );
}

#[test]
fn an_index_timeout_is_reported_within_its_turn() {
    let mut cranks = Cranks::new(monitor(4, 3.0, 5.0, 15.0), 0.01).homed();
    let began = cranks.tick;
    let found = cranks.turn_with(300, |_, _| 0.0, |i, _, pulse| pulse.filter(|_| i != 3));
    let (tick, finding) = found[0];
    assert_eq!(
        (finding.fault.kind, finding.fault.axis),
        (FaultKind::IndexTimeout, Some(3))
    );
    assert!(!finding.within_limits);
    // Homing ends at 1.2 turns. The pulse is due 80 ticks later. The travel that would tilt the platform too far is added.
    assert!(
        tick - began <= 80 + 8,
        "found after {} ticks of 0.01 turn",
        tick - began
    );
}

/// If this fails, an index pulse that is missing once and then comes in its place is reported as a fault of the crank, and not of the
/// sensor.
#[test]
fn one_pulse_that_stays_away_gets_its_name_when_the_next_comes() {
    let mut cranks = Cranks::new(monitor(4, 3.0, 5.0, 15.0), 0.01).homed();
    let once = |i: usize, t: f64, pulse: Option<IndexPulse>| pulse.filter(|_| i != 1 || t > 2.5);
    let found = cranks.turn_with(300, |_, _| 0.0, once);
    let kinds: Vec<_> = found
        .iter()
        .map(|(_, f)| (f.fault.kind, f.supersedes))
        .collect();
    assert_eq!(
        kinds,
        [
            (FaultKind::IndexTimeout, false),
            (FaultKind::IndexMissing, true)
        ]
    );
}

/// An extra pulse where no flag is: it is reported once the true one has arrived, and no phase error changes. Where a crank at twice its
/// speed can make both pulses, the cause is uncertain.
#[test]
fn an_extra_pulse_is_reported_and_changes_nothing() {
    for (at, is_sure) in [
        (0.1, true),
        (0.3, true),
        (0.46, true),
        (0.5, false),
        (0.64, false),
        (0.68, true),
        (0.9, true),
        (0.97, true),
    ] {
        let mut cranks = Cranks::new(monitor(4, 3.0, 5.0, 15.0), 0.01).homed();
        let extra = move |i: usize, t: f64, pulse: Option<IndexPulse>| {
            let now = (t - 2.0 - at).abs() < 0.0051;
            pulse.or((i == 2 && now).then_some(IndexPulse { cycle: 100 }))
        };
        let found = cranks.turn_with(400, |_, _| 0.0, extra);
        let kinds: Vec<_> = found
            .iter()
            .map(|(_, f)| (f.fault.kind, f.within_limits))
            .collect();
        assert_eq!(kinds, [(FaultKind::IndexExtra, is_sure)], "at {at}");
        assert_eq!(found[0].1.fault.axis, Some(2));
    }
}

/// Lost steps, few and many, at any place of the turn, behind and ahead.
#[test]
fn lost_steps_are_detected_within_a_turn_and_counted() {
    for cycles in [-4.0, -2.0, -1.0, 1.0, 2.0, 3.0] {
        for place in [0.05, 0.3, 0.6, 0.95] {
            let mut cranks = Cranks::new(monitor(5, 3.0, 5.0, 15.0), 0.01).homed();
            let lost = move |i: usize, t: f64| {
                let gone = i == 1 && t > 2.0 + place;
                if gone { cycles * 0.02 } else { 0.0 }
            };
            let found = cranks.turn(500, lost);
            let last = found.last().expect("something is found").1;
            assert_eq!(
                last.fault.kind,
                FaultKind::LostSteps,
                "{cycles} at {place}: {found:?}"
            );
            assert_eq!(last.fault.axis, Some(1));
            let drift = cranks.monitor.phase_error()[1].to_num::<f64>();
            assert!((drift - cycles * 0.02).abs() < 1e-3, "{drift}");
            let first = f64::from(found[0].0) * 0.01;
            assert!(
                first <= 3.0 + place + 0.02 + 0.005,
                "{cycles} at {place}: detected at {first}"
            );
        }
    }
}
