//! The time at which a missing pulse is detected: as early as possible, and not before the line and its filter can report the pulse.

use super::*;
use std::format;

/// Tick, and cycles into it, in which a place is reached at an even speed.
fn tick_of(place: f64, speed: f64) -> (i32, f64) {
    let ticks = place / speed;
    (ticks as i32, ticks.fract() * f64::from(TICK_CYCLES))
}

/// If this fails, the index timeout of a crank that stands comes a tick later: at 200 rev/s and 2 kHz that is 36°. A pulse is overdue when
/// its crank may have been beyond its limit for a turn. That is the case when the pulse is late by the limit. A stepper is beyond its limit
/// with one lost cycle, so its pulse is overdue as soon as it is out of place.
#[test]
fn an_overdue_pulse_is_reported_in_the_tick_in_which_it_is_overdue() {
    let filter_cycles = 3.0 * 2e-6 * f64::from(CLOCK_HZ);
    for speed in [0.0013, 0.01, 0.031, 0.0997] {
        for cycle_steps in [0, 64] {
            let mut settings = settings(4, 3.0, 5.0, 15.0);
            settings.axes[3].cycle_steps = cycle_steps;
            let mut monitor = configured(&settings);
            monitor.reset(&[Phase::ZERO; MAX_AXES]);
            let alone = monitor.single_axis_limit(3).to_num::<f64>();
            assert!((0.006..0.018).contains(&alone), "{alone}");
            let gate = 4.0 * monitor.tolerance(3).to_num::<f64>();
            let overdue = if cycle_steps == 0 { alone } else { gate };
            let mut cranks = Cranks::new(monitor, speed).homed();
            let ticks = (2.2 / speed) as u32;
            let found = cranks.turn_with(ticks, |_, _| 0.0, |i, _, pulse| pulse.filter(|_| i != 3));
            let (mut due, cycle) = tick_of(2.0 + overdue, speed);
            // A pulse that arrives within the filter's time before the tick's end may be reported in the next tick.
            due += i32::from(cycle > f64::from(TICK_CYCLES) - filter_cycles);
            assert_eq!(
                (found[0].0, found[0].1.fault.kind),
                (due, FaultKind::IndexTimeout),
                "{speed} turns a tick, {cycle_steps} steps a cycle"
            );
        }
    }
}

/// If this fails, two cranks that stand are each waited for as if the other one turned. Neighbours of four tilt the platform √2 times as far as
/// one of them.
#[test]
fn neighbours_that_are_late_count_together() {
    let speed = 0.0005;
    let found_after = |dead: &[usize]| {
        let mut settings = settings(4, 3.0, 5.0, 15.0);
        for axis in &mut settings.axes {
            axis.cycle_steps = 0;
        }
        let mut monitor = configured(&settings);
        monitor.reset(&[Phase::ZERO; MAX_AXES]);
        let alone = monitor.single_axis_limit(0).to_num::<f64>();
        let gate = 4.0 * monitor.tolerance(0).to_num::<f64>();
        let mut cranks = Cranks::new(monitor, speed).homed();
        let filter =
            |i: usize, _: f64, pulse: Option<IndexPulse>| pulse.filter(|_| !dead.contains(&i));
        let found = cranks.turn_with((2.2 / speed) as u32, |_, _| 0.0, filter);
        let (tick, finding) = found[0];
        assert_eq!(finding.fault.kind, FaultKind::IndexTimeout);
        (f64::from(tick) * speed - 2.0, alone, gate)
    };
    let (one, alone, _) = found_after(&[1]);
    assert!((one - alone).abs() < 2.0 * speed, "{one}, and not {alone}");
    let (two, alone, gate) = found_after(&[1, 2]);
    let expected = (alone / 2.0_f64.sqrt()).max(gate);
    assert!(expected < 0.8 * alone, "the gate does not decide");
    assert!(
        (two - expected).abs() < 2.0 * speed,
        "{two}, and not {expected}"
    );
}

