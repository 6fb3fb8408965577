//! Homing on whole machines: cranks left at different phases, phase errors between cranks, and swapped lines.
//!
//! Unit tests: `firmware/core/src/supervisor/tests.rs`, `firmware/core/src/monitor/tests/`.

use cophase_core::supervisor::{FaultKind, State};
use cophase_core::units::ONE_TURN;
use cophase_tests::{SceneBuilder, bench_scene};
use host_sim::sim::{Moment, Observer, Outcome, simulate};

const HOMING_SPEED_HZ: f64 = 2.0;

/// A machine of `count` cranks that stand at `starts_deg` at power-up.
pub(super) fn machine(count: usize, drive: &str, starts_deg: &[f64], more: &str) -> SceneBuilder {
    let machine = bench_scene()
        .with(
            r#"
fidelity = "kinematic"
machine = { mount_radius_mm = 200 }
control = { settle_s = 0.05 }
limits = { acceleration_hz_per_s = 60, jerk_hz_per_s2 = 2000 }
drift = { tilt_limit_mrad = 4.5, warp_limit_deg = 5 }
axes = { index_deg = 40, trim_rate_deg_per_s = 20 }
noise = { seed = 3, index_deg = 0.05, index_us = 1 }
"#,
        )
        .set("limits.homing_speed_hz", HOMING_SPEED_HZ)
        .set("axes.count", count as i64)
        .with(&format!("[axes]\n{drive}"))
        .program([(8.0, 0.5, 0.2)])
        .with(more);
    standing(machine, starts_deg)
}

/// The machine with cranks that stand there at power-up.
fn standing(machine: SceneBuilder, starts_deg: &[f64]) -> SceneBuilder {
    let each = starts_deg.iter().enumerate();
    each.fold(machine, |machine, (i, deg)| {
        machine.axis(i, "start_deg", *deg)
    })
}

pub(super) const CORRECTED: &str = "[correction]\ngain = 0.5\n";

pub(super) const STEPPERS: &str = "drive = \"stepper\"\nsteps_per_turn = 3200";
const SERVOS: &str = "drive = \"servo\"\nsteps_per_turn = 8192\nencoder = true";

/// Observations of a run: the spread of the cranks as it begins to run, and the master's turns until then. The positions of the cranks
/// at the end. The distance of the corrections' sum from zero, at most and at the end, and the largest correction.
#[derive(Default)]
pub(super) struct Recorded {
    spread_deg: Option<f64>,
    turns: f64,
    end_turns: Vec<f64>,
    worst_sum: i64,
    last_sum: i64,
    pub(super) max_deg: f64,
    /// Time and master's turns at the end of each tick, and the number of the first tick that is played with a fault.
    ticks: Vec<(f64, f64)>,
    reported: Option<usize>,
}

impl Observer for Recorded {
    fn tick(&mut self, moment: &Moment<'_>) {
        let correction = &moment.telemetry.correction;
        let sum: i64 = correction.iter().map(|turns| turns.to_bits()).sum();
        self.worst_sum = self.worst_sum.max(sum.abs());
        self.last_sum = sum.abs();
        for turns in correction {
            self.max_deg = self.max_deg.max(turns.to_num::<f64>().abs() * 360.0);
        }
        if moment.telemetry.state == State::Run && self.spread_deg.is_none() {
            let max = moment.errors().fold(f64::NEG_INFINITY, f64::max);
            let min = moment.errors().fold(f64::INFINITY, f64::min);
            self.spread_deg = Some((max - min) * 360.0);
            self.turns = moment.master_turns;
        }
        self.end_turns = moment.actual_turns.to_vec();
        if moment.telemetry.fault.is_some() && self.reported.is_none() {
            self.reported = Some(self.ticks.len());
        }
        self.ticks
            .push((moment.end_ns as f64 * 1e-9, moment.master_turns));
    }
}

