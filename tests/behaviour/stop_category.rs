//! State of the drives after a fault, by stop category of IEC 60204-1: they hold (2), are cut at rest (1), or are disabled at once (0).
//!
//! The machines are on the phased level, where a platform without drives falls.

use cophase_core::supervisor::{FaultKind, State};
use cophase_tests::scripted::{command, fault, input};
use cophase_tests::{bench_scene, built_in_scene};
use host_sim::checked::Checked;
use host_sim::sim::events::{Event, EventKind};
use host_sim::sim::{Moment, Observer, Outcome, simulate};

const STEPPERS: &str = "drive = \"stepper\"\npull_out = [[0, 12], [20, 9]]\ndamping_nms = 0.2\n";

const SERVOS: &str = "drive = \"servo\"\nencoder = true\nservo = { position_gain_per_s = 100, velocity_gain_nms = 1.0 }\n";

/// Time of the faults: at a steady speed of 11 rev/s.
const AT_S: f64 = 2.2;

/// The stop is over by this time.
const HELD_S: f64 = 4.0;

const LIMIT_MRAD: f64 = 3.0;

fn machine(axes: &str, happens: &str) -> Checked {
    bench_scene()
        .with(
            r#"
fidelity = "phased"
machine = { crank_radius_mm = 20, lambda = 0.3, load_kg = 10 }
limits = { acceleration_hz_per_s = 20, jerk_hz_per_s2 = 200 }
axes = { rotor_inertia_kgm2 = 5e-4, friction_nm = 0.02 }
"#,
        )
        .set("drift.tilt_limit_mrad", LIMIT_MRAD)
        .program([(12.0, 1.0, 10.0)])
        .with(&format!("[axes]\n{axes}"))
        .with(&(command(0.0, "start") + happens))
        .checked()
}

/// A crank that falls 7.2° behind: a stepper by an electrical cycle, a servo by a slip of its coupling.
pub(super) fn behind(axes: &str) -> String {
    if axes.starts_with(STEPPERS) {
        fault("lost-steps", AT_S, "axis = 1")
    } else {
        fault("slip", AT_S, "axis = 1\nrate_deg_per_s = 144\nfor_s = 0.05")
    }
}

