//! One tick of the whole path: program, mechanism, master shaft, axes, pulses and setpoints; and back
//! from the index pulses through the drift monitor to the supervisor.
//!
//! **Times.** What [`Controller::tick`] returns at one deadline is played from the next deadline on,
//! for one tick. The index pulses handed to it came between the deadline before and this one, while
//! the output of two ticks ago was played.

mod channel;
mod configure;
mod correction;
mod drive;
mod events;
mod homing;
mod punctuality;
mod wiring_proof;

use crate::axes::{Cams, PhaseOffsets};
use crate::drift::{AxisSet, DriftMonitor, Finding, History, Sensed};
use crate::mechanism::{AnyMechanism, Mechanism};
use crate::program::{Cursor, Program};
use crate::pulse::StepRates;
use crate::servo::Coupling;
use crate::shaft::{Demand, Motion, Shaft, Target};
use crate::signals::{Feedback, Output};
use crate::supervisor::{Action, Command, Fault, FaultKind, State, Supervisor, SupervisorInput};
use crate::units::{Amax, MAX_AXES, ONE_TURN, Phase, Turns};
use channel::Channel;
use correction::Correction;
use events::select_reaction;
use homing::Homing;
use punctuality::Punctuality;

/// State of the control loop.
#[derive(Clone, Debug)]
#[repr(C)] // What every tick needs comes first: the board's instructions reach 32 bytes, or 128 by words.
pub struct Controller {
    /// This tick has done work that is not due in every tick.
    is_busy: bool,
    /// Ticks in a row that were busy.
    busy_ticks: u8,
    /// Deadlines were missed: what the index sensors said since belongs to no known phase.
    was_late: bool,
    /// The stop input's level in the last tick.
    stop_input: bool,
    has_servos: bool,
    /// Axes that do not make the master's own turns.
    followers: AxisSet,
    /// Axis that has a plan of its own because its phase offset moves.
    apart: Option<usize>,
    punctuality: Punctuality,
    tick_hz: u32,
    motion: Motion,
    target: Target,
    ticks: u64,
    /// The tick in which the drives were on last.
    driven: u64,
    /// The level towards which the program goes, and the speed that belongs to it.
    end: (Amax, Turns),
    /// Phase at which the cranks park, as they stand, and as the master counts it.
    park_crank: Turns,
    park: Turns,
    supervisor: Supervisor,
    /// Event that is published a tick later, as another was published in this one.
    unpublished: Option<Fault>,
    overrun: Option<Fault>,
    shaft: Shaft,
    step_rate: StepRates,
    /// Turns that the axes were commanded in the last outputs.
    history: History,
    cursor: Cursor,
    program: Program,
    mechanism: AnyMechanism,
    channels: heapless::Vec<Channel, MAX_AXES>,
    drift: DriftMonitor,
    offsets: PhaseOffsets,
    correction: Correction,
    homing: Homing,
    /// Curves of the cam tables.
    cams: Cams,
    coupling: Option<Coupling>,
    output: Output,
}

/// Busy ticks in a row after which further work is no longer postponed: more than the pulses of all axes and a correction take.
const MOST_BUSY_TICKS: u8 = MAX_AXES as u8 + 12;

impl Controller {
    /// How many axes there are.
    pub fn axis_count(&self) -> usize {
        self.channels.len()
    }

    /// Control ticks a second.
    pub const fn tick_hz(&self) -> u32 {
        self.tick_hz
    }

    /// Whether an axis is mounted the other way round: its DIR is to be turned. One that is not there is not.
    pub fn is_reversed(&self, axis: usize) -> bool {
        self.channels
            .get(axis)
            .is_some_and(|channel| channel.reversed)
    }

    /// The program, and the place in it.
    pub const fn program(&self) -> (&Program, &Cursor) {
        (&self.program, &self.cursor)
    }

    /// Goes to a place in the program, ticks from its start. Takes effect like a jump of the level:
    /// the shaft follows within its limits.
    pub fn seek(&mut self, elapsed: u64) {
        self.cursor.seek(&self.program, elapsed);
    }

    /// The mechanism, for converting between speed and amax.
    pub const fn mechanism(&self) -> &AnyMechanism {
        &self.mechanism
    }

    /// Sets the user's part of an axis's phase offset, rounded to whole steps. Returns false if the axis's limit cut it, or if
    /// there is no such axis.
    pub fn set_trim(&mut self, axis: usize, turns: Turns) -> bool {
        self.offsets.set_user(axis, turns)
    }