pub(super) fn run(machine: &SceneBuilder) -> (Recorded, Outcome) {
    let checked = machine.checked();
    let mut recorded = Recorded::default();
    let outcome = simulate(&checked, &mut recorded, |_, _| {}).unwrap();
    // One axis after the other moves by the steps of its slot, two at these rates. At the end all targets are reached.
    let step = ONE_TURN / 3200;
    let count = recorded.end_turns.len() as i64;
    assert!(recorded.worst_sum <= 2 * step * count, "sum of corrections");
    assert!(recorded.last_sum <= step / 2, "sum of corrections at rest");
    (recorded, outcome)
}

pub(super) fn starts(count: usize, of: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..count).map(of).collect()
}

/// If this fails, cranks that stand a little apart run so, or are moved further apart, or homing takes too long.
#[test]
fn phase_differences_are_trimmed_before_the_run() {
    for count in 2..=6 {
        for drive in [STEPPERS, SERVOS] {
            let apart = starts(count, |i| [1.5, -1.0, 0.4, -0.7, 1.1, -1.3][i]);
            let machine = machine(count, drive, &apart, CORRECTED);
            let (recorded, outcome) = run(&machine);
            assert_eq!(
                (outcome.state, outcome.fault),
                (State::Parked, None),
                "{count}"
            );
            let spread = recorded.spread_deg.expect("it runs");
            // The error of two readings, by 0.05° of noise each and a step.
            assert!(spread < 0.5, "{count} cranks {spread}° apart");
            // One turn finds the cranks, one confirms them and one checks them, each with its margin. The trims need additional time.
            let max = 3.0 * 1.1 + HOMING_SPEED_HZ * (2.0 * 1.5 / 20.0 + 0.2);
            assert!(recorded.turns < max, "{count}: {} turns", recorded.turns);
            assert!(recorded.max_deg < 3.0);
            // The report states it too.
            let axes = &outcome.record.axes;
            assert!(
                axes.iter().any(|axis| axis.correction_deg.abs() > 0.5),
                "{axes:?}"
            );
            let mut peaks_deg = axes.iter().map(|axis| axis.phase_error_peak_deg);
            assert!(peaks_deg.all(|deg| (0.1..3.5).contains(&deg)));
        }
    }
}

/// If this fails, a machine that was switched off where it was parked does not start, or parks elsewhere from then on.
#[test]
fn cranks_park_at_the_parking_phase_from_any_start() {
    for drive in [STEPPERS, SERVOS] {
        for left_deg in [-179.0, -90.0, 20.0, 135.0, 180.0] {
            let machine = machine(3, drive, &[left_deg; 3], CORRECTED);
            let (recorded, outcome) = run(&machine);
            assert_eq!(
                (outcome.state, outcome.fault),
                (State::Parked, None),
                "{left_deg}"
            );
            for turns in &recorded.end_turns {
                let off_deg = (turns - 0.5 - (turns - 0.5).round()) * 360.0;
                assert!(
                    off_deg.abs() < 0.5,
                    "left at {left_deg}°, parked {off_deg}° off"
                );
            }
        }
    }
}

/// Pulses without a flag, on the index lines of some axes.
fn extra_pulses(axes: std::ops::Range<usize>, at_s: f64, count: u32) -> String {
    axes.map(|axis| {
        format!(
            "[[fault]]\nat_s = {at_s}\nkind = \"index-extra\"\naxis = {axis}\ncount = {count}\n"
        )
    })
    .collect()
}

