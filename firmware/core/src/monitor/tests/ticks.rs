//! Pulses and the ticks in which they arrive and are processed.

use super::*;
use proptest::prelude::*;

/// A pulse that is confirmed a tick later belongs to the speed of its own tick. If this fails, it is computed from the
/// later tick's speed, and 2000 rev/s² make 0.018° of 50 µs. One cycle at 200 rev/s is 0.0006°.
#[test]
fn a_pulse_of_the_tick_before_is_measured_as_well() {
    let tick_s = f64::from(TICK_CYCLES) / f64::from(CLOCK_HZ);
    let error = [0.01, -0.02, 0.003, 0.0];
    for (hz_per_s, back_s) in [(2000.0, 50e-6), (-2000.0, 50e-6), (2000.0, 2e-6)] {
        let mut monitor = monitor(4, 100.0, 90.0, 180.0);
        let back = (back_s * f64::from(CLOCK_HZ)) as u32;
        // Speed is constant within a tick, by definition; the phase at the border is near the index.
        let before = (200.0 - hz_per_s * tick_s) * tick_s;
        let now = 200.0 * tick_s;
        let pulse_at = 1.0 - before * f64::from(back) / f64::from(TICK_CYCLES);
        for (axis, error) in error.into_iter().enumerate() {
            move_flag(&mut monitor, axis, pulse_at - 1.0 + error);
        }
        let tick = |start: f64, turns: f64| TickPhase {
            start: Phase::from_turns(Turns::from_num(start)),
            turns: Turns::from_num(turns),
        };
        let pulse = Some(IndexPulse {
            cycle: -(back as i32),
        });
        detect(
            &mut monitor,
            &[None; MAX_AXES],
            &[0; MAX_AXES],
            &[tick(1.0 - before, before); MAX_AXES],
        );
        let found = detect_after(
            &mut monitor,
            &[pulse; MAX_AXES],
            &[0; MAX_AXES],
            &[tick(1.0, now); MAX_AXES],
            Turns::from_num(before),
        );
        assert_eq!(found, None);
        assert_eq!(take_all(&mut monitor, &[tick(1.0, now); MAX_AXES]), []);
        for (actual, expected) in monitor.phase_error().iter().zip(error) {
            let off_deg = (actual.to_num::<f64>() - expected) * 360.0;
            assert!(off_deg.abs() < 0.0006, "{off_deg}° at {hz_per_s} rev/s²");
        }
    }
}

/// After missed deadlines the tick before is unknown. A pulse in it shows only that its sensor works.
#[test]
fn a_pulse_of_a_tick_that_is_not_known_is_not_measured() {
    let mut monitor = monitor(2, 100.0, 90.0, 180.0);
    let phases = [TickPhase {
        start: Phase::ZERO,
        turns: Turns::from_num(0.001),
    }; MAX_AXES];
    detect(&mut monitor, &[None; MAX_AXES], &[0; MAX_AXES], &phases);
    let (lead, history) = history_of(&phases, Turns::ZERO);
    monitor.disregard(&Sensed {
        index: &IndexPulses::NONE,
        encoder: &[0; MAX_AXES],
        phase: Phase::ZERO,
        lead: &lead,
        history: &history,
        correction: &[Turns::ZERO; MAX_AXES],
        speed: Turns::ZERO,
    });
    let pulse = Some(IndexPulse { cycle: -1 });
    detect(&mut monitor, &[pulse; MAX_AXES], &[0; MAX_AXES], &phases);
    take_all(&mut monitor, &phases);
    assert!(!are_detected(&monitor));
    let phases = phases.map(|tick| TickPhase {
        start: Phase::from_turns(Turns::ONE),
        ..tick
    });
    detect(&mut monitor, &[pulse; MAX_AXES], &[0; MAX_AXES], &phases);
    take_all(&mut monitor, &phases);
    assert!(are_detected(&monitor));
}

/// If this fails, pulses that come together wait for each other, or are measured against the phase of another tick.
#[test]
fn pulses_that_come_together_are_processed_in_their_tick() {
    let error = [0.01, -0.02, 0.003, 0.004, -0.005, 0.0];
    let mut monitor = monitor(6, 100.0, 90.0, 180.0);
    for (axis, error) in error.into_iter().enumerate() {
        move_flag(&mut monitor, axis, error);
    }
    let turns = 0.01;
    let tick = TickPhase {
        start: Phase::from_turns(Turns::from_num(1.0 - 0.5 * turns)),
        turns: Turns::from_num(turns),
    };
    let pulse = Some(IndexPulse {
        cycle: (TICK_CYCLES / 2) as i32,
    });
    detect(
        &mut monitor,
        &[pulse; MAX_AXES],
        &[0; MAX_AXES],
        &[tick; MAX_AXES],
    );
    assert!(are_detected(&monitor));
    for (actual, expected) in monitor.phase_error().iter().zip(error) {
        let off = actual.to_num::<f64>() - expected;
        assert!(off.abs() < 1e-6, "{actual} for {expected}");
    }
}

