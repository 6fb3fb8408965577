//! Cranks with encoders.

use super::*;

/// With an encoder, a crank that stands, turns back or runs away is detected within some ticks, with the right fault kind.
#[test]
fn encoders_show_how_an_axis_moves() {
    for (speed, kind) in [
        (-1.0, FaultKind::Stuck),
        (-1.04, FaultKind::Reversed),
        (-1.25, FaultKind::Reversed),
        (-2.0, FaultKind::Reversed),
        (1.0, FaultKind::Runaway),
    ] {
        let mut cranks = encoders(3.0);
        let began = cranks.tick;
        let found = cranks.turn(100, move |i, t| {
            if i == 2 {
                speed * (t - 1.5).max(0.0)
            } else {
                0.0
            }
        });
        let last = found.last().expect("something is found");
        assert_eq!(
            (last.1.fault.kind, last.1.fault.axis),
            (kind, Some(2)),
            "{found:?}"
        );
        // The motion begins 30 ticks later. A crank that turns back slowly is detected once it has gone back by an electrical cycle.
        let cycle_turns = 64.0 / 3200.0;
        let ticks = if kind == FaultKind::Reversed {
            cycle_turns / 0.01 / (-1.0 - speed)
        } else {
            0.0
        };
        assert!(f64::from(last.0 - began) < 30.0 + 20.0 + ticks, "{found:?}");
    }
}

/// If this fails, a crank that runs away while the machine is being stopped for another one is driven further.
#[test]
fn a_runaway_is_reported_while_another_axis_is_stopped_for() {
    let found = encoders(3.0).turn(60, |i, t| match i {
        1 => -(t - 1.5).clamp(0.0, 0.1),
        2 => (t - 1.6).max(0.0),
        _ => 0.0,
    });
    let mut stops = found.iter().filter(|(_, finding)| !finding.within_limits);
    let axes: Vec<_> = stops
        .clone()
        .map(|(_, finding)| finding.fault.axis)
        .collect();
    assert_eq!(axes, [Some(1), Some(1), Some(2)], "{found:?}");
    let (_, last) = stops.next_back().expect("checked above");
    assert_eq!(
        (last.fault.kind, last.supersedes),
        (FaultKind::Runaway, false)
    );
}

/// Before homing, motors that all lag alike have a common lag. One that lags alone tilts the platform.
#[test]
fn axes_that_lag_alike_in_homing_lag_in_common() {
    let first = |lags: fn(usize) -> bool| {
        let mut cranks = Cranks::new(monitor_with_encoders(3.0), 0.01);
        let found = cranks.turn(90, move |i, t| if lags(i) { -0.1 * t } else { 0.0 });
        let fault = found.first().expect("something is found").1.fault;
        (fault.kind, fault.axis)
    };
    assert_eq!(first(|_| true), (FaultKind::CommonLag, None));
    assert_eq!(first(|i| i == 2), (FaultKind::Tilt, Some(2)));
}

/// If this fails, a fault names the axis that is furthest from the others, and not the one whose encoder shows that it stands.
#[test]
fn the_axis_that_stands_is_named_before_the_one_that_is_furthest() {
    let apart_deg = [0.8, 1.7, -1.7, -0.5];
    let mut settings = settings(4, 100.0, 1.8, 15.0);
    for axis in &mut settings.axes {
        axis.encoder = true;
    }
    let mut monitor = configured(&settings);
    monitor.reset(&[Phase::ZERO; MAX_AXES]);
    let mut cranks = Cranks::new(monitor, 0.002);
    let found = cranks.turn(800, move |i, t| {
        let stood = if i == 0 { (t - 1.3).max(0.0) } else { 0.0 };
        apart_deg[i] / 360.0 - stood
    });
    let fault = found.first().expect("something is found").1.fault;
    assert_eq!((fault.kind, fault.axis), (FaultKind::Stuck, Some(0)));
}

/// If this fails, a soft servo that swings counts as an encoder with a glitch, although its speed changes little from tick to tick.
#[test]
fn a_swing_is_no_jump() {
    let mut cranks = encoders(100.0);
    let jump = cranks.monitor.axes[2].config.jump().to_num::<f64>();
    let (per_tick, speed) = (0.5, 0.01);
    let size = 1.1 * jump / per_tick;
    let from = f64::from(cranks.tick) * speed;
    let swing = move |i: usize, t: f64| {
        let angle = (t - from).max(0.0) / speed * per_tick;
        if i == 2 {
            size * (1.0 - angle.cos())
        } else {
            0.0
        }
    };
    assert_eq!(cranks.turn(250, swing), []);
}