/// If this fails, a line with a delay of more than a tick gives an index timeout in every turn as soon as the machine is fast.
#[test]
fn a_line_that_is_late_is_waited_for() {
    let (speed, late_ticks) = (0.02, 2.5);
    let mut settings = settings(3, 3.0, 5.0, 15.0);
    for axis in &mut settings.axes {
        axis.index_delay_s = late_ticks / f64::from(settings.tick_hz);
    }
    let mut monitor = configured(&settings);
    monitor.reset(&[Phase::ZERO; MAX_AXES]);
    let overdue = 4.0 * monitor.tolerance(1).to_num::<f64>();
    let dead_after = 5.5;
    let mut reported = None;
    for tick in 0..350_i32 {
        let start = f64::from(tick) * speed;
        let phase = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(start)),
            turns: Turns::from_num(speed),
        };
        // Positions of the flags at the time of the line's level that now reaches the loop.
        let flags = |t: f64| (t - late_ticks * speed).max(0.0).floor();
        let passes = flags(start + speed) > flags(start);
        let edge = flags(start + speed) + late_ticks * speed;
        let pulse = passes.then(|| IndexPulse {
            cycle: ((edge - start) / speed * f64::from(TICK_CYCLES)) as i32,
        });
        let of_the_second = pulse.filter(|_| start < dead_after);
        let detected = [pulse, of_the_second, pulse, None, None, None];
        if let Some(finding) = detect(&mut monitor, &detected, &[0; MAX_AXES], &[phase; MAX_AXES]) {
            reported = Some((tick, finding.fault.kind, finding.fault.axis));
            break;
        }
        // Two turns have confirmed the places.
        if tick == (2.2 / speed) as i32 {
            assert!(monitor.is_homed());
            monitor.settle();
        }
    }
    // Due at 6 turns, reported two and a half ticks later, and overdue after the travel that is allowed.
    let (due, _) = tick_of(6.0 + overdue + late_ticks * speed, speed);
    assert_eq!(reported, Some((due, FaultKind::IndexTimeout, Some(1))));
}

/// If this fails, steps that are lost right after an index pulse, and that the encoder detects at once, are named a turn and a margin
/// later. The crank is beyond its limit for all that time.
#[test]
fn steps_lost_beside_an_index_are_known_within_a_turn() {
    for after in [1, 2, 5, 80] {
        for speed in [0.0007, 0.0031, 0.0103] {
            let mut cranks = encoders_at(speed, 3.0);
            let last_pulse = tick_of(2.0, speed).0 + after;
            let lost = move |i: usize, t: f64| {
                let gone = i == 1 && t > (f64::from(last_pulse) + 0.5) * speed;
                if gone { -0.02 } else { 0.0 }
            };
            let found = cranks.turn((3.5 / speed) as u32, lost);
            let (tick, finding) = found[0];
            assert_eq!(finding.fault.kind, FaultKind::LostSteps, "{found:?}");
            // The tick in which the crank was beyond its limit ends at most a turn before the tick of the report begins.
            assert!(
                f64::from(tick - last_pulse - 1) * speed <= 1.0,
                "{after} ticks after the index, {speed} turns a tick: reported {} ticks later",
                tick - last_pulse
            );
        }
    }
}

/// If this fails, a crank that was left at the end of its flag, and swings there or is within the noise of its sensor, counts as one at the
/// beginning of its flag. Or an extra pulse at rest counts. A sound machine is then refused. A crank that was left just before its flag is
/// detected a turn later.
#[test]
fn a_first_pulse_where_the_crank_was_left_is_ignored() {
    let mut monitor = monitor(2, 3.0, 5.0, 15.0);
    let tolerance = monitor.tolerance(0).to_num::<f64>();
    let slow = 0.01 * tolerance;
    let places = [
        (0.9 * tolerance, 0.0, false),
        (0.9 * tolerance, slow, false),
        (-0.9 * tolerance, slow, false),
        (0.25, 0.0, false),
        (1.0 + 0.1 * tolerance, slow, true),
    ];
    for (place, commanded, counts) in places {
        let tick = TickPhase {
            start: Phase::from_turns(Turns::from_num(place)),
            turns: Turns::from_num(commanded),
        };
        let pulses = [Some(IndexPulse { cycle: 7 }); MAX_AXES];
        let found = detect(&mut monitor, &pulses, &[0; MAX_AXES], &[tick; MAX_AXES]);
        assert_eq!(found, None);
        assert_eq!(take_all(&mut monitor, &[tick; MAX_AXES]), []);
        assert_eq!(are_detected(&monitor), counts, "{place} turns");
    }
}

/// If this fails, the pulse of a crank that was left just before its flag is overdue a turn after the one that was ignored, where the error
/// of a reading exceeds half an electrical cycle and what one crank may be off. A sound machine is then refused.
#[test]
fn a_first_pulse_that_was_ignored_comes_again_in_time() {
    let mut settings = settings(3, 2.0, 5.0, 15.0);
    settings.drift.reading_error_deg = 2.5;
    for axis in &mut settings.axes {
        axis.cycle_steps = 32;
    }
    let flag_deg = 2.6;
    settings.axes[1].index_turns = Some(flag_deg / 360.0);
    let mut cranks = Cranks::new(configured(&settings), 0.0001);
    let traits = &cranks.monitor.axes[0].config;
    let flag = Turns::from_num(flag_deg / 360.0);
    let half = Turns::from_bits(traits.cycle.to_bits() / 2);
    assert!(half.max(traits.single_axis_limit) < flag && flag < traits.tolerance);
    cranks.flags[1] = flag_deg / 360.0;
    assert_eq!(cranks.turn(21_000, |_, _| 0.0), []);
    assert!(cranks.monitor.is_homed());
}