/// The drives with index flags at other places. An index shows the fault, so the stop ends at other phases.
pub(super) fn each_phase(axes: &str) -> impl Iterator<Item = String> {
    (0..6).map(move |part: i32| format!("{axes}index_deg = {}\n", 60 * part - 150))
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Tick {
    t_s: f64,
    state: State,
    pub(super) drives: bool,
    speed: i64,
    tilt_mrad: f64,
}

#[derive(Debug)]
pub(super) struct Run {
    ticks: Vec<Tick>,
    outcome: Outcome,
    checked: Checked,
}

struct Eyes(Vec<Tick>);

impl Observer for Eyes {
    fn tick(&mut self, moment: &Moment<'_>) {
        self.0.push(Tick {
            t_s: moment.start_ns as f64 * 1e-9,
            state: moment.telemetry.state,
            drives: moment.drives_enabled,
            speed: moment.telemetry.motion.speed.to_bits(),
            tilt_mrad: moment.tilt_mrad().unwrap(),
        });
    }
}

pub(super) fn run(axes: &str, happens: &str) -> Run {
    let checked = machine(axes, happens);
    let mut eyes = Eyes(Vec::new());
    let outcome = simulate(&checked, &mut eyes, |_, _| {}).expect("a checked scene runs");
    Run {
        ticks: eyes.0,
        outcome,
        checked,
    }
}

impl Run {
    #[track_caller]
    pub(super) fn last(&self) -> Tick {
        *self.ticks.last().expect("ticks")
    }

    /// The first tick in the fault state. Every tick after it is in that state.
    #[track_caller]
    pub(super) fn stopped(&self) -> usize {
        let place = |tick: &Tick| tick.state == State::Fault;
        self.ticks.iter().position(place).expect("it is stopped")
    }

    /// Latched fault, with its most exact name.
    #[track_caller]
    pub(super) fn kind(&self) -> FaultKind {
        let events = self.outcome.record.events.iter();
        let mut latched = events.filter_map(|event| match event.what {
            EventKind::Fault { fault, .. } => Some(fault.kind),
            _ => None,
        });
        latched.next_back().expect("a fault")
    }

    /// Ticks between the fault and the end of its stop.
    fn stopping(&self) -> &[Tick] {
        let from = self.ticks.iter().position(|tick| tick.state == State::Stop);
        from.map_or(&[], |from| &self.ticks[from..self.stopped()])
    }

    fn worst_mrad(ticks: &[Tick]) -> f64 {
        ticks.iter().map(|tick| tick.tilt_mrad).fold(0.0, f64::max)
    }

    /// Largest tilt after the stop.
    pub(super) fn after_mrad(&self) -> f64 {
        Self::worst_mrad(&self.ticks[self.stopped()..])
    }

    fn reports(&self, kind: FaultKind) -> bool {
        let mut events = self.outcome.record.events.iter();
        events.any(|event| matches!(event.what, EventKind::Reported(fault) if fault.kind == kind))
    }

    fn says(&self, words: &str) -> bool {
        cophase_files::report::summary(&self.checked, &self.outcome, None, 1.0).contains(words)
    }
}

pub(super) const DRIVES: [&str; 2] = [STEPPERS, SERVOS];

/// If this fails, sound drives are switched off, and the platform falls, many times its limit of tilt.
#[test]
fn category_2_holds_and_the_platform_tilts_no_further() {
    for axes in DRIVES {
        for axes in each_phase(axes) {
            let held = run(&axes, &(behind(&axes) + &command(HELD_S, "stop")));
            let last = held.last();
            assert_eq!((last.state, last.drives), (State::Fault, true), "{axes}");
            assert!(held.stopping().len() > 100, "the stop is coordinated");
            let at_stop_mrad = held.ticks[held.stopped()].tilt_mrad;
            let after_mrad = held.after_mrad();
            println!(
                "{axes}{:?}: {:.3} mrad while it stops, {at_stop_mrad:.3} as the stop ends, {after_mrad:.3} after it",
                held.kind(),
                Run::worst_mrad(held.stopping())
            );
            assert!(after_mrad <= at_stop_mrad * 1.02 + 0.02, "{axes}");
            assert!(
                last.t_s > HELD_S,
                "it holds as long as nothing else happens"
            );
            assert!(held.says("the drives hold them"));
            let figures = &held.outcome.record.figures;
            assert_eq!(figures.tilt_at_stop_mrad, Some(at_stop_mrad));
            assert_eq!(figures.tilt_worst_held_mrad, Some(after_mrad));
        }
    }
}

/// If this fails, a fault that should cut the drives leaves them on, and a drive with an alarm is trusted to hold.
#[test]
fn category_1_cuts_the_drives_once_all_stand() {
    for axes in DRIVES {
        let cut = run(axes, &fault("drive-alarm", AT_S, "axis = 1"));
        assert_eq!(cut.kind(), FaultKind::DriveAlarm);
        let last = cut.last();
        assert_eq!((last.state, last.drives), (State::Fault, false), "{axes}");
        let stopping = cut.stopping();
        assert!(stopping.iter().all(|tick| tick.drives || tick.speed == 0));
        assert!(stopping.iter().filter(|tick| tick.drives).count() > 100);
        assert!(cut.says("then the drives were switched off"));
    }
}

/// If this fails, the drives stay on during a stop, and the axis that runs away turns against the others.
#[test]
fn category_0_disables_the_drives_in_the_same_tick() {
    for axes in DRIVES {
        let lost = run(axes, &fault("enable-loss", AT_S, ""));
        assert_eq!(lost.kind(), FaultKind::EnableLost);
        assert!(lost.stopping().is_empty(), "nothing is stopped first");
        for tick in &lost.ticks {
            let on = tick.t_s > 0.001 && tick.t_s < AT_S - 1e-9;
            assert!(!on || tick.drives, "{tick:?}");
            assert!(tick.t_s < AT_S - 1e-9 || !tick.drives, "{tick:?}");
        }
    }
}

/// If this fails, these events do not end a hold, and drives stay on although an operator, or their own alarm, requires them off.
#[test]
fn hold_after_a_fault_ends_only_by_enable_alarms_and_resets() {
    let axes = STEPPERS;
    let reset = command(HELD_S, "reset");
    let started = command(HELD_S, "start") + &command(HELD_S + 0.1, "stop");
    for (happens, state, holds, reported) in [
        (started, State::Fault, true, None),
        (
            input(HELD_S, "stop", true),
            State::Fault,
            true,
            Some(FaultKind::StopInput),
        ),
        (reset, State::Idle, false, None),
        (
            input(HELD_S, "enable", false) + &input(HELD_S + 0.1, "enable", true),
            State::Fault,
            false,
            Some(FaultKind::EnableLost),
        ),
        (
            fault("drive-alarm", HELD_S, "axis = 0\nfor_s = 0.1"),
            State::Fault,
            false,
            Some(FaultKind::DriveAlarm),
        ),
    ] {
        let run = run(axes, &(behind(axes) + &happens));
        let last = run.last();
        assert_eq!((last.state, last.drives), (state, holds), "{happens}");
        assert_eq!(run.kind(), FaultKind::LostSteps, "the first fault stays");
        // The drives are off in that tick, and on until then.
        for tick in &run.ticks[run.stopped()..] {
            let before = tick.t_s < HELD_S - 1e-9;
            assert_eq!(tick.drives, before || holds, "{happens}: {tick:?}");
        }
        if let Some(kind) = reported {
            assert!(run.reports(kind), "{happens}");
        }
    }
}

/// If this fails, a crank that leaves its command while it is held keeps its drive, and tilts the platform against the others.
#[test]
fn moving_held_axis_is_disabled_as_a_runaway() {
    let runaway = fault("runaway", HELD_S, "axis = 2\nspeed_hz = 2");
    let parked = command(AT_S, "stop");
    for (before, latched) in [
        (behind(SERVOS), FaultKind::Slip),
        (parked, FaultKind::Runaway),
    ] {
        let run = run(SERVOS, &(before + &runaway));
        let last = run.last();
        assert_eq!((last.state, last.drives), (State::Fault, false));
        let first = run
            .ticks
            .iter()
            .position(|tick| tick.t_s > 1.0 && !tick.drives);
        let off = run.ticks[first.expect("its drive is off")];
        println!(
            "off {:.4} s after it begins, at {:.3} mrad",
            off.t_s - HELD_S,
            off.tilt_mrad
        );
        assert!((0.0..0.05).contains(&(off.t_s - HELD_S)), "{off:?}");
        assert!(
            run.kind() == latched || run.kind() == FaultKind::Tilt,
            "{:?}",
            run.kind()
        );
        assert!(run.kind() == FaultKind::Runaway || run.reports(FaultKind::Runaway));
    }
}

/// If this fails, the pulses of a parked axis without an encoder do not count, and its drive can turn it for hours.
#[test]
fn index_pulses_disable_a_parked_runaway_within_two_turns() {
    let commands = [(0.0, "start"), (3.0, "stop"), (12.0, "reset")];
    let happens: String = commands.map(|(at_s, what)| command(at_s, what)).concat();
    let runaway = fault("runaway", 6.0, "axis = 1\nspeed_hz = 2");
    let checked = built_in_scene("default")
        .set("fidelity", "kinematic")
        .with(&(happens + &runaway))
        .checked();
    let outcome = simulate(&checked, &mut (), |_, _| {}).expect("a machine");
    let reported = |event: &Event| matches!(&event.what, EventKind::Fault { fault, .. } if fault.kind == FaultKind::Runaway);
    assert!(outcome.record.events.iter().any(reported));
    let axis = &outcome.record.axes[1];
    let travel = axis.actual_turns.unwrap() - axis.command_turns;
    assert!((1.0..2.01).contains(&travel), "{travel} turns");
}

/// If this fails, a jammed crank is held, and its drive presses it with its full torque.
#[test]
fn drives_are_disabled_after_a_crank_jams() {
    let run = run(SERVOS, &fault("stuck", AT_S, "axis = 1"));
    assert_eq!(run.kind(), FaultKind::Stuck);
    assert!(!run.last().drives);
}

/// If this fails, the first pulse is not enough, and an axis without an encoder makes another turn against those that are held. A pulse
/// in one tick is read in the next one, and the tick after that plays the output.
#[test]
fn index_pulses_disable_moving_held_axes_within_a_turn() {
    let speed_hz = 2.0;
    let bound_turns = 1.0 + 4.0 / 2000.0 * speed_hz;
    // The axis that caused the stop, and another one.
    for axis in [1, 2] {
        let runaway = format!("axis = {axis}\nspeed_hz = {speed_hz}");
        let happens = behind(STEPPERS) + &fault("runaway", HELD_S, &runaway);
        let run = run(STEPPERS, &happens);
        let off = run.ticks.iter().find(|tick| tick.t_s > 1.0 && !tick.drives);
        let after_turns = (off.expect("its drive is off").t_s - HELD_S) * speed_hz;
        println!("axis {axis}: off after {after_turns:.3} turns");
        assert!((0.0..bound_turns).contains(&after_turns), "{after_turns}");
        assert!(run.reports(FaultKind::Runaway));
    }
}
