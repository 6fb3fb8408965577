//! Interface between the loop and a simulated machine. It takes the place of the board's pins and PIO on the controller.
//!
//! An output that the loop writes at one deadline is played from the next on, so that outputs wait here for their time. The machine is
//! advanced to the present whenever the loop reads.

use std::cell::OnceCell;
use std::collections::VecDeque;

use cophase_core::control_loop::{Io, SubmissionResult};
use cophase_core::monitor::IndexPulses;
use cophase_core::signals::{Feedback, Output, Telemetry};
use cophase_core::supervisor::{Command, Fault, State};
use cophase_core::units::AxisSet;
use cophase_scene::SceneError;
use cophase_scene::file::FaultAt;
use cophase_scene::units::turns;
use embassy_time::Instant;

use super::coast::STANDS_S;
use super::moment::{Moment, Observer};
use super::outcome::Outcome;
use super::schedule::Schedule;
use super::truth::TruthRecorder;
use super::unwrapped::Unwrapped;
use crate::axes::{Axes, per_axis};
use crate::checked::Checked;
use crate::drives::{IndexSensor, Passages, Played};
use crate::faults::Faults;
use crate::simulated_machine::SimulatedMachine;
use crate::virtual_time::{self, TICKS_PER_S};

/// Output that waits for its time, or is played.
#[derive(Clone, Debug)]
struct Waiting {
    start_us: u64,
    played: Played,
    telemetry: Telemetry,
    sync: bool,
}

/// Simulated environment of the loop. It is read with an [`Observer`]: see [`Observed`].
#[derive(Clone)]
pub struct SimulatedIo {
    tick_us: u64,
    tick_hz: u32,
    machine: SimulatedMachine,
    sensors: Axes<IndexSensor>,
    /// Sensors whose lines or filters may still change, one bit each. The others are skipped until an event reaches them.
    awake: u8,
    /// Time of the last reading, µs.
    read_us: u64,
    /// Time up to which the sensors have been read, µs: the end of a tick.
    sensed_us: u64,
    schedule: Schedule,
    faults: Faults,
    recorder: TruthRecorder,
    /// Boxed, because an output has kilobytes of room for runs, and is passed on every tick.
    waiting: VecDeque<Box<Waiting>>,
    /// Played outputs, kept to reuse their memory.
    #[expect(
        clippy::vec_box,
        reason = "boxes move between here and the queue; what is in them is kilobytes"
    )]
    spare: Vec<Box<Waiting>>,
    /// Output that was played last.
    last: Option<Box<Waiting>>,
    drives_enabled: bool,
    master: Unwrapped,
    axes: Axes<Unwrapped>,
    /// Values of the tick that is played, kept to reuse their memory.
    now: Now,
    /// Outputs written.
    ticks: u64,
    /// Outputs played.
    played: u64,
    state: State,
    fault: Option<Fault>,
    /// Consecutive ticks in a settled state with nothing more due.
    quiet: u64,
    /// Number of such ticks after which the run ends.
    tail_ticks: u64,
    /// Start of the output that was written last, µs: the deadline at which the loop reads next.
    next_us: u64,
    /// The loop pauses before the first deadline that is not before this time, µs.
    pause_us: u64,
    is_over: bool,
}

/// Time for which a run continues after its end, s, so that traces show the machine at rest.
pub const TAIL_S: f64 = STANDS_S;
/// Longest such time, s, if cranks still move.
const MAX_TAIL_S: f64 = 5.0;

/// Ticks between two reports of progress.
const PROGRESS_TICKS: u64 = 8192;

impl SimulatedIo {
    /// Creates the machine of a scene, at power-up.
    ///
    /// # Errors
    /// Fails if the machine of the scene cannot be created.
    pub fn new(checked: &Checked, schedule: Schedule) -> Result<Self, SceneError> {
        let machine = SimulatedMachine::new(checked)?;
        let tick_hz = checked.settings.tick_hz;
        Ok(Self {
            tick_us: 1_000_000 / u64::from(tick_hz),
            tick_hz,
            now: Now::new(machine.axes.len()),
            sensors: machine.sensors(checked),
            recorder: TruthRecorder::new(checked),
            machine,
            awake: u8::MAX,
            read_us: 0,
            sensed_us: 0,
            schedule,
            faults: Faults::new(checked),
            waiting: VecDeque::new(),
            spare: Vec::new(),
            last: None,
            drives_enabled: false,
            master: Unwrapped::default(),
            axes: Axes::new(),
            ticks: 0,
            played: 0,
            state: State::Idle,
            fault: None,
            quiet: 0,
            tail_ticks: ticks_in(TAIL_S, tick_hz),
            next_us: 0,
            pause_us: u64::MAX,
            is_over: false,
        })
    }