/// Homes two cranks, stops them after `turns`, and gives the second one a pulse in the first tick at rest. The filter confirmed the pulse
/// `cycle` cycles from the beginning of that tick; a pulse of the last tick before it has not been confirmed yet. Then the cranks turn on
/// for 1.5 turns, the second one ahead by `ahead`. Returns the findings, each with the phase at the end of its tick.
fn turn_on_after_a_pulse_at_rest(turns: f64, cycle: i32, ahead: f64) -> Vec<(f64, Finding)> {
    let mut cranks = Cranks::new(monitor(2, 3.0, 5.0, 15.0), 0.01).homed();
    let ticks = ((turns * 100.0).round() as i32 - cranks.tick).unsigned_abs();
    let unconfirmed =
        |i, t, pulse: Option<IndexPulse>| pulse.filter(|_| i != 1 || t < turns - 0.001);
    assert_eq!(cranks.turn_with(ticks, |_, _| 0.0, unconfirmed), []);
    let at_rest = [TickPhase::still(Phase::from_turns(Turns::wrapping_from_num(turns))); MAX_AXES];
    let mut pulses = [None; MAX_AXES];
    pulses[1] = Some(IndexPulse { cycle });
    let before = Turns::from_num(cranks.speed);
    let found = detect_after(
        &mut cranks.monitor,
        &pulses,
        &[0; MAX_AXES],
        &at_rest,
        before,
    );
    assert_eq!(found, None);
    assert_eq!(take_all(&mut cranks.monitor, &at_rest), []);
    cranks.before[1] += ahead;
    let found = cranks.turn(150, |i, _| if i == 1 { ahead } else { 0.0 });
    let phase = |tick| f64::from(tick + 1) * 0.01;
    found
        .into_iter()
        .map(|(tick, finding)| (phase(tick), finding))
        .collect()
}

/// If this fails, a crank that came to rest as it passed its flag, so that its pulse was confirmed at rest, counts as one whose pulse is
/// missing.
#[test]
fn a_pulse_that_is_confirmed_at_rest_counts() {
    assert_eq!(turn_on_after_a_pulse_at_rest(2.0, -5, 0.0), []);
}

/// If this fails, a crank that passed its flag at rest is reported as one whose pulse is missing. It gets its name most of a turn later.
#[test]
fn a_crank_that_moved_at_rest_gets_its_name_as_the_place_of_its_pulse_has_passed() {
    let found = turn_on_after_a_pulse_at_rest(1.9, 7, 0.1);
    let (phase, finding) = found.first().expect("it is beyond its limit");
    let fault = finding.fault;
    assert_eq!((fault.kind, fault.axis), (FaultKind::LostSteps, Some(1)));
    assert!((2.0..2.05).contains(phase), "at {phase}");
}

/// A crank that comes to rest at the end of its flag swings over it. If this fails, this counts as a pulse elsewhere, and a parked machine
/// reports a crank that runs away. At speed the pulse does count as one elsewhere. A turn later it does so too, as then a crank that
/// slipped by the length of its flag makes it.
#[test]
fn a_crank_that_rests_at_the_end_of_its_flag_says_nothing() {
    for (turns, later, is_reported) in [(1e-6, 0.0, false), (0.01, 0.0, true), (1e-6, 1.0, true)] {
        let mut settings = settings(2, 3.0, 5.0, 15.0);
        for axis in &mut settings.axes {
            axis.index_width_turns = 0.02;
        }
        let mut cranks = Cranks::new(configured(&settings), 0.01);
        cranks.turn(202, |_, _| 0.0);
        cranks.monitor.settle();
        let turn = (100.0 * later) as u32;
        cranks.turn_with(turn, |_, _| 0.0, |i, _, pulse| pulse.filter(|_| i != 1));
        let at_end = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(2.02 + later)),
            turns: Turns::from_num(turns),
        };
        let mut pulses = [None; MAX_AXES];
        pulses[1] = Some(IndexPulse { cycle: 0 });
        let mut found = Vec::new();
        for _ in 0..2 {
            found.extend(detect(
                &mut cranks.monitor,
                &pulses,
                &[0; MAX_AXES],
                &[at_end; MAX_AXES],
            ));
            found.extend(take_all(&mut cranks.monitor, &[at_end; MAX_AXES]));
        }
        let slips = found.iter().any(|finding| {
            finding.fault.axis == Some(1) && finding.fault.kind != FaultKind::IndexTimeout
        });
        assert_eq!(slips, is_reported, "{turns}, {later}: {found:?}");
    }
}

