//! Cranks that slip on their shafts, which their encoders do not detect, or that an index alone watches, and sensors that only seem to show
//! a slip.

use super::*;
use std::format;

/// Plays ticks in which encoders read the commanded phases. Crank i has the phase error `slipped(i, turns)`, and `sensor` changes its
/// pulses.
fn play(
    cranks: &mut Cranks,
    ticks: u32,
    slipped: impl Fn(usize, f64) -> f64,
    sensor: impl Fn(usize, f64, Option<IndexPulse>) -> Option<IndexPulse>,
) -> Vec<(FaultKind, Option<usize>, bool)> {
    let mut found = Vec::new();
    for _ in 0..ticks {
        let at = |tick: i32| f64::from(tick) * cranks.speed;
        let (start, end) = (at(cranks.tick), at(cranks.tick + 1));
        let phase = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(start)),
            turns: Turns::from_num(cranks.speed),
        };
        let pulses = core::array::from_fn(|i| {
            let (from, to) = (start + slipped(i, start), end + slipped(i, end));
            let pulse = (to.floor() > from.floor()).then(|| IndexPulse {
                cycle: ((to.floor() - from) / (to - from) * f64::from(TICK_CYCLES)) as i32,
            });
            sensor(i, end, pulse)
        });
        let counts = [(end * 3200.0).floor() as i32; MAX_AXES];
        let detected = detect(&mut cranks.monitor, &pulses, &counts, &[phase; MAX_AXES]);
        found.extend(detected.map(|reported| {
            (
                reported.fault.kind,
                reported.fault.axis,
                reported.within_limits,
            )
        }));
        cranks.tick += 1;
    }
    found
}

/// If this fails, a crank that falls back fast on its shaft is first reported as a missing index, which does not stop the machine. The stop
/// then comes a turn later.
#[test]
fn a_fast_slip_stops_the_machine_as_its_flag_comes() {
    let mut cranks = encoders(3.0);
    let slip = |i: usize, t: f64| {
        if i == 0 {
            -0.03 * (t - 2.3).max(0.0)
        } else {
            0.0
        }
    };
    let ticks = ((3.1 / cranks.speed) as i32 - cranks.tick).unsigned_abs();
    let found = play(&mut cranks, ticks, slip, |_, _, pulse| pulse);
    assert!(
        found.contains(&(FaultKind::Slip, Some(0), false)),
        "{found:?}"
    );
}

/// If this fails, a crank that slipped once, by little, is never again confirmed by its encoder. A pulse that is lost long after then stops
/// a sound machine, and any later cause that takes the crank beyond a limit is called a slip.
#[test]
fn a_slip_of_long_ago_is_not_why_a_pulse_is_missing() {
    let mut cranks = encoders(30.0);
    let slip = |i: usize, t: f64| {
        let slipped = -0.0007 * (t - 2.0).clamp(0.0, 10.0);
        if i == 0 { slipped } else { 0.0 }
    };
    let ticks = (20.5 / cranks.speed) as u32;
    let found = play(&mut cranks, ticks, slip, |_, _, pulse| pulse);
    assert!(!found.is_empty());
    assert_eq!(cranks.monitor.axes[0].name(), None);
    let once = |i: usize, t: f64, pulse: Option<IndexPulse>| {
        pulse.filter(|_| i != 0 || !(22.5..23.5).contains(&t))
    };
    let ticks = (3.0 / cranks.speed) as u32;
    let found = play(&mut cranks, ticks, slip, once);
    assert_eq!(found, [(FaultKind::IndexMissing, Some(0), true)]);
}

/// If this fails, a crank that slips far back on its shaft is detected a turn later than its flag shows it, as its pulse counts as noise.
/// The disadvantage is that noise in the turn after a lost pulse stops the machine, too.
#[test]
fn a_pulse_elsewhere_after_a_missing_one_is_a_crank_that_moved() {
    for (slip, noise_at) in [(-0.7, None), (0.0, Some(3.3))] {
        let mut cranks = encoders(3.0);
        let slipped = move |i: usize, t: f64| if i == 1 && t > 2.1 { slip } else { 0.0 };
        let sensor = move |i: usize, t: f64, pulse: Option<IndexPulse>| {
            let Some(at) = noise_at.filter(|_| i == 1) else {
                return pulse;
            };
            let pulse = pulse.filter(|_| !(2.5..3.5).contains(&t));
            let noise = (t - at).abs() < 0.0051;
            pulse.or(noise.then_some(IndexPulse { cycle: 100 }))
        };
        let found = play(&mut cranks, 260, slipped, sensor);
        let last = found.last().expect("a finding");
        assert_eq!(*last, (FaultKind::Slip, Some(1), false), "{found:?}");
    }
}