/// If this fails, noise on the index lines in homing ends it at a wrong place: the program runs and parks there, or a crank is moved out of
/// phase. Where a crank at twice its speed could make the pulse, a machine without encoders may stop instead, and names it.
#[test]
fn noise_in_homing_does_not_end_it_at_a_wrong_place() {
    for drive in [STEPPERS, SERVOS] {
        let mut parked = 0;
        let mut all = 0;
        for (axes, apart) in [(0..3, 0.0), (1..2, 0.0), (0..3, 1.0), (1..2, 1.0)] {
            for tenth in 1..=12 {
                let at_s = 0.013 + 0.1 * f64::from(tenth);
                let starts = [0.0, apart, -apart];
                let noise = extra_pulses(axes.clone(), at_s, 1);
                let more = format!("{CORRECTED}{noise}");
                let (recorded, outcome) = run(&machine(3, drive, &starts, &more));
                let case = format!("{drive}, {axes:?}, {apart}, {at_s} s: {:?}", outcome.fault);
                all += 1;
                if let Some(fault) = outcome.fault {
                    assert_eq!(fault.kind, FaultKind::IndexExtra, "{case}");
                    assert!(drive == STEPPERS, "{case}");
                    continue;
                }
                assert_eq!(outcome.state, State::Parked, "{case}");
                parked += 1;
                for turns in &recorded.end_turns {
                    let off_deg = (turns - 0.5 - (turns - 0.5).round()) * 360.0;
                    assert!(off_deg.abs() < 0.5, "{case}: parked {off_deg}° off");
                }
            }
        }
        assert!(4 * parked > 3 * all, "{drive}: {parked} of {all}");
    }
}

/// Distance of crank 1 from the others until a fault is reported, at most, turns.
#[derive(Default)]
struct Farthest(f64);

impl Observer for Farthest {
    fn tick(&mut self, moment: &Moment<'_>) {
        if moment.telemetry.fault.is_none() {
            let errors: Vec<f64> = moment.errors().collect();
            self.0 = self.0.max((errors[1] - errors[0]).abs());
        }
    }
}

/// If this fails, each pulse of a crank that slips slowly is taken for noise, so that homing never compares it with the limits. A crank 1
/// alone exceeds 4.5 mrad where it is 7.5° off. Two turns and that angle later it has to be stopped, and some ticks.
#[test]
fn crank_that_slips_in_homing_is_stopped_within_two_turns() {
    let (limit_deg, ticks_s) = (7.5, 0.01);
    for drive in [STEPPERS, &format!("{STEPPERS}\nencoder = true"), SERVOS] {
        for rate in [70.0_f64, 25.0, 12.0, 8.0, 5.0, 3.0]
            .into_iter()
            .flat_map(|rate| [rate, -rate])
        {
            for tenth in 1..=8 {
                let at_s = 0.013 + 0.1 * f64::from(tenth);
                let slip = format!(
                    "{CORRECTED}[[fault]]\nat_s = {at_s}\nkind = \"slip\"\naxis = 1\nrate_deg_per_s = {rate}\nfor_s = 3\n"
                );
                let checked = machine(3, drive, &[0.0; 3], &slip).checked();
                let mut farthest = Farthest::default();
                let outcome = simulate(&checked, &mut farthest, |_, _| {}).unwrap();
                let case = format!("{drive}: {rate}°/s at {at_s} s: {:?}", outcome.fault);
                // A slow one may be corrected.
                assert!(outcome.fault.is_some() || rate.abs() < 20.0, "{case}");
                let may_stay_s = (2.0 + limit_deg / 360.0) / HOMING_SPEED_HZ + ticks_s;
                let max_deg = limit_deg + rate.abs() * may_stay_s;
                let off_deg = farthest.0 * 360.0;
                assert!(off_deg < max_deg, "{case}: {off_deg}° of {max_deg}°");
            }
        }
    }
}

/// If this fails, homing takes three pulses at one place for a flag, although the flag's own pulses come between them.
#[test]
fn pulses_at_one_place_for_three_turns_are_no_flag() {
    for drive in [STEPPERS, SERVOS] {
        // An eighth of a turn before the flag passes.
        let noise = extra_pulses(1..2, 0.2, 3);
        let more = format!("{CORRECTED}{noise}");
        let (recorded, outcome) = run(&machine(3, drive, &[0.0; 3], &more));
        assert_eq!((outcome.state, outcome.fault), (State::Parked, None));
        assert!(recorded.max_deg < 0.5, "{drive}: {}", recorded.max_deg);
    }
}