/// A reading that jumps is held back for a tick. A servo that stands is stuck and not reversed, wherever in a window that begins.
#[test]
fn a_servo_that_stands_at_speed_is_stuck_whenever_that_begins() {
    let mut settings = settings(3, 3.0, 5.0, 15.0);
    for axis in &mut settings.axes {
        axis.encoder = true;
        axis.cycle_steps = 0;
    }
    for quarter in 0..16 {
        let mut monitor = configured(&settings);
        monitor.reset(&[Phase::ZERO; MAX_AXES]);
        let mut cranks = Cranks::new(monitor, 0.02).homed();
        let from = 1.5 + 0.005 * f64::from(quarter);
        let stands = move |i: usize, t: f64| {
            if i == 2 { -(t - from).max(0.0) } else { 0.0 }
        };
        let found = cranks.turn(50, stands);
        let kinds: Vec<_> = found.iter().map(|(_, found)| found.fault.kind).collect();
        assert_eq!(
            kinds.last(),
            Some(&FaultKind::Stuck),
            "{quarter}: {found:?}"
        );
    }
}

/// If this fails, a motor that is released, returns to where its field holds it and swings there counts as reversed, and the drives are
/// disabled.
#[test]
fn a_crank_that_is_let_go_springs_back_and_is_stuck_all_the_same() {
    // From the end of its swing that is ahead, from the other one, and from between, either way.
    for eighth in 0..8 {
        let mut cranks = encoders(3.0);
        let begin = core::f64::consts::FRAC_PI_4 * f64::from(eighth);
        let found = cranks.turn(150, |i, t| {
            let stood = (t - 1.5).clamp(0.0, 0.2);
            // An electrical cycle from end to end, less a count, in twenty ticks.
            let angle = core::f64::consts::PI * (t - 1.7) / 0.1;
            let swing = (0.01 - 1.0 / 3200.0) * ((begin + angle).cos() - begin.cos());
            let swing = if t > 1.7 { swing } else { 0.0 };
            if i == 2 { -stood + swing } else { 0.0 }
        });
        let kinds: Vec<_> = found.iter().map(|(_, found)| found.fault.kind).collect();
        assert!(!kinds.contains(&FaultKind::Reversed), "{eighth}: {found:?}");
        assert!(kinds.contains(&FaultKind::Stuck), "{eighth}: {found:?}");
    }
}

/// A reading that is off for some ticks is a glitch. The index shows counts that stay lost. The index alone detects a crank that slips on
/// its shaft.
#[test]
fn encoder_and_index_check_each_other() {
    let glitch = |from: f64, to: f64| {
        let mut cranks = encoders(3.0);
        let mut found = Vec::new();
        for _ in 0..400 {
            let t = f64::from(cranks.tick) * 0.01;
            let phase = TickPhase {
                start: Phase::from_turns(Turns::wrapping_from_num(t)),
                turns: Turns::from_num(0.01),
            };
            let end = f64::from(cranks.tick + 1) * 0.01;
            let passes = end.floor() > t.floor();
            let pulse = passes.then(|| IndexPulse {
                cycle: ((end.floor() - t) / 0.01 * f64::from(TICK_CYCLES)) as i32,
            });
            let count = (end * 3200.0).floor() as i32;
            let off = if (from..to).contains(&t) { 500 } else { 0 };
            let counts = [count, count + off, count, 0, 0, 0];
            let sensed = detect(
                &mut cranks.monitor,
                &[pulse; MAX_AXES],
                &counts,
                &[phase; MAX_AXES],
            );
            found.extend(sensed.map(|finding| (finding.fault.kind, finding.fault.axis)));
            cranks.tick += 1;
        }
        let drift = cranks.monitor.phase_error()[1].to_num::<f64>();
        assert!(drift.abs() < 2.0 / 3200.0, "a glitch is no drift: {drift}");
        found
    };
    let reported = (FaultKind::EncoderGlitch, Some(1));
    assert_eq!(glitch(1.5, 1.505), [reported], "for a tick");
    assert_eq!(glitch(1.5, 99.0), [reported], "for good");
    assert_eq!(glitch(1.5, 1.7), [reported], "and back before the index");
    let mut cranks = encoders(30.0);
    let mut settings = Vec::new();
    for _ in 0..1500 {
        let t = f64::from(cranks.tick) * 0.01;
        let phase = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(t)),
            turns: Turns::from_num(0.01),
        };
        let end = f64::from(cranks.tick + 1) * 0.01;
        let crank = |t: f64, i: usize| {
            if i == 0 {
                t - 0.002 * (t - 1.5).max(0.0)
            } else {
                t
            }
        };
        let pulses = core::array::from_fn(|i| {
            let (from, to) = (crank(t, i), crank(end, i));
            (to.floor() > from.floor()).then(|| IndexPulse {
                cycle: ((to.floor() - from) / (to - from) * f64::from(TICK_CYCLES)) as i32,
            })
        });
        let counts = [(end * 3200.0).floor() as i32; MAX_AXES];
        let sensed = detect(&mut cranks.monitor, &pulses, &counts, &[phase; MAX_AXES]);
        settings.extend(sensed.map(|finding| (finding.fault.kind, finding.fault.axis)));
        cranks.tick += 1;
    }
    assert!(!settings.is_empty());
    assert!(
        settings
            .iter()
            .all(|reported| *reported == (FaultKind::Slip, Some(0))),
        "{settings:?}"
    );
}