/// If this fails, the position in which a crank was left counts as its motion. Of two cranks that are apart, the sound one is then named.
#[test]
fn where_a_crank_is_first_detected_is_no_slip() {
    let mut cranks = Cranks::new(monitor_with_encoders(30.0), 0.01);
    let found = play(
        &mut cranks,
        350,
        |i, _| [0.0, 0.008, -0.006, 0.0, 0.0, 0.0][i],
        |_, _, pulse| pulse,
    );
    assert_eq!(found, []);
    for axis in &cranks.monitor.axes {
        assert_eq!(axis.name(), None);
    }
}

/// If this fails, a crank that gains before its place is confirmed looks like noise, and is detected in the third turn after it passed its
/// limit. With its encoder it slips on its shaft.
#[test]
fn a_crank_that_gains_in_homing_is_detected_within_two_turns_of_its_limit() {
    let speed = 0.01;
    let mut late_by = f64::MIN;
    for has_encoder in [false, true] {
        for (gained, over, from) in [0.03, 0.06, 0.2]
            .into_iter()
            .flat_map(|gained| [0.15, 0.4, 0.8].map(|over| (gained, over)))
            .flat_map(|(gained, over)| [0.1, 0.3, 0.45, 0.7].map(|from| (gained, over, from)))
        {
            let mut settings = settings(3, 3.0, 5.0, 15.0);
            for axis in &mut settings.axes {
                axis.encoder = has_encoder;
                axis.index_turns = Some(0.5);
            }
            let mut cranks = Cranks::new(configured(&settings), speed);
            cranks.flags = [0.5; MAX_AXES];
            let gains = |i: usize, t: f64| {
                let part = ((t - from) / over).clamp(0.0, 1.0);
                if i == 1 { gained * part } else { 0.0 }
            };
            let alone = true_alone(3, 1);
            let passes = from + over * alone / gained;
            let detected = (0..400).find(|_| {
                let found = cranks.turn_shafts(1, gains);
                let stops = found.iter().any(|(_, finding)| !finding.within_limits);
                // As a step of homing evaluates it.
                let moved = cranks.monitor.take_moved();
                let left = cranks.monitor.left_beyond_limits(&PerAxis::default());
                stops || moved.is_some() && left.is_some()
            });
            let case = format!("{gained} turns over {over} from {from}, encoder {has_encoder}");
            let tick = detected.unwrap_or_else(|| panic!("not detected: {case}"));
            let after = f64::from(tick + 1) * speed - passes;
            let gate = cranks.monitor.axes[1].config.gate.to_num::<f64>();
            assert!(
                after <= 2.0 + alone.max(gate) + 2.0 * speed,
                "{after} turns: {case}"
            );
            late_by = late_by.max(after);
        }
    }
    assert!(late_by > 1.2, "{late_by}: nothing was tried");
}

/// If this fails, noise that comes twice in a turn ends homing with a place where no flag is.
#[test]
fn two_pulses_elsewhere_in_a_turn_confirm_nothing() {
    for noise in [[0.2, 0.9], [0.1, 0.35], [0.65, 0.95]] {
        let mut cranks = Cranks::new(monitor(3, 3.0, 5.0, 15.0), 0.01);
        cranks.flags = [0.605; MAX_AXES];
        for axis in 0..3 {
            move_flag(&mut cranks.monitor, axis, 0.605);
        }
        let noisy = |i: usize, t: f64, pulse: Option<IndexPulse>| {
            let is_noise = noise.iter().any(|at| (0.0..0.0099).contains(&(t - at)));
            pulse.or((i == 1 && is_noise).then_some(IndexPulse { cycle: 100 }))
        };
        for _ in 0..300 {
            cranks.turn_with(1, |_, _| 0.0, noisy);
            if cranks.monitor.axes[1].index.is_confirmed() {
                break;
            }
        }
        let off = cranks.monitor.phase_error()[1].to_num::<f64>();
        let is_confirmed = cranks.monitor.axes[1].index.is_confirmed();
        assert!(is_confirmed && off.abs() < 1e-3, "{noise:?}: {off}");
    }
}