/// If this fails, a machine runs with two magnets on a crank, and stops at speed.
#[test]
fn second_magnet_ends_homing_and_is_named() {
    for drive in [STEPPERS, SERVOS] {
        for tenth in 1..=6 {
            for axes in [0..3, 1..2] {
                let magnets = extra_pulses(axes.clone(), 0.013 + 0.1 * f64::from(tenth), 5000);
                let (recorded, outcome) = run(&machine(3, drive, &[0.0; 3], &magnets));
                let fault = outcome.fault.expect("it is reported");
                assert_eq!(
                    fault.kind,
                    FaultKind::IndexExtra,
                    "{drive}, {tenth}: {fault:?}"
                );
                assert!(
                    fault.axis.is_some_and(|axis| axes.contains(&axis)),
                    "{fault:?}"
                );
                assert!(recorded.spread_deg.is_none(), "{drive}, {tenth}: it ran");
                assert!(
                    recorded.end_turns.iter().all(|turns| *turns < 6.0),
                    "it homed for too long"
                );
            }
        }
    }
}

/// If this fails, motors force a tilted platform straight, or a crank that is far out is driven along with the others.
#[test]
fn homing_range_exceeded_is_refused_by_axis() {
    for count in 2..=6 {
        let out = count - 1;
        let apart = starts(count, |i| if i == out { 25.0 } else { 0.0 });
        let machine = machine(count, STEPPERS, &apart, CORRECTED);
        let (recorded, outcome) = run(&machine);
        let fault = outcome.fault.expect("it is refused");
        assert_eq!(fault.kind, FaultKind::HomingRangeExceeded, "{count}");
        // With two cranks it is undecided which one is out.
        assert!(count == 2 || fault.axis == Some(out), "{count}: {fault:?}");
        assert_eq!(outcome.state, State::Fault);
        assert!(recorded.spread_deg.is_none(), "it ran");
        assert!(recorded.max_deg < 1e-9, "it was moved");
    }
}

/// If this fails, swapped lines are detected only by a wrong correction at speed, or correct lines are refused.
#[test]
fn swapped_wiring_is_refused_and_correct_wiring_is_accepted() {
    const PROVES: &str = "[correction]\ngain =  0.5\nprove_wiring = true\n";
    for count in 2..=6 {
        for drive in [STEPPERS, SERVOS] {
            let apart = starts(count, |i| [0.3, -0.2, 0.4, -0.3, 0.2, -0.4][i]);
            let (_, right) = run(&machine(count, drive, &apart, PROVES));
            assert_eq!((right.state, right.fault), (State::Parked, None), "{count}");
            for (a, b) in (0..count).flat_map(|b| (0..b).map(move |a| (a, b))) {
                for lines in ["sensors", "drive"] {
                    let swapped = format!(
                        "{PROVES}[[fault]]\nat_s = 0\nkind = \"swapped-wiring\"\naxis = {a}\nwith = {b}\nlines = \"{lines}\"\n"
                    );
                    let (_, outcome) = run(&machine(count, drive, &apart, &swapped));
                    let Some(fault) = outcome.fault else {
                        panic!("{count} {drive}: {a}, {b}, {lines}: not refused");
                    };
                    assert_eq!(
                        fault.kind,
                        FaultKind::SwappedWiring,
                        "{count}: {a}, {b}, {lines}"
                    );
                    assert!(
                        [Some(a), Some(b)].contains(&fault.axis),
                        "{fault:?}, not {a} or {b}"
                    );
                }
            }
        }
    }
}

/// If this fails, the noise of encoders ends homing of a machine whose cranks are within their limits. The proof of the wiring moves
/// them near a limit here.
#[test]
fn noise_of_encoders_near_a_limit_does_not_end_homing() {
    for seed in 0..10 {
        let machine = machine(
            4,
            &format!("{STEPPERS}\nencoder = true"),
            &[0.04, -0.472, -0.422, -0.844],
            "correction.prove_wiring = true",
        )
        .set("drift.tilt_limit_mrad", 1.85)
        .set("noise.seed", seed)
        .set("noise.encoder_counts", 1);
        let (_, outcome) = run(&machine);
        assert_eq!(
            (outcome.state, outcome.fault),
            (State::Parked, None),
            "noise of seed {seed}"
        );
    }
}

