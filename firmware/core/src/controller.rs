//! One tick of the whole path: program, mechanism, master shaft, axes, pulses and setpoints; and back
//! from the index pulses through the drift monitor to the supervisor.
//!
//! **Times.** What [`Controller::tick`] returns at one deadline is played from the next deadline on,
//! for one tick. The index pulses handed to it came between the deadline before and this one, while
//! the output of two ticks ago was played.

mod align;
mod channel;
mod configure;
mod drive;
mod punctuality;
mod telling;
mod wiring_proof;

use crate::axes::Correction;
use crate::drift::{AxisSet, DriftMonitor, Finding, History, Sensed};
use crate::mechanism::{AnyMechanism, Mechanism};
use crate::program::{Cursor, Program};
use crate::pulse::Paces;
use crate::servo::Coupling;
use crate::shaft::{Demand, Motion, Shaft, Target};
use crate::signals::{Feedback, Output};
use crate::supervisor::{Action, Command, Fault, FaultKind, Seen, State, Supervisor};
use crate::units::{Amax, MAX_AXES, ONE_TURN, Phase, Turns};
use align::Align;
use channel::Channel;
use punctuality::Punctuality;
use telling::weigh;

/// The control loop's state, less its waiting.
#[derive(Clone, Debug)]
pub struct Controller {
    tick_hz: u32,
    mechanism: AnyMechanism,
    program: Program,
    cursor: Cursor,
    target: Target,
    /// The level towards which the program goes, and the speed that belongs to it.
    end: (Amax, Turns),
    shaft: Shaft,
    /// Phase at which the cranks park, as they stand, and as the master counts it.
    park_crank: Turns,
    park: Turns,
    channels: heapless::Vec<Channel, MAX_AXES>,
    /// What the axes were commanded in the last outputs.
    history: History,
    has_servos: bool,
    pace: Paces,
    /// Axes whose trims may be on their way.
    trimming: AxisSet,
    /// Axes that trims and corrections moved in the last tick; not known before the first.
    own: Option<AxisSet>,
    /// Axes with a ratio.
    geared: AxisSet,
    drift: DriftMonitor,
    align: Align,
    correction: Correction,
    /// Rounds of the monitor, and turns of the master, up to when the cranks were corrected last.
    corrected: u32,
    turned: Turns,
    coupling: Option<Coupling>,
    supervisor: Supervisor,
    /// What is told a tick later, as there was something else to tell.
    untold: Option<Fault>,
    /// The stop input's level in the last tick.
    stop_input: bool,
    /// The tick in which the drives were on last.
    driven: u64,
    motion: Motion,
    ticks: u64,
    punctuality: Punctuality,
    overrun: Option<Fault>,
    /// Deadlines were missed: what the index sensors said since belongs to no known phase.
    was_late: bool,
    output: Output,
}