    /// Takes note of a deadline that was met late, by over half a tick or not, after `missed` deadlines
    /// that were not met at all.
    ///
    /// While deadlines are missed the step hardware has nothing to play: all axes stand, and go on
    /// from where they stood. No phase is lost by that, and none is made up for: the machine's time
    /// is behind by as many ticks.
    pub fn late(&mut self, missed: u32, over_half: bool) {
        let limits = &mut self.output.telemetry.limits;
        limits.late_deadlines = limits.late_deadlines.saturating_add(u32::from(over_half));
        if missed == 0 {
            return;
        }
        limits.missed_deadlines = limits.missed_deadlines.saturating_add(missed);
        self.history = History::new();
        self.stood(missed);
    }

    /// Takes note that the last output was handed over `missed` ticks late, and is played by that much
    /// later. As with [`Self::late`], the machine stands meanwhile, and is behind.
    pub const fn held_over(&mut self, missed: u32) {
        let limits = &mut self.output.telemetry.limits;
        limits.missed_deadlines = limits.missed_deadlines.saturating_add(missed);
        self.stood(missed);
    }

    const fn stood(&mut self, missed: u32) {
        self.was_late = true;
        if self.punctuality.missed(missed) {
            self.overrun = Some(Fault::new(FaultKind::Overrun));
        }
    }

    /// Begins in the fault state: for what is known before the first tick.
    pub const fn begin_with(&mut self, fault: Fault) {
        self.supervisor.begin_with(fault);
    }

    /// Plays one tick.
    ///
    /// Never inlined: this is the name by which the firmware's checks find the tick.
    #[inline(never)]
    pub fn tick(&mut self, feedback: &Feedback) -> &Output {
        if feedback.command == Some(Command::ResetPeak) {
            self.drift.reset_peak();
        }
        let mut input = SupervisorInput::default();
        let reported = self.observe(feedback, &mut input);
        let before = self.supervisor.state();
        let was_well = !self.supervisor.has_fault();
        let action = self
            .supervisor
            .step(feedback.inputs, feedback.command, &input);
        let now = self.supervisor.state();
        if now != before {
            self.enter(before, now);
        }
        let is_new = self.supervisor.has_fault() && (was_well || input.supersedes);
        let stop = feedback.inputs.stop && !self.stop_input;
        self.stop_input = feedback.inputs.stop;
        self.output.telemetry.event = None;
        if is_new || stop || reported.is_some() || self.unpublished.is_some() {
            self.publish(is_new, reported.as_ref(), stop);
        }
        let demand = self.demand(action);
        self.motion = self.shaft.advance(demand);
        self.drive(action != Action::Stand);
        self.report(action);
        self.ticks += 1;
        self.busy_ticks = if self.is_busy {
            self.busy_ticks.saturating_add(1)
        } else {
            0
        };
        self.punctuality.met();
        &self.output
    }

    /// Collects what was detected since the last tick; returns the event to report, if there is one.
    #[inline(never)]
    fn observe(&mut self, feedback: &Feedback, input: &mut SupervisorInput) -> Option<Fault> {
        // To plan a stop takes as long as any of the work that can wait.
        let is_about_to_stop = self.is_about_to_stop(feedback);
        let mut found = self.measure(feedback, !is_about_to_stop);
        self.is_busy = self.drift.is_busy() || is_about_to_stop;
        if self.supervisor.drives_enabled() {
            self.driven = self.ticks;
        }
        if found.is_some() {
            found = self.judge(found);
        }
        match self.supervisor.state() {
            State::Homing if found.is_none() => found = self.find_out(),
            State::Run if self.has_correction_to_do() => found = self.correct(found),
            _ => {}
        }
        input.at_rest = self.motion.at_rest;
        input.homed = self.homing.is_done();
        input.program_done = self.cursor.is_done(&self.program);
        input.tick = self.ticks;
        input.phase = self.crank_phase();
        let reported = found.and_then(|found| select_reaction(found, &self.supervisor, input));
        let alarm = feedback
            .alarm
            .iter()
            .take(self.channels.len())
            .fold(false, |any, alarm| any | alarm);
        if alarm || feedback.fifo_underrun.is_some() || self.overrun.is_some() {
            self.highest_priority_fault(feedback, input);
        }
        reported
    }