/// If this fails, noise before the first pulse and a rotor that swings in its field stop a sound machine in homing.
#[test]
fn a_swing_after_noise_at_the_first_pulse_stops_nothing() {
    for by in [-0.007, 0.007] {
        let mut cranks = Cranks::new(monitor(3, 3.0, 5.0, 15.0), 0.01);
        cranks.flags = [0.605; MAX_AXES];
        for axis in 0..3 {
            move_flag(&mut cranks.monitor, axis, 0.605);
        }
        let noisy = |i: usize, t: f64, pulse: Option<IndexPulse>| {
            let is_noise = i == 1 && (0.0..0.0099).contains(&(t - 0.2));
            pulse.or(is_noise.then_some(IndexPulse { cycle: 100 }))
        };
        let swings = |i: usize, t: f64| {
            let is_off = i == 1 && (1.3..2.1).contains(&t);
            if is_off { by } else { 0.0 }
        };
        let found = cranks.turn_with(400, swings, noisy);
        let stops = found.iter().any(|(_, finding)| !finding.within_limits);
        assert!(!stops && cranks.monitor.is_homed(), "{by}: {found:?}");
    }
}

/// Cranks by index alone, the last of which slips `rate` turns a turn from `from` on. Returns the turns from passing its limit to its stop.
fn late_by_index(count: usize, rate: f64, from: f64) -> f64 {
    let speed = 0.01;
    let mut cranks = Cranks::new(monitor(count, 3.0, 5.0, 15.0), speed).homed();
    let slips = count - 1;
    let found = cranks.turn(6000, |i, t| {
        if i == slips {
            rate * (t - from).max(0.0)
        } else {
            0.0
        }
    });
    let stop = found.iter().find(|(_, finding)| !finding.within_limits);
    let (tick, finding) = stop.expect("reported");
    assert_eq!(finding.fault.axis, Some(slips));
    f64::from(tick + 1) * speed - (from + true_alone(count, slips) / rate.abs())
}

/// If this fails, a crank that slips slowly is compared with a mean that it moves itself. It is then beyond its limit by half of its gain
/// in a turn, or by all of it, before the machine stops for it. Or the machine stops for a crank that is far from its limit.
#[test]
fn a_slow_slip_by_index_is_stopped_for_within_a_turn_of_its_limit() {
    let mut worst = f64::MIN;
    for rate in [-0.01, -0.006, -0.003, -0.001, 0.001, 0.0025, 0.005, 0.011] {
        for from in [2.03, 2.41, 2.87] {
            for late in [2, 3, 5, 6].map(|count| late_by_index(count, rate, from)) {
                worst = worst.max(late);
                assert!(late < 1.02, "{late} turns at {rate}, from {from}");
                // The stop comes earlier by the share of the limit that is reserved for readings, of a crank up to three times as much. (A
                // crank that leaves its place within a turn may have lost a cycle, which is too far here.)
                let early = 3.0 * 0.25 / 360.0 / rate.abs() + 0.02;
                assert!(
                    rate.abs() > 0.005 || late > -early,
                    "{late} turns at {rate}, from {from}"
                );
            }
        }
    }
    assert!(worst > 0.5, "{worst}: nothing was tried");
}

/// A crank that slips at a steady rate is reported as a slip, slow or fast.
#[test]
fn a_walk_is_slip() {
    for a_turn in [-0.03, -0.013, -0.002, -0.0005, 0.0005, 0.002] {
        let mut cranks = Cranks::new(monitor(3, 5.0, 5.0, 15.0), 0.01).homed();
        let found = cranks.turn(4000, move |i, t| {
            if i == 0 {
                a_turn * (t - 2.0).max(0.0)
            } else {
                0.0
            }
        });
        let first = found.first().expect("something is found").1;
        assert_eq!(first.fault.axis, Some(0));
        let named = found.iter().map(|(_, finding)| finding.fault.kind);
        let named: Vec<_> = named
            .filter(|kind| *kind != FaultKind::IndexTimeout)
            .collect();
        // Two consecutive jumps may add up to whole cycles by chance. The next jump shows that the slip continues.
        let last = named.iter().rev().take(2);
        assert!(
            last.clone().all(|kind| *kind == FaultKind::Slip),
            "{a_turn}: {named:?}"
        );
        assert!(
            found.iter().any(|(_, finding)| !finding.within_limits),
            "{a_turn}: beyond the limit"
        );
    }
}

