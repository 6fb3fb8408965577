//! One tick of the controller: sense, detect, decide, plan, act.

use super::Controller;
use super::events::select_reaction;
use super::hold::HoldWatch;
use crate::mechanism::Mechanism;
use crate::monitor::{Finding, Sensed};
use crate::program::Cursor;
use crate::shaft::{Demand, Target};
use crate::signals::{Feedback, Output};
use crate::supervisor::{Action, Command, Fault, FaultKind, State, SupervisorInput};
use crate::units::{Amax, ONE_TURN, Turns};

/// Number of ticks after the drives went off in which an index pulse may still date from before.
const LAST_PLAYED: u64 = 3;

impl Controller {
    /// Plays one tick.
    ///
    /// Never inlined: this is the name by which the firmware's checks find the tick.
    #[inline(never)]
    pub fn tick(&mut self, feedback: &Feedback) -> &Output {
        if feedback.command.is_some() {
            self.adjust(feedback.command);
        }
        let mut input = SupervisorInput::default();
        let mut reported = self.observe(feedback, &mut input);
        let before = self.supervisor.state();
        let was_well = !self.supervisor.has_fault();
        let could_hold = self.supervisor.drives_enabled() && !self.supervisor.cuts();
        let mut action = self
            .supervisor
            .step(feedback.inputs, feedback.command, &input);
        let now = self.supervisor.state();
        if now != before {
            match self.refusal(before, now) {
                Some(fault) => {
                    self.supervisor.begin_with(fault);
                    action = Action::Stand;
                }
                None => self.enter(before, now),
            }
        }
        let is_new = self.supervisor.has_fault() && (was_well || input.supersedes);
        if could_hold && self.supervisor.cuts() && !is_new && reported.is_none() {
            reported = Some(disabling_fault(&input));
        }
        let stop = feedback.inputs.stop && !self.state.stop_input;
        self.state.stop_input = feedback.inputs.stop;
        self.output.telemetry.event = None;
        if is_new || stop || reported.is_some() || self.state.unpublished.is_some() {
            self.publish(is_new, reported.as_ref(), stop);
        }
        let demand = self.demand(action);
        self.state.motion = self.shaft.advance(demand);
        self.drive(action != Action::Stand);
        self.report(action);
        self.state.ticks += 1;
        self.state.busy_ticks = if self.state.is_busy {
            self.state.busy_ticks.saturating_add(1)
        } else {
            0
        };
        self.state.deadlines.on_time();
        &self.output
    }

    /// Executes a command that does not change the state.
    #[inline(never)] // seldom
    fn adjust(&mut self, command: Option<Command>) {
        match command {
            Some(Command::ResetPeak) => self.monitor.reset_peak(),
            Some(Command::Override(permille)) => self.amplitude.set(permille),
            _ => {}
        }
    }

    /// Collects the measurements since the last tick. Returns the event to report, if there is one.
    #[inline(never)]
    fn observe(&mut self, feedback: &Feedback, input: &mut SupervisorInput) -> Option<Fault> {
        let mut found = self.measure(feedback);
        // A pulse takes as long as the work that can wait, and so does planning a stop.
        self.state.is_busy =
            self.monitor.pulsed_by_index(&feedback.index) != 0 || self.is_about_to_stop(feedback);
        if self.supervisor.operates() {
            self.state.driven = self.state.ticks;
        }
        if found.is_some() {
            self.judge(&mut found);
        }
        if self.supervisor.holds()
            && let Some(fault) = self.check_hold(feedback)
        {
            found = Some(Finding::from_fault(fault));
        }
        match self.supervisor.state() {
            State::Homing if found.is_none() => found = self.advance_homing(),
            State::Run if self.has_correction_to_do() => self.correct(&mut found),
            _ => {}
        }
        input.at_rest = self.state.motion.at_rest;
        input.homed = self.homing.is_done();
        input.program_done = self.state.cursor.is_done(&self.program);
        self.output.telemetry.homed = input.homed;
        self.output.telemetry.program_done = input.program_done;
        input.tick = self.state.ticks;
        input.phase = self.crank_phase();
        let reported = found
            .as_ref()
            .and_then(|found| select_reaction(found, &self.supervisor, input));
        if feedback.alarms != 0 || feedback.fifo_underrun.is_some() || self.state.overrun.is_some()
        {
            self.highest_priority_fault(feedback, input);
        }
        reported
    }