/// If this fails, a crank that loses steps in homing is corrected by its error before the loss, is checked for three more turns, or is
/// driven up to speed. The steps are lost in every stage of homing, from the first pulse to the last check.
#[test]
fn steps_lost_in_homing_are_reported_within_a_turn() {
    const WATCHED: &str = "drive = \"stepper\"\nsteps_per_turn = 3200\nencoder = true";
    let apart = [0.9, 1.1, -0.8, 0.4];
    for drive in [STEPPERS, WATCHED] {
        for prove in [false, true] {
            let correction = format!("[correction]\ngain =  0.5\nprove_wiring = {prove}\n");
            let (homed, _) = run(&machine(4, drive, &apart, &correction));
            let homing_turns = homed.turns;
            let until = homed.ticks.iter().find(|tick| tick.1 >= homing_turns);
            let (until_s, _) = *until.expect("it runs");
            // All flags have been detected, at 40°.
            for part in [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9] {
                let at_s = 0.25 + part * (until_s - 0.25);
                let lost = format!(
                    "{correction}[[fault]]\nat_s = {at_s}\nkind = \"lost-steps\"\naxis = 1\ncycles = 2\n"
                );
                let (recorded, outcome) = run(&machine(4, drive, &apart, &lost));
                let fault = outcome.fault.expect("it is reported");
                let reported = recorded.reported.expect("it is reported");
                let was = recorded.ticks.iter().position(|tick| tick.0 > at_s);
                let was = recorded.ticks[was.expect("it was on its way")].1;
                // The output that is played in a tick was computed from the input of two ticks before.
                let turns = recorded.ticks[reported - 3].1 - was;
                assert!(
                    turns <= 1.0,
                    "{drive}, {prove}: lost at {at_s} s, reported {turns} turns later"
                );
                // With an index alone, a machine at homing speed may stand before the crank is detected again.
                let is_named = fault.kind == FaultKind::LostSteps
                    || drive == STEPPERS && fault.kind == FaultKind::IndexTimeout;
                assert!(
                    is_named && fault.axis == Some(1),
                    "{drive}, {prove}, at {at_s} s: {fault:?}"
                );
            }
        }
    }
}

/// Servos with an integral, on rods that bend. The drives' integrals wind up against the rods. Each crank swings where its rods let go,
/// more in every turn. More than four cranks bend the rods more, so they stand less far apart.
fn integral(count: usize, seed: u32, more: &str) -> SceneBuilder {
    let machine = bench_scene()
        .with(
            r#"
fidelity = "phased"
machine = { crank_radius_mm = 5, load_kg = 6, rod_n_per_um = 50, mount_radius_mm = 200 }
limits = { speed_hz = 62, jerk_hz_per_s2 = 400 }
drift = { tilt_limit_mrad = 5 }
noise = { index_deg = 0.05, index_us = 1, load_nm = 0.1, encoder_counts = 1 }
correction = { gain = 0.25, couple = true }
[axes]
drive = "servo"
encoder = true
steps_per_turn = 32768
rotor_inertia_kgm2 = 0.001
servo = { position_gain_per_s = 120, velocity_gain_nms = 1.0, integral_s = 0.05 }
"#,
        )
        .set("axes.count", count as i64)
        .set("noise.seed", seed)
        .program([(1.0, 0.5, 0.2)])
        .with(more);
    let scale = if count == 4 { 1.0 } else { 0.4 };
    let starts_deg = starts(count, |i| scale * [0.0, 1.5, 0.0, -1.0, 0.5, -0.5][i]);
    (0..count).fold(standing(machine, &starts_deg), |machine, i| {
        machine
            .axis(i, "friction_nm", [0.2, 0.4, 0.2, 0.1, 0.3, 0.2][i])
            .axis(i, "reversed", i % 2 == 1)
    })
}