/// Ticks after a stop in which what its last pulses show is still heard: a tick is read two ticks after it was reckoned.
const LAST_PULSES: u64 = 4;

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

    /// Sets an axis's trim; says whether its limit allowed all of it. An axis that is not there has
    /// no trim: false.
    pub fn set_trim(&mut self, axis: usize, turns: Turns) -> bool {
        self.channels.get_mut(axis).is_some_and(|channel| {
            self.trimming |= 1 << axis;
            channel.axis.trim_mut().set(turns)
        })
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
    /// Never inlined: this is the name by which the image's checks find the tick.
    #[inline(never)]
    pub fn tick(&mut self, feedback: &Feedback) -> &Output {
        if feedback.command == Some(Command::ResetPeak) {
            self.drift.reset_peak();
        }
        let mut seen = Seen::default();
        let told = self.observe(feedback, &mut seen);
        let before = self.supervisor.state();
        let was_well = !self.supervisor.has_fault();
        let action = self
            .supervisor
            .step(feedback.inputs, feedback.command, &seen);
        let now = self.supervisor.state();
        if now != before {
            self.enter(before, now);
        }
        let is_news = self.supervisor.has_fault() && (was_well || seen.refines);
        let stop = feedback.inputs.stop && !self.stop_input;
        self.stop_input = feedback.inputs.stop;
        self.output.telemetry.incident = None;
        if is_news || stop || told.is_some() || self.untold.is_some() {
            self.tell(is_news, told, stop);
        }
        let demand = self.demand(action);
        self.motion = self.shaft.advance(demand);
        self.drive(action != Action::Stand);
        self.report(action);
        self.ticks += 1;
        self.punctuality.met();
        &self.output
    }

    /// What has been seen since the last tick; what of it is told, whatever is done about it.
    #[inline(never)]
    fn observe(&mut self, feedback: &Feedback, seen: &mut Seen) -> Option<Fault> {
        let mut found = self.measure(feedback);
        let drives_on = self.supervisor.drives_enabled();
        if drives_on {
            self.driven = self.ticks;
        }
        if let Some(finding) = &mut found {
            // What cranks do that nothing drives is nobody's fault. But a name may come with the last of a stop's pulses.
            let in_time = finding.refines && self.ticks - self.driven <= LAST_PULSES;
            if !drives_on && !in_time {
                found = None;
            } else if finding.fault.kind == FaultKind::TooFarOut
                && let Some(fault) = self.align.explain(&self.drift, &self.correction)
            {
                finding.fault = fault;
            }
        }
        if self.supervisor.state() == State::Align && found.is_none() {
            found = self.find_out();
        } else if self.correction.is_on() && self.supervisor.state() == State::Run {
            let swapped = self.correct();
            // What is told in safety of cranks that are driven apart comes of that.
            if swapped.is_some() {
                found = found.filter(|found| !found.in_safety).or(swapped);
            }
        }
        seen.at_rest = self.motion.at_rest;
        seen.aligned = self.align.is_done();
        seen.program_done = self.cursor.is_done(&self.program);
        seen.tick = self.ticks;
        seen.phase = self.crank_phase();
        let told = found.and_then(|found| weigh(found, &self.supervisor, seen));
        let alarm = feedback.alarm.iter().fold(false, |any, alarm| any | alarm);
        if alarm || feedback.ran_dry.is_some() || self.overrun.is_some() {
            self.blame(feedback, seen);
        }
        told
    }

    /// Hears the sensors.
    #[inline(never)]
    fn measure(&mut self, feedback: &Feedback) -> Option<Finding> {
        let sensed = Sensed {
            index: &feedback.index,
            encoder: &feedback.encoder,
            phase: &self.output.telemetry.axis_phase,
            history: &self.history,
            correction: self.correction.now(),
            speed: self.motion.speed,
        };
        if core::mem::take(&mut self.was_late) {
            self.drift.disregard(&sensed);
            return None;
        }
        let found = self.drift.observe(&sensed);
        if let Some(coupling) = &mut self.coupling {
            // Before align is over, drifts say where cranks were left, and not what holds them up.
            if self.supervisor.drives_enabled() && self.align.is_done() {
                coupling.advance(self.drift.drift());
            } else {
                coupling.reset();
            }
        }
        found
    }

    /// Goes on with finding out where the cranks are.
    fn find_out(&mut self) -> Option<Finding> {
        let found = self
            .align
            .advance(&mut self.drift, &mut self.correction, self.motion.speed);
        let park = self.park_crank.wrapping_sub(self.align.datum());
        self.park = Phase::from_turns(park).within_turn();
        found.map(Finding::of)
    }

    /// Trims away part of what drives the cranks apart, once a turn; unless that is what drives them apart.
    fn correct(&mut self) -> Option<Finding> {
        if self.drift.has_encoders() {
            self.turned = self.turned.wrapping_add(self.motion.speed);
            if self.turned < Turns::ONE {
                return None;
            }
            self.turned = Turns::ZERO;
        } else if self.corrected == self.drift.rounds() {
            return None;
        }
        self.corrected = self.drift.rounds();
        if self.correction.is_moving() || !self.drift.is_aligned() {
            return None;
        }
        if let Some(fault) = self.align.corrected(&self.drift, &self.correction) {
            return Some(Finding::of(fault));
        }
        let errors = align::errors(&self.drift, &self.correction);
        let watched = self.drift.watched();
        let target = self.correction.against(&errors, watched, false);
        // What trims are not allowed to take away stays, until it is past a limit.
        if self.correction.past_limit(&target).is_none() && self.drift.allows(&target) {
            self.correction.go_to(target);
        }
        None
    }

    /// The master's phase as the cranks stand.
    fn crank_phase(&self) -> Phase {
        self.shaft.phase().advanced(self.align.datum())
    }

    /// Sets up for a state that was just entered.
    #[inline(never)]
    fn enter(&mut self, before: State, now: State) {
        match now {
            // Whatever the cranks did while the drives were off, only their index pulses tell.
            State::Align if before == State::Idle => {
                self.drift.reset(&self.output.telemetry.axis_phase);
                self.align.begin();
                self.correction.hold();
                self.cursor = Cursor::new();
                self.target = Target::steady(Turns::ZERO);
            }
            State::Run if before == State::Parked => {
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
            Action::Creep => Demand::Follow(Target::steady(self.shaft.limits().creep())),
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
        self.output.telemetry.amax_program = reading.level;
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
        telemetry.fault = self.supervisor.fault();
        if !matches!(action, Action::Play | Action::Hold) {
            telemetry.amax_program = Amax::ZERO;
        }
        telemetry.program_ticks = self.cursor.elapsed();
        telemetry.holding = action == Action::Hold;
        telemetry.motion = self.motion;
        telemetry.phase = self.shaft.phase();
        if self.drift.take_changed() {
            telemetry.drift = *self.drift.drift();
            telemetry.peak = *self.drift.peak();
            telemetry.modes = *self.drift.modes();
        }
        telemetry.datum = self.align.datum();
    }
}

#[cfg(test)]
mod tests;