    /// Makes the recorder record forces.
    pub fn record_forces(&mut self) {
        self.recorder.records_forces = true;
    }

    /// Makes the loop pause before the first deadline that is not before `pause_us`, µs. Returns the next deadline, µs, if the loop has to
    /// run to reach that time.
    pub fn pause_at(&mut self, pause_us: u64) -> Option<u64> {
        self.pause_us = pause_us;
        (!self.is_over && self.next_us < pause_us).then_some(self.next_us)
    }

    /// Continues with a schedule and with faults that are all still to come.
    pub fn go_on_with(&mut self, schedule: Schedule, faults: Faults) {
        self.schedule = schedule.after(&self.schedule);
        self.faults = faults;
        self.quiet = 0;
        self.is_over = self.machine.broken().is_some();
    }

    /// Adds a fault, which was checked against the scene. It begins at its time.
    pub fn inject(&mut self, fault: &FaultAt) {
        self.faults.add(fault);
    }

    /// Ends the run, and returns its outcome.
    pub fn finish(self) -> Outcome {
        // Cranks that no drive holds may accelerate beyond the speed limit of the machine. That ends the run, but is not a divergence of
        // the equations.
        let let_go = self.quiet > self.tail_ticks && self.recorder.coast.is_on();
        let broken = self.machine.broken().filter(|_| !let_go);
        let last = self.last.as_ref().map(|last| &last.telemetry);
        Outcome {
            method: self.machine.method(),
            diverged: broken.map(|error| error.to_string()),
            state: last.map_or(self.state, |last| last.state),
            fault: self.fault,
            tick_hz: self.tick_hz,
            record: self
                .recorder
                .finish(&self.machine, self.played, last, &self.now.command_turns),
        }
    }

    /// Reads the sensors over ticks without an output, up to the time `until_us`.
    fn stand(&mut self, until_us: u64, detected: &mut IndexPulses) {
        while self.sensed_us < until_us {
            self.now.passages = Passages::default();
            self.detect(detected);
        }
    }

    /// Reads the sensors and the rises of their lines over one tick. If several pulses are read at one deadline, the latest counts. One
    /// tick is all that the loop reads, unless it is late.
    fn detect(&mut self, detected: &mut IndexPulses) {
        self.now.index.fill(None);
        self.now.index_fell.fill(None);
        let active = self.now.passages.brought() | self.awake;
        if active != 0 {
            self.read_sensors(active, detected);
        }
        self.sensed_us += self.tick_us;
    }

    #[inline(never)]
    fn read_sensors(&mut self, active: u8, detected: &mut IndexPulses) {
        let tick_cycles = self.machine.tick_cycles();
        self.awake = 0;
        for (i, sensor) in self.sensors.iter_mut().enumerate() {
            if active >> i & 1 == 0 {
                continue;
            }
            let passed = self.now.passages.get(i).unwrap_or_default();
            let line = sensor.tick(passed, tick_cycles, || self.faults.misses(i));
            if line.pulse.is_some() {
                detected.set(i, line.pulse);
            }
            self.now.index[i] = line.rose;
            self.now.index_fell[i] = line.fell;
            self.awake |= u8::from(!sensor.is_quiet()) << i;
        }
    }