/// If this fails, the loop compares errors while cranks swing and refuses a machine with correct wiring. Or it does not compare them
/// and runs a machine with wrong wiring.
#[test]
fn servos_with_an_integral_are_homed_on_rods_that_bend() {
    for count in 4..=6 {
        for seed in 1..=3 {
            let (_, right) = run(&integral(count, seed, ""));
            assert_eq!(
                (right.state, right.fault),
                (State::Parked, None),
                "{count} cranks, seed {seed}"
            );
        }
        for lines in ["sensors", "drive"] {
            let swapped = format!(
                "[[fault]]\nat_s = 0\nkind = \"swapped-wiring\"\naxis = 1\nwith = 3\nlines = \"{lines}\"\n"
            );
            let (_, outcome) = run(&integral(count, 1, &swapped));
            let fault = outcome.fault.expect("it is refused");
            assert_eq!(
                fault.kind,
                FaultKind::SwappedWiring,
                "{count}: {lines}, {fault:?}"
            );
        }
    }
}

/// If this fails, soft servos that bent rods pull together are refused. Once they are levelled, the rods let go, and each crank is
/// elsewhere than its command alone would place it.
#[test]
fn soft_servos_are_levelled_twice() {
    let soft = |seed: u32, more: &str| {
        let machine = bench_scene()
            .with(
                r#"
fidelity = "phased"
machine = { load_kg = 7.756, rod_n_per_um = 0.693, mount_radius_mm = 200 }
control = { tick_hz = 2000 }
limits = { speed_hz = 60, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 600, homing_speed_hz = 2.39 }
drift = { tilt_limit_mrad = 5.917, warp_limit_deg = 3.345, reading_error_deg = 0.25 }
noise = { index_deg = 0.05, index_us = 1, load_nm = 0.5218, encoder_counts = 1 }
correction = { gain = 0.5, prove_wiring = true }
[axes]
count = 5
drive = "servo"
encoder = true
steps_per_turn = 16384
rotor_inertia_kgm2 = 0.0008
friction_nm = 0.2
servo = { position_gain_per_s = 125, velocity_gain_nms = 0.482423 }
"#,
            )
            .set("noise.seed", seed)
            .program([(1.0, 0.5, 0.2)])
            .with(more);
        standing(machine, &[1.943, 0.178, -1.689, 0.701, -1.717])
    };
    for seed in 1..=4 {
        let (recorded, right) = run(&soft(seed, ""));
        assert_eq!(
            (right.state, right.fault),
            (State::Parked, None),
            "seed {seed}"
        );
        assert!(recorded.spread_deg.expect("it runs") < 1.0, "seed {seed}");
    }
    let swapped =
        "[[fault]]\nat_s = 0\nkind = \"swapped-wiring\"\naxis = 0\nwith = 2\nlines = \"drive\"\n";
    let (_, outcome) = run(&soft(1, swapped));
    let fault = outcome.fault.expect("it is refused");
    assert_eq!(fault.kind, FaultKind::SwappedWiring);
}

/// If this fails, a flag that is shorter than a step makes a pulse without a duration, and a sound machine is stopped for a missing one.
#[test]
fn flags_shorter_than_a_step_are_detected() {
    for (steps, width_deg, index_deg) in [(400, 0.5, 8.3), (200, 1.0, 97.7), (3200, 0.05, 8.3)] {
        let drive = format!(
            "steps_per_turn = {steps}\nindex_width_deg = {width_deg}\nindex_deg = {index_deg}"
        );
        let machine = machine(3, &drive, &[0.0; 3], "").set("drift.tilt_limit_mrad", 20);
        let (_, outcome) = run(&machine);
        let case = format!("{steps} steps, {width_deg}°");
        assert_eq!(
            (outcome.state, outcome.fault),
            (State::Parked, None),
            "{case}"
        );
    }
}