/// If this fails, a crank that has moved ahead is known later than the place of its next pulse shows it, or so early that a pulse in its
/// place can still come.
#[test]
fn a_pulse_out_of_place_is_decided_as_the_place_of_the_next_has_passed() {
    let filter_cycles = 3.0 * 2e-6 * f64::from(CLOCK_HZ);
    let speed = 0.000_131;
    for (encoder, tolerances) in [(false, 1.0), (true, 2.0)] {
        let mut settings = settings(3, 3.0, 5.0, 15.0);
        for axis in &mut settings.axes {
            axis.encoder = encoder;
        }
        let mut cranks = Cranks::new(configured(&settings), speed).homed();
        let sure = tolerances * cranks.monitor.tolerance(1).to_num::<f64>();
        let ahead = |i: usize, t: f64| if i == 1 && t > 1.5 { 0.05 } else { 0.0 };
        let found = cranks.turn_shafts((1.0 / speed) as u32, ahead);
        let (tick, finding) = found.first().expect("it is beyond its limit");
        assert_eq!(finding.fault.axis, Some(1));
        let (mut decided, cycle) = tick_of(2.0 + sure, speed);
        decided += i32::from(cycle > f64::from(TICK_CYCLES) - filter_cycles);
        // Two ticks evaluate an index. A count of an encoder is 2.4 ticks.
        let off = tick.abs_diff(decided);
        assert!(
            off <= 3,
            "encoder {encoder}: in {tick} instead of {decided}"
        );
    }
}

/// If this fails, a sensor that bounces at its flag ends homing with a place that no turn has confirmed.
#[test]
fn a_second_pulse_of_a_passage_confirms_nothing() {
    let mut cranks = Cranks::new(monitor(3, 3.0, 5.0, 15.0), 0.001);
    cranks.flags = [0.5; MAX_AXES];
    for axis in 0..3 {
        move_flag(&mut cranks.monitor, axis, 0.5);
    }
    let bounces = |_: usize, t: f64, pulse: Option<IndexPulse>| {
        let again = (0.5025..0.5035).contains(&t);
        pulse.or(again.then_some(IndexPulse { cycle: 100 }))
    };
    assert_eq!(cranks.turn_with(600, |_, _| 0.0, bounces), []);
    assert!(are_detected(&cranks.monitor) && !cranks.monitor.is_homed());
    assert_eq!(cranks.turn_with(1000, |_, _| 0.0, bounces), []);
    assert!(cranks.monitor.is_homed());
}

/// If this fails, homing takes noise for a flag; or it rejects the flag, or needs more turns than the noise takes.
#[test]
fn a_place_is_confirmed_by_a_turn_with_no_pulse_between() {
    for seed in 0..40_u32 {
        let place = 0.0303 + 0.94 * f64::from(seed) / 40.0; // between two ticks
        for (noisy_turns, until) in [(0, 2.1), (1, 2.1), (2, 3.1)] {
            // A crank at twice its speed could make both pulses.
            if noisy_turns == 2 && (0.31..0.53).contains(&place) {
                continue;
            }
            let mut cranks = Cranks::new(monitor(3, 3.0, 5.0, 15.0), 0.01);
            cranks.flags = [0.99; MAX_AXES];
            for axis in 0..3 {
                move_flag(&mut cranks.monitor, axis, 0.99);
            }
            let noise = move |i: usize, t: f64, pulse: Option<IndexPulse>| {
                let made = (t - place).floor() as i32;
                let comes = (t - place) - f64::from(made) < 0.0099;
                let is_noise = i == 1 && comes && (0..noisy_turns).contains(&made);
                pulse.or(is_noise.then_some(IndexPulse { cycle: 100 }))
            };
            let found = cranks.turn_with((until * 100.0) as u32 + 8, |_, _| 0.0, noise);
            let case = format!("{noisy_turns} turns with noise at {place}: {found:?}");
            assert!(cranks.monitor.is_homed(), "{case}");
            let off = cranks.monitor.phase_error()[1].to_num::<f64>();
            assert!(off.abs() < 1e-3, "{case}: {off}");
            let all_extra = |(_, found): &(i32, Finding)| {
                found.within_limits && found.fault.kind == FaultKind::IndexExtra
            };
            assert!(found.iter().all(all_extra), "{case}");
            assert_eq!(found.len(), noisy_turns as usize, "{case}");
        }
    }
}