/// If this fails, a crank that no longer turns with its motor, so that its flag never comes, is not stopped for.
#[test]
fn the_third_missing_pulse_in_a_row_beside_an_encoder_stops_the_machine() {
    let mut cranks = encoders(3.0);
    let dead = |i: usize, _: f64, pulse: Option<IndexPulse>| pulse.filter(|_| i != 1);
    let found = cranks.turn_with(400, |_, _| 0.0, dead);
    let reported: Vec<_> = found
        .iter()
        .map(|(_, found)| (found.fault.kind, found.within_limits))
        .collect();
    let missing = |within_limits| (FaultKind::IndexMissing, within_limits);
    assert_eq!(
        reported[..3],
        [missing(true), missing(true), missing(false)]
    );
}

/// An index pulse that is missing, or extra, on an axis with an encoder is reported, and the machine keeps running.
#[test]
fn an_encoder_vouches_for_its_crank() {
    let mut cranks = encoders(3.0);
    let once = |i: usize, t: f64, pulse: Option<IndexPulse>| pulse.filter(|_| i != 1 || t > 2.5);
    let found = cranks.turn_with(300, |_, _| 0.0, once);
    let kinds: Vec<_> = found
        .iter()
        .map(|(_, f)| (f.fault.kind, f.within_limits))
        .collect();
    assert_eq!(kinds, [(FaultKind::IndexMissing, true)]);
}

/// If this fails, the noise of a single reading is in the size of the fault with which a start is refused.
#[test]
fn a_crank_that_was_left_beyond_its_limits_has_a_filtered_size() {
    let mut cranks = Cranks::new(monitor_with_encoders(3.0), 0.01);
    let left = [0.0, 0.05, 0.0, 0.0, 0.0, 0.0];
    cranks.before = left;
    cranks.turn(300, |i, _| left[i]);
    cranks.turn(1, |i, _| left[i] + if i == 1 { 0.004 } else { 0.0 });
    let none = PerAxis::default();
    let (axis, by) = cranks.monitor.left_beyond_limits(&none).expect("beyond");
    assert_eq!(axis, 1);
    let noise = by.to_num::<f64>() - left[1];
    assert!(noise.abs() < 0.001, "{noise}"); // a sixteenth, and a count
}

/// Turns per tick at which an encoder makes whole counts.
const WHOLE_COUNTS: f64 = 1.0 / 64.0;

/// Phase error of crank 0, degrees, `turns` after the start, if it is `off_deg(turn)` on its shaft in each turn.
fn measured_after(turns: u32, off_deg: impl Fn(u32) -> f64) -> f64 {
    let mut cranks = Cranks::new(monitor_with_encoders(30.0), WHOLE_COUNTS);
    // The flag passes in the middle of a turn of this count.
    let off = |i: usize, t: f64| match i {
        0 => off_deg((t + 0.5) as u32) / 360.0,
        _ => 0.0,
    };
    assert_eq!(cranks.turn_shafts(64 * turns + 32, off), []);
    cranks.monitor.phase_error()[0].to_num::<f64>() * 360.0
}