/// Kinds, axes and sizes, in degrees, of what is found in so many ticks of 0.01 turn.
fn walking(
    count: usize,
    ticks: u32,
    off: impl Fn(usize, f64) -> f64,
) -> Vec<(FaultKind, Option<usize>, f64)> {
    let mut cranks = Cranks::new(monitor(count, 5.0, 5.0, 15.0), 0.01).homed();
    let from = f64::from(cranks.tick) * 0.01;
    let found = cranks.turn(ticks, move |i, t| off(i, (t - from).max(0.0)));
    let of = |fault: crate::supervisor::Fault| {
        let size_deg = fault.size.to_num::<f64>() * 360.0;
        (fault.kind, fault.axis, size_deg)
    };
    found.iter().map(|(_, found)| of(found.fault)).collect()
}

/// If this fails, a correction follows a sensor that shifts, and nothing reports it; or a slip is reported before, as which it is not known.
#[test]
fn a_phase_error_that_walks_is_a_drift_before_it_is_a_slip() {
    let tolerance_deg = {
        let cranks = Cranks::new(monitor(3, 5.0, 5.0, 15.0), 0.01);
        cranks.monitor.tolerance(1).to_num::<f64>() * 360.0
    };
    for count in 3..=6 {
        for sense in [-1.0, 1.0] {
            for axis in [0, count - 1] {
                // Two tolerances in 500 turns.
                let a_turn = sense * 2.0 * tolerance_deg / 360.0 / 500.0;
                let found = walking(
                    count,
                    60_000,
                    |i, t| if i == axis { a_turn * t } else { 0.0 },
                );
                let (kind, of, size_deg) = found[0];
                let case = format!("{count}: {axis}, {found:?}");
                assert_eq!((kind, of), (FaultKind::Drift, Some(axis)), "{case}");
                // Less what the reading was off as homing ended, and a window.
                let far = (size_deg / tolerance_deg).abs();
                assert!(
                    size_deg * sense > 0.0 && (1.6..2.4).contains(&far),
                    "{case}"
                );
            }
        }
    }
}

/// If this fails, a machine is stopped and taken apart for a slip that was corrected, or for noise.
#[test]
fn what_does_not_walk_in_one_direction_is_no_drift() {
    let drifts = |off: &dyn Fn(usize, f64) -> f64| {
        let found = walking(3, 60_000, off);
        found.iter().any(|(kind, ..)| *kind == FaultKind::Drift)
    };
    // A slip, at once or in some seconds, up to several gates.
    for size_deg in [0.3, 0.9, 1.7, 3.0, -4.0] {
        for turns in [0.01, 5.0, 30.0, 64.0] {
            let slip = |i: usize, t: f64| {
                let part = ((t - 100.0) / turns).clamp(0.0, 1.0);
                if i == 1 { part * size_deg / 360.0 } else { 0.0 }
            };
            assert!(!drifts(&slip), "{size_deg}° in {turns} turns");
        }
    }
    // An error that comes and goes with the load.
    for period in [50.0, 150.0, 400.0, 1000.0] {
        let swing = |i: usize, t: f64| {
            let angle = core::f64::consts::TAU * t / period;
            if i == 1 {
                0.4 / 360.0 * angle.sin()
            } else {
                0.0
            }
        };
        assert!(!drifts(&swing), "a period of {period} turns");
    }
    // Readings that err by up to a tolerance, uniformly: another one in each turn.
    for seed in 1..20_u32 {
        let noise = |i: usize, t: f64| {
            let mut word = (t + 0.5).floor() as u32 ^ (seed << 20) ^ (i as u32) << 27;
            for _ in 0..3 {
                word = (word ^ word >> 16).wrapping_mul(0x45D9_F3B5);
            }
            (f64::from(word >> 8) / f64::from(1 << 23) - 1.0) * 0.47 / 360.0
        };
        assert!(!drifts(&noise), "seed {seed}");
    }
}