    /// Reads the sensors.
    #[inline(never)]
    fn measure(&mut self, feedback: &Feedback) -> Option<Finding> {
        let sensed = Sensed {
            index: &feedback.index,
            encoder: &feedback.encoder,
            phase: self.output.telemetry.phase,
            lead: &self.output.telemetry.lead,
            history: &self.state.history,
            correction: self.offsets.now(),
            speed: self.state.motion.speed,
        };
        if core::mem::take(&mut self.state.was_late) {
            self.monitor.disregard(&sensed);
            return None;
        }
        let found = self.monitor.observe(&sensed);
        // A stop may interrupt homing, which goes on after it.
        if !self.homing.is_done() {
            self.homing.measure(&self.monitor, self.state.motion.speed);
        }
        // Cranks that no drive holds may be turned by hand, and not all of them may have passed their flags.
        let is_held =
            self.supervisor.drives_enabled() || self.state.ticks - self.state.driven <= LAST_PLAYED;
        if !is_held && self.monitor.pulsed_by_index(&feedback.index) != 0 {
            self.homing.forget();
        }
        if let Some(coupling) = &mut self.coupling {
            // Until homing is over, phase errors show where the cranks were left, and not which load they carry.
            if self.supervisor.drives_enabled() && self.homing.is_done() {
                coupling.advance(self.monitor.phase_error());
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
            State::Run => feedback.inputs.stop || self.state.cursor.is_done(&self.program),
            _ => false,
        }
    }

    /// Continues homing.
    #[inline(never)]
    fn advance_homing(&mut self) -> Option<Finding> {
        let has_time = self.has_time();
        let (monitor, speed) = (&mut self.monitor, self.state.motion.speed);
        let fault = self
            .homing
            .advance(monitor, &mut self.offsets, speed, has_time);
        fault.map(Finding::from_fault)
    }

    /// Returns the fault with which homing would end, if it is known before anything moves: a crank was left beyond the limits of the
    /// platform.
    #[inline(never)]
    fn refusal(&mut self, before: State, now: State) -> Option<Fault> {
        if before != State::Idle || now != State::Homing || !self.homing.has_found() {
            return None;
        }
        let (axis, by) = self.monitor.left_beyond_limits(self.offsets.now())?;
        let fault = Fault::new(FaultKind::HomingRangeExceeded).on_axis(axis);
        Some(fault.with_size(by).at(self.state.ticks, self.crank_phase()))
    }

    /// Prepares the state that was just entered.
    #[inline(never)]
    fn enter(&mut self, before: State, now: State) {
        match now {
            // After the drives were off, only the index pulses show the phases of the cranks.
            State::Homing if before == State::Idle => {
                let phase = |axis| self.output.telemetry.axis_phase(axis);
                self.monitor.reset(&core::array::from_fn(phase));
                self.homing.begin();
                self.offsets.hold();
                self.state.cursor = Cursor::new();
                self.state.requested = Turns::ZERO;
            }
            // This fault names the crank at a wrong phase. The operator may have turned that crank by hand before the reset.
            State::Idle if self.latched() == Some(FaultKind::HomingRangeExceeded) => {
                self.homing.forget();
            }
            State::Parked | State::Fault => self.state.hold = HoldWatch::new(),
            State::Run => {
                self.state.correction.restart();
                if before != State::Parked {
                    return;
                }
                if self.state.cursor.is_done(&self.program) {
                    self.state.cursor = Cursor::new();
                }
                self.state.requested = Turns::ZERO;
            }
            _ => {}
        }
    }

    /// Returns the kind of the fault that was latched as of the last tick.
    fn latched(&self) -> Option<FaultKind> {
        Some(self.output.telemetry.fault?.kind)
    }

    fn demand(&mut self, action: Action) -> Demand {
        match action {
            Action::Stand => Demand::Halt,
            Action::Home => Demand::Follow(Target::steady(self.shaft.limits().homing_speed())),
            Action::Play => {
                let (amax, target) = self.play();
                self.output.telemetry.amax_requested = amax;
                Demand::Follow(target)
            }
            Action::Hold => Demand::Follow(Target::steady(self.state.requested)),
            Action::Park => Demand::Stop(Some(self.park())),
            Action::StopFast => Demand::Stop(None),
        }
    }

    /// Reads one tick of the program: its amplitude, and the target of the shaft.
    #[inline(never)]
    fn play(&mut self) -> (Amax, Target) {
        let mut reading = self.state.cursor.next(&self.program);
        if !self.amplitude.is_one() {
            (reading.level, reading.end_level) =
                self.amplitude.advance(reading.level, reading.end_level);
        }
        if self.state.end.0 != reading.end_level {
            self.state.end = (reading.end_level, self.mechanism.speed(reading.end_level));
        }
        let next = if reading.level == reading.end_level {
            self.state.end.1
        } else {
            self.mechanism.speed(reading.level)
        };
        let target = Target {
            now: core::mem::replace(&mut self.state.requested, next),
            next,
            end: self.state.end.1,
        };
        (reading.level, target)
    }

    #[inline(never)]
    fn report(&mut self, action: Action) {
        let output = &mut self.output;
        output.drives_enabled = self.supervisor.drives_enabled();
        let telemetry = &mut output.telemetry;
        telemetry.state = self.supervisor.state();
        // In most ticks there is no fault, neither before nor after.
        if telemetry.fault.is_some() || self.supervisor.has_fault() {
            telemetry.fault = self.supervisor.fault();
        }
        let refused = self.supervisor.refused();
        if telemetry.refused.is_some() || refused.is_some() {
            telemetry.refused = refused;
        }
        if !matches!(action, Action::Play | Action::Hold) {
            telemetry.amax_requested = Amax::ZERO;
        }
        telemetry.program_ticks = self.state.cursor.elapsed();
        telemetry.holding = action == Action::Hold;
        telemetry.is_at_homing_speed = action == Action::Home;
        telemetry.motion = self.state.motion;
        telemetry.override_permille = self.amplitude.permille();
        if self.monitor.take_changed() {
            telemetry.phase_error = *self.monitor.phase_error();
            telemetry.peak = *self.monitor.peak();
            telemetry.modes = *self.monitor.modes();
        }
        // The phases come last, as the four words would take up the registers meanwhile.
        telemetry.phase = self.shaft.phase();
        telemetry.home_offset = self.homing.home_offset();
        let within = self.crank_phase().within_turn();
        self.output.sync = within.to_bits() < ONE_TURN / 2;
    }
}

/// Returns the fault that switches the drives off, where they would have held after the latched one.
#[inline(never)]
fn disabling_fault(input: &SupervisorInput) -> Fault {
    input
        .fault
        .unwrap_or_else(|| Fault::new(FaultKind::EnableLost))
}