    /// Reads the sensors.
    #[inline(never)]
    fn measure(&mut self, feedback: &Feedback, may_process: bool) -> Option<Finding> {
        let sensed = Sensed {
            index: &feedback.index,
            encoder: &feedback.encoder,
            phase: self.output.telemetry.phase,
            lead: &self.output.telemetry.lead,
            history: &self.history,
            correction: self.offsets.now(),
            speed: self.motion.speed,
            may_process,
        };
        if core::mem::take(&mut self.was_late) {
            self.drift.disregard(&sensed);
            return None;
        }
        let found = self.drift.observe(&sensed);
        if cfg!(feature = "servo")
            && let Some(coupling) = &mut self.coupling
        {
            // Before homing is over, phase errors say where cranks were left, and not what holds them up.
            if self.supervisor.drives_enabled() && self.homing.is_done() {
                coupling.advance(self.drift.phase_error());
            } else {
                coupling.reset();
            }
        }
        found
    }

    /// True if the inputs or the end of the program stop the machine in this tick.
    fn is_about_to_stop(&self, feedback: &Feedback) -> bool {
        match self.supervisor.state() {
            State::Homing => feedback.inputs.stop,
            State::Run => feedback.inputs.stop || self.cursor.is_done(&self.program),
            _ => false,
        }
    }

    /// Continues homing.
    #[inline(never)]
    fn find_out(&mut self) -> Option<Finding> {
        let found = self
            .homing
            .advance(&mut self.drift, &mut self.offsets, self.motion.speed);
        let park = self.park_crank.wrapping_sub(self.homing.home_offset());
        self.park = Phase::from_turns(park).within_turn();
        found.map(Finding::of)
    }

    /// True if work that can wait may be done in this tick: in one that is not busy, or after too many that were.
    const fn has_time(&self) -> bool {
        !self.is_busy || self.busy_ticks >= MOST_BUSY_TICKS
    }

    /// The master's phase as the cranks stand.
    fn crank_phase(&self) -> Phase {
        self.shaft.phase().advanced(self.homing.home_offset())
    }

    /// Sets up for a state that was just entered.
    #[inline(never)]
    fn enter(&mut self, before: State, now: State) {
        match now {
            // Only their index pulses show where the cranks are after the drives were off.
            State::Homing if before == State::Idle => {
                let phase = |axis| self.output.telemetry.axis_phase(axis);
                self.drift.reset(&core::array::from_fn(phase));
                self.homing.begin();
                self.offsets.hold();
                self.cursor = Cursor::new();
                self.target = Target::steady(Turns::ZERO);
            }
            State::Run => {
                self.correction.restart();
                if before != State::Parked {
                    return;
                }
                if self.cursor.is_done(&self.program) {
                    self.cursor = Cursor::new();
                }
                self.target = Target::steady(Turns::ZERO);
            }
            _ => {}
        }
    }

    fn demand(&mut self, action: Action) -> Demand {
        match action {
            Action::Stand => Demand::Halt,
            Action::Home => Demand::Follow(Target::steady(self.shaft.limits().homing_speed())),
            Action::Play => Demand::Follow(self.play()),
            Action::Hold => {
                self.target = Target::steady(self.target.next);
                Demand::Follow(self.target)
            }
            Action::Park => Demand::Stop(Some(self.park)),
            Action::StopFast => Demand::Stop(None),
        }
    }

    /// Reads one tick of the program.
    #[inline(never)]
    fn play(&mut self) -> Target {
        let reading = self.cursor.next(&self.program);
        self.output.telemetry.amax_requested = reading.level;
        if self.end.0 != reading.end_level {
            self.end = (reading.end_level, self.mechanism.speed(reading.end_level));
        }
        self.target = Target {
            now: self.target.next,
            next: if reading.level == reading.end_level {
                self.end.1
            } else {
                self.mechanism.speed(reading.level)
            },
            end: self.end.1,
        };
        self.target
    }

    #[inline(never)]
    fn report(&mut self, action: Action) {
        let within = self.crank_phase().within_turn();
        let output = &mut self.output;
        output.drives_enabled = self.supervisor.drives_enabled();
        output.sync = within.to_bits() < ONE_TURN / 2;
        let telemetry = &mut output.telemetry;
        telemetry.state = self.supervisor.state();
        // Mostly there is none, before and after.
        if telemetry.fault.is_some() || self.supervisor.has_fault() {
            telemetry.fault = self.supervisor.fault();
        }
        if !matches!(action, Action::Play | Action::Hold) {
            telemetry.amax_requested = Amax::ZERO;
        }
        telemetry.program_ticks = self.cursor.elapsed();
        telemetry.holding = action == Action::Hold;
        telemetry.motion = self.motion;
        telemetry.phase = self.shaft.phase();
        if self.drift.take_changed() {
            telemetry.phase_error = *self.drift.phase_error();
            telemetry.peak = *self.drift.peak();
            telemetry.modes = *self.drift.modes();
        }
        telemetry.home_offset = self.homing.home_offset();
    }
}

#[cfg(test)]
mod tests;