/// If this fails, the noise of an index pulse is in the phase error of an axis whose encoder shows it with less.
#[test]
fn the_index_of_an_axis_with_an_encoder_adds_a_quarter_of_its_noise_at_most() {
    let noise_deg = 0.4;
    // The first of all pulses, and the last.
    for noisy in [1, 17] {
        let left = measured_after(17, |turn| if turn == noisy { noise_deg } else { 0.0 });
        assert!(
            (0.0..=noise_deg / 4.0).contains(&left),
            "{left} of turn {noisy}"
        );
    }
}

/// If this fails, the mean covers more and more turns, and a crank that moves on its shaft after a long run is measured too late.
#[test]
fn a_small_slip_is_measured_after_as_many_turns_however_long_the_machine_ran() {
    for before in [20, 400] {
        let slip = |turn: u32| if turn > before { 0.4 } else { 0.0 };
        let shown = measured_after(before + 32, slip);
        assert!((0.3..=0.4).contains(&shown), "{shown} after {before} turns");
    }
}

/// If this fails, the mean of sixteen turns hides a crank that slips on its shaft by more than a reading can err.
#[test]
fn a_slip_beyond_the_error_of_a_reading_is_measured_at_once() {
    for a_turn_deg in [0.6, 1.2, -0.9] {
        let mut cranks = Cranks::new(monitor_with_encoders(100.0), WHOLE_COUNTS).homed();
        let tolerance = cranks.monitor.tolerance(0).to_num::<f64>();
        let slip = |i: usize, t: f64| match i {
            0 => a_turn_deg / 360.0 * (t + 0.5 - 2.0).floor().max(0.0),
            _ => 0.0,
        };
        cranks.turn_shafts(64 * 8, slip);
        let end = f64::from(cranks.tick) * WHOLE_COUNTS;
        let off = cranks.monitor.phase_error()[0].to_num::<f64>() - slip(0, end);
        assert!(
            off.abs() <= tolerance,
            "{off} turns, {a_turn_deg} degrees a turn"
        );
    }
}

/// If this fails, a crank that slips as its motor jumps counts as one that made only the jump. It is then stopped for a turn later.
#[test]
fn a_crank_that_moves_further_than_its_encoder_has_slipped() {
    let mut cranks = encoders(10.0);
    let jumps = |by: f64| move |i: usize, t: f64| if i == 1 && t > 1.5 { by } else { 0.0 };
    let ticks = 105;
    let found = cranks.turn_motors(ticks, jumps(0.1), |_, _, pulse| pulse, jumps(0.01));
    let (_, last) = found.last().expect("it is beyond its limit");
    assert_eq!(
        (last.fault.kind, last.fault.axis),
        (FaultKind::Slip, Some(1)),
        "{found:?}"
    );
    assert!(!last.within_limits);
    let shown = cranks.monitor.phase_error()[1].to_num::<f64>();
    assert!((shown - 0.1).abs() < 0.001, "{shown}");
}

/// If this fails, a fault gets the name of what its crank does at the end of a long stop, and not of what the machine was stopped for.
#[test]
fn a_fault_gets_no_better_name_once_the_stop_has_lasted_four_turns() {
    for (later, is_renamed) in [(2.0, true), (5.0, false)] {
        let mut cranks = encoders(3.0);
        // The motor lags slowly until the platform is tilted, and stands later.
        let off = |i: usize, t: f64| match i {
            1 => -0.2 * (t - 1.5).clamp(0.0, 0.2) - (t - 1.7 - later).max(0.0),
            _ => 0.0,
        };
        let ticks = ((later + 1.0) / cranks.speed) as u32;
        let found = cranks.turn(ticks, off);
        let kinds: Vec<_> = found.iter().map(|(_, found)| found.fault.kind).collect();
        assert_eq!(kinds.first(), Some(&FaultKind::Tilt), "{found:?}");
        assert_eq!(kinds.contains(&FaultKind::Stuck), is_renamed, "{found:?}");
    }
}
