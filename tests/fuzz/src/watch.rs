//! Conditions that must hold after every tick, for any feedback.

use cophase_core::settings::{DriveKind, Settings};
use cophase_core::signals::{Feedback, Output};
use cophase_core::supervisor::{Command, Fault, State};
use cophase_core::units::{MAX_AXES, ONE_TURN, Phase, Turns};

/// Progress of a case, with which a test checks that cases run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reached {
    /// Ticks that were played.
    pub ticks: u32,
    /// Ticks in which the program was played.
    pub running: u32,
    /// Faults that latched.
    pub faults: u32,
    /// Reported events, faults or not: a bit for each kind, at its number.
    pub kinds: u32,
}

/// The limits in units of 2⁻⁴⁸ turn and one tick, and the state of the previous tick.
pub struct Watch {
    max_speed: f64,
    /// Usual limits, and those in a fault's stop.
    max_acceleration: [f64; 2],
    max_jerk: [f64; 2],
    max_offset: Vec<i64>,
    /// Greatest phase offset of an axis in a slot, and one step.
    max_slot: Vec<i64>,
    /// Axes that turn once with the master: their phases are those of the master, except for their
    /// offsets.
    plain: Vec<Option<Turns>>,
    stepper: Vec<bool>,
    /// True if phase errors are corrected.
    corrects: bool,
    tick_cycles: u32,
    phase: Phase,
    speed: i64,
    acceleration: i64,
    state: State,
    fault: Option<Fault>,
    has_drives_on: bool,
    has_brake: bool,
    /// An immediate stop was commanded since the machine rested.
    stops_now: bool,
    reached: Reached,
}

impl Watch {
    pub fn new(settings: &Settings) -> Self {
        let (hz, turn) = (f64::from(settings.tick_hz), ONE_TURN as f64);
        let limits = &settings.limits;
        let accelerations = [
            limits.acceleration_hz_per_s,
            limits.stop_acceleration_hz_per_s,
        ];
        let jerks = [limits.jerk_hz_per_s2, limits.stop_jerk_hz_per_s2];
        let axes = &settings.axes;
        Self {
            max_speed: limits.speed_hz / hz * turn,
            max_acceleration: accelerations.map(|a| a / (hz * hz) * turn),
            max_jerk: jerks.map(|j| j / (hz * hz * hz) * turn),
            max_offset: axes
                .iter()
                .map(|axis| (axis.trim_limit_turns * turn) as i64)
                .collect(),
            max_slot: axes
                .iter()
                .map(|axis| {
                    let tick = axis.trim_rate_hz * axes.len() as f64 / hz;
                    let step = axis.steps_per_crank_turn().turns_of(1.0);
                    ((5.0 * tick.max(step) + step) * turn) as i64
                })
                .collect(),
            plain: axes
                .iter()
                .map(|axis| {
                    let once = axis.follower.constant_ratio() == Some(1.0);
                    once.then(|| Turns::saturating_from_num(axis.offset_turns))
                })
                .collect(),
            stepper: axes
                .iter()
                .map(|axis| axis.drive == DriveKind::Stepper)
                .collect(),
            corrects: settings.correction.gain > 0.0,
            tick_cycles: settings.tick_cycles(),
            phase: Phase::ZERO,
            speed: 0,
            acceleration: 0,
            state: State::Idle,
            fault: None,
            has_drives_on: false,
            has_brake: settings.has_brake,
            stops_now: false,
            reached: Reached::default(),
        }
    }

    pub const fn reached(&self) -> Reached {
        self.reached
    }

    /// Checks all conditions for one tick.
    pub fn check(&mut self, feedback: &Feedback, output: &Output) {
        let telemetry = &output.telemetry;
        self.stops_now |= feedback.command == Some(Command::StopNow);
        self.check_state(feedback, output);
        self.check_shaft(output);
        self.check_offsets(output);
        let count = self.stepper.len();
        assert!(
            (count..MAX_AXES).all(|axis| output.runs(axis).is_empty()),
            "runs of axes that are not there"
        );
        for i in 0..count {
            let runs = output.runs(i);
            let cycles: u32 = runs.iter().map(|run| run.cycles()).sum();
            assert_eq!(
                cycles, self.tick_cycles,
                "axis {i}: runs do not fill the tick"
            );
            let edges = runs.iter().any(|run| run.edges() > 0);
            assert!(self.stepper[i] || !edges, "axis {i}: pulses for a servo");
            assert!(
                output.drives_enabled || !edges,
                "axis {i}: pulses for a drive that is off"
            );
        }
        let rested = matches!(self.state, State::Idle | State::Parked);
        let moves = matches!(telemetry.state, State::Homing | State::Run);
        self.stops_now &= !(rested && moves);
        self.state = telemetry.state;
        self.has_drives_on = output.drives_enabled;
        self.reached.ticks += 1;
        self.reached.running += u32::from(telemetry.state == State::Run);
        self.reached.faults += u32::from(telemetry.fault.is_some() && self.fault.is_none());
        for fault in telemetry.fault.iter().chain(&telemetry.event) {
            self.reached.kinds |= 1 << fault.kind as u32;
        }
        self.fault = telemetry.fault;
    }