    /// Plays one output, reads the sensors, and passes the tick to the observers.
    fn play(&mut self, waiting: &Waiting, detected: &mut IndexPulses, observer: &mut dyn Observer) {
        let Waiting {
            start_us,
            played,
            telemetry,
            sync,
        } = waiting;
        let master_turns = self.master.follow(telemetry.phase);
        if self.axes.is_empty() {
            self.axes = per_axis(self.sensors.len(), |i| {
                Unwrapped::starting_at(telemetry.axis_phase(i))
            });
        }
        let commands = self
            .now
            .command_turns
            .iter_mut()
            .zip(&mut self.now.aim_turns);
        for (i, (axis, (command, aim))) in self.axes.iter_mut().zip(commands).enumerate() {
            *command = axis.follow(telemetry.axis_phase(i));
            *aim = *command - turns(telemetry.correction[i]);
        }
        for (axis, extra) in self.faults.extra(*start_us) {
            self.machine.axes[axis].add_pulses(extra);
        }
        let disturbance = self.faults.disturbance(*start_us);
        self.machine.play(
            played,
            self.drives_enabled,
            turns(telemetry.motion.speed),
            &self.now.command_turns,
            disturbance,
            &mut self.now.passages,
        );
        debug_assert!(
            (self.machine.axes.iter().enumerate()).all(|(i, axis)| axis
                .counted_steps()
                .is_none_or(|steps| steps == telemetry.steps(i))),
            "the drives count what the loop commands"
        );
        self.detect(detected);
        let levels = self.now.index_high.iter_mut().zip(&self.sensors);
        levels.for_each(|(level, sensor)| *level = sensor.is_high());
        self.faults.swap(&mut self.now.index);
        self.faults.swap(&mut self.now.index_fell);
        self.faults.swap(&mut self.now.index_high);
        self.take_note(*start_us);
        for (actual, axis) in self.now.actual_turns.iter_mut().zip(&self.machine.axes) {
            *actual = axis.turns();
        }
        let moment = Moment {
            start_ns: start_us * 1000,
            end_ns: (start_us + self.tick_us) * 1000,
            telemetry,
            played,
            drives_enabled: self.drives_enabled,
            sync: *sync,
            index: &self.now.index,
            index_fell: &self.now.index_fell,
            index_high: &self.now.index_high,
            master_turns,
            command_turns: &self.now.command_turns,
            aim_turns: &self.now.aim_turns,
            actual_turns: &self.now.actual_turns,
            machine: &self.machine,
            tilt_mrad: OnceCell::new(),
            pose: OnceCell::new(),
        };
        self.played += 1;
        // Only played ticks count. The run may end before the next tick, and then no later tick shows a fault that latched in this one.
        self.fault = self.fault.or(telemetry.fault);
        self.recorder.tick(&moment);
        observer.tick(&moment);
    }

    /// True if nothing has happened for long enough, and nothing moves any more.
    fn is_at_rest(&self) -> bool {
        let recorder = &self.recorder;
        let moves = recorder.coast.is_on() || recorder.fault_hold.moves(self.tail_ticks);
        self.quiet > self.tail_ticks && (!moves || self.quiet > ticks_in(MAX_TAIL_S, self.tick_hz))
    }

    /// Records the faults that have begun up to a time.
    fn take_note(&mut self, at_us: u64) {
        for fault in self.faults.new_faults() {
            let t_s = at_us as f64 / TICKS_PER_S as f64;
            self.recorder.injected(t_s, fault);
        }
    }

    /// Plays the outputs that are due, shows them to the observer, and returns the feedback: see [`Io::read`].
    pub fn read(&mut self, observer: &mut dyn Observer) -> Feedback {
        let now = Instant::now().as_micros();
        let mut index = IndexPulses::NONE;
        while self
            .waiting
            .front()
            .is_some_and(|waiting| waiting.start_us + self.tick_us <= now)
        {
            let Some(waiting) = self.waiting.pop_front() else {
                break;
            };
            self.stand(waiting.start_us, &mut index);
            self.play(&waiting, &mut index, observer);
            self.spare.extend(self.last.replace(waiting));
        }
        if self.sensed_us + self.tick_us <= now {
            self.stand(now - now % self.tick_us, &mut index);
        }
        let now_s = now as f64 / TICKS_PER_S as f64;
        while let Some(input) = self.schedule.input(now) {
            self.recorder.input(now_s, input.line, input.active);
        }
        let command = self.schedule.command(now);
        // A start at the beginning of the scene is not an event.
        if let Some(command) = command.filter(|command| now > 0 || *command != Command::Start) {
            self.recorder.commanded(now_s, command);
        }
        let axes = self.machine.axes.iter().enumerate();
        let alarms = axes.fold(0, |alarms, (i, axis)| {
            alarms | AxisSet::from(axis.drive().alarm()) << i
        });
        let mut feedback = Feedback {
            index,
            encoder: self.machine.encoders(),
            alarms,
            fifo_underrun: None,
            inputs: self.schedule.read_lines(),
            command,
        };
        let since = std::mem::replace(&mut self.read_us, now);
        self.faults.read(since, now, &mut feedback);
        self.take_note(now);
        feedback
    }