/// If this fails, a pulse waits for those of other axes, and a stop comes later than the docs prove.
#[test]
fn a_pulse_is_evaluated_in_its_tick_however_pulses_of_others_come() {
    // Pulses of one turn are close together. At these speeds the pulses of the next turn arrive while a round ends.
    let speeds = prop_oneof![Just(0.01), 0.05..0.09_f64];
    proptest!(|(count in 2..=6_usize, who in 0..6_usize, speed in speeds, ticks in prop::array::uniform6(0.0..9.0_f64))| {
        let who = who % count;
        let flags = ticks.map(|tick| tick * speed);
        let mut settings = settings(count, 0.05, 0.05, 15.0);
        for (axis, flag) in settings.axes.iter_mut().zip(flags) {
            axis.index_turns = Some(flag);
        }
        let mut cranks = Cranks::new(configured(&settings), speed);
        cranks.flags = flags;
        let mut cranks = cranks.homed();
        let from = f64::from(cranks.tick) * speed;
        // In its place, and beyond the limit, from two ticks after a passage on.
        let passes = (from - flags[who]).ceil() + flags[who];
        let by = 0.004;
        let off = |i: usize, t: f64| if i == who && t > passes + 2.0 * speed { by } else { 0.0 };
        let found = cranks.turn((3.0 / speed) as u32, off);
        let stop = found.first().expect("it is beyond the limit").0;
        let passed = (passes + 1.0 - by) / speed;
        prop_assert_eq!(stop, passed as i32);
    });
}

/// If this fails, pulses that come faster than they are processed keep the limits from being checked.
#[test]
fn limits_are_checked_at_any_speed() {
    for speed in [0.1, 0.25, 0.3987, 0.5] {
        for count in 2..=6 {
            let mut cranks = Cranks::new(monitor(count, 0.05, 0.05, 180.0), speed).homed();
            assert_eq!(cranks.turn(100, |_, _| 0.0), [], "{count}, {speed}");
            let off = |i: usize, _: f64| if i == 1 { 0.004 } else { 0.0 };
            assert_ne!(cranks.turn(100, off), [], "{count} axes at {speed}");
        }
    }
}

/// A sensor that bounces at every other passage, at 0.4 turns a tick. A pulse is confirmed after three widths or one,
/// and the width is a quarter of a tick. A pulse that waits does not count as missing.
#[test]
fn pulses_that_wait_to_be_confirmed_are_not_missed() {
    let mut settings = settings(2, 100.0, 90.0, 1.0);
    settings.index.width_us = 0.25e6 / f64::from(settings.tick_hz);
    let mut monitor = configured(&settings);
    monitor.reset(&[Phase::ZERO; MAX_AXES]);
    let tick_cycles = f64::from(TICK_CYCLES);
    let turns = 0.3987; // so that passages fall anywhere in a tick
    let mut waiting = None;
    for tick in 0..1000 {
        let (start, end) = (f64::from(tick) * turns, f64::from(tick + 1) * turns);
        let mut reported = None;
        if end.floor() > start.floor() {
            let widths = if end.floor() % 2.0 == 0.0 { 3.0 } else { 1.0 };
            let cycle = (end.floor() - start) / turns * tick_cycles;
            if cycle + widths * 0.25 * tick_cycles <= tick_cycles {
                reported = Some(cycle);
            } else {
                waiting = Some(cycle);
            }
        } else {
            reported = waiting.take().map(|cycle| cycle - tick_cycles);
        }
        let pulse = reported.map(|cycle| IndexPulse {
            cycle: cycle as i32,
        });
        let phase = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(start)),
            turns: Turns::from_num(turns),
        };
        let found = detect(
            &mut monitor,
            &[pulse; MAX_AXES],
            &[0; MAX_AXES],
            &[phase; MAX_AXES],
        );
        assert_eq!(found, None, "tick {tick}");
    }
    assert!(monitor.is_homed());
}