    fn check_state(&self, feedback: &Feedback, output: &Output) {
        let telemetry = &output.telemetry;
        let (before, now) = (self.state, telemetry.state);
        let on = output.drives_enabled;
        // In a fault the drives hold or not, but they are never switched on.
        let expected = match now {
            State::Idle => false,
            State::Homing | State::Run | State::Stop | State::Parked => true,
            State::Fault => on && self.has_drives_on && !self.has_brake,
        };
        assert_eq!(on, expected, "{now:?}");
        assert!(
            feedback.inputs.enable || !on,
            "drives on without enable: {now:?}"
        );
        if let Some(fault) = self.fault {
            let reset = before == State::Fault && feedback.command == Some(Command::Reset);
            match telemetry.fault {
                None => assert!(
                    reset && now == State::Idle,
                    "{fault:?} forgotten: {before:?} to {now:?}"
                ),
                Some(later) => {
                    assert_eq!(
                        (later.tick, later.phase),
                        (fault.tick, fault.phase),
                        "another fault"
                    );
                    assert!(
                        matches!(now, State::Stop | State::Fault),
                        "{now:?} with {fault:?}"
                    );
                }
            }
        }
        if feedback.inputs.stop {
            assert!(
                !matches!(now, State::Homing | State::Run),
                "stop is not obeyed"
            );
        }
        assert!(
            before != State::Idle
                || now == State::Idle
                || matches!(feedback.command, Some(Command::Start | Command::Home)),
            "started by nobody"
        );
    }

    fn check_shaft(&mut self, output: &Output) {
        let (phase, drives) = (output.telemetry.phase, output.drives_enabled);
        let speed = phase.since(self.phase).to_bits();
        let (acceleration, jerk) = (speed - self.speed, speed - self.speed - self.acceleration);
        if drives {
            let fault = usize::from(output.telemetry.fault.is_some() || self.stops_now);
            let max = (self.max_acceleration[fault], self.max_jerk[fault]);
            assert!(
                speed >= 0 && speed as f64 <= self.max_speed,
                "speed {speed}"
            );
            assert!(
                acceleration.unsigned_abs() as f64 <= max.0,
                "acceleration {acceleration} over {}",
                max.0
            );
            assert!(
                jerk.unsigned_abs() as f64 <= max.1,
                "jerk {jerk} over {}",
                max.1
            );
            self.acceleration = acceleration;
        } else {
            assert_eq!(speed, 0, "moves with drives off");
            self.acceleration = 0;
        }
        (self.phase, self.speed) = (phase, speed);
    }

    fn check_offsets(&self, output: &Output) {
        let telemetry = &output.telemetry;
        let corrections = &telemetry.correction;
        // Axes move one after the other, each by the steps of one slot, and are rounded to whole steps.
        let sum: i64 = corrections.iter().map(|turns| turns.to_bits()).sum();
        let slots: i64 = self.max_slot.iter().sum();
        assert!(sum.abs() <= 2 * slots, "corrections {corrections:?}");
        let untouched = self.corrects || corrections.iter().all(|&turns| turns == 0);
        assert!(
            untouched || telemetry.state != State::Run,
            "runs with {corrections:?}, and nothing is to be corrected",
        );
        for (i, max) in self.max_offset.iter().enumerate() {
            if let Some(offset) = self.plain[i] {
                let by = telemetry
                    .axis_phase(i)
                    .since(telemetry.phase)
                    .wrapping_sub(offset)
                    .to_bits()
                    .abs();
                // An offset is rounded once, and the limit may be rounded too.
                assert!(by <= max + 2, "axis {i}: phase offset {by} over {max}");
            }
        }
    }
}