    /// Takes an output that is played from `start` on: see [`Io::write`].
    pub fn write(&mut self, output: &Output, start: Instant) -> SubmissionResult {
        let start_us = start.as_micros();
        let mut waiting = self.spare.pop().unwrap_or_else(|| {
            Box::new(Waiting {
                start_us,
                played: Played::nothing(self.machine.axes.len()),
                telemetry: output.telemetry.clone(),
                sync: output.sync,
            })
        });
        waiting.start_us = start_us;
        waiting.played.copy_from(output);
        waiting.telemetry.clone_from(&output.telemetry);
        waiting.sync = output.sync;
        self.waiting.push_back(waiting);
        let is_switched = self.drives_enabled != output.drives_enabled;
        self.drives_enabled = output.drives_enabled;
        self.ticks += 1;
        self.state = output.telemetry.state;

        let settled = matches!(self.state, State::Idle | State::Parked | State::Fault);
        // If the drives are switched off late in a hold, the cranks still have to coast before the run ends, so that it is reported.
        self.quiet = if settled && self.schedule.is_over() && !is_switched {
            self.quiet + 1
        } else {
            0
        };
        let broken = self.machine.broken().is_some();
        self.is_over = broken || self.is_at_rest() || start_us > self.schedule.end_us();
        self.next_us = start_us;
        if self.is_over || start_us >= self.pause_us {
            return SubmissionResult::Over;
        }
        SubmissionResult::InTime
    }
}

/// Simulated environment and its observer while the loop runs. It has no type parameter, so that the loop is compiled here once, and not
/// again in each crate that runs scenes, which may be optimised less.
pub struct Observed<'a> {
    /// Environment of the loop.
    pub io: &'a mut SimulatedIo,
    /// Observer of each tick.
    pub observer: &'a mut dyn Observer,
    /// Called from time to time with the number of ticks done and the approximate total.
    pub progress: &'a mut dyn FnMut(u64, u64),
}

impl Io for Observed<'_> {
    fn read(&mut self, feedback: &mut Feedback) {
        *feedback = self.io.read(self.observer);
    }

    fn until(&mut self, deadline: Instant) -> impl Future<Output = ()> {
        virtual_time::until(deadline.as_micros())
    }

    fn write(&mut self, output: &Output, start: Instant) -> SubmissionResult {
        let result = self.io.write(output, start);
        if self.io.ticks.is_multiple_of(PROGRESS_TICKS) {
            let expected = self.io.schedule.expected_us() / self.io.tick_us;
            (self.progress)(self.io.ticks, expected);
        }
        result
    }
}

fn ticks_in(seconds: f64, tick_hz: u32) -> u64 {
    (seconds * f64::from(tick_hz)) as u64
}

/// Values of the tick that is played: see [`Moment`].
#[derive(Clone, Debug)]
struct Now {
    passages: Passages,
    index: Axes<Option<u32>>,
    index_fell: Axes<Option<u32>>,
    index_high: Axes<bool>,
    command_turns: Axes<f64>,
    aim_turns: Axes<f64>,
    actual_turns: Axes<f64>,
}

impl Now {
    fn new(count: usize) -> Self {
        let nowhere = || per_axis(count, |_| 0.0);
        Self {
            passages: Passages::default(),
            index: per_axis(count, |_| None),
            index_fell: per_axis(count, |_| None),
            index_high: per_axis(count, |_| false),
            command_turns: nowhere(),
            aim_turns: nowhere(),
            actual_turns: nowhere(),
        }
    }
}
