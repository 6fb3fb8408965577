//! One tick of the whole path: program, mechanism, master shaft, axes, pulses and setpoints; and back
//! from the index pulses through the drift monitor to the supervisor.
//!
//! **Times.** What [`Controller::tick`] returns at one deadline is played from the next deadline on,
//! for one tick. The index pulses handed to it came between the deadline before and this one, while
//! the output of two ticks ago was played.

mod channel;
mod configure;
mod correct;
mod correction;
mod drive;
mod events;
mod hold;
mod homing;
mod punctuality;
mod tick;
mod wiring_proof;

use crate::axes::{Cams, PhaseOffsets};
use crate::drift::{AxisSet, DriftMonitor, History};
use crate::mechanism::AnyMechanism;
use crate::program::{AmplitudeOverride, Cursor, Program};
use crate::pulse::StepRates;
use crate::servo::Coupling;
use crate::shaft::{Motion, Shaft, Target};
use crate::signals::Output;
use crate::supervisor::{Fault, FaultKind, State, Supervisor};
use crate::units::{Amax, MAX_AXES, Phase, Turns};
use channel::Channel;
use correction::Correction;
use hold::HoldWatch;
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
    /// The tick in which the drives were on last, before a fault state in which they may hold.
    driven: u64,
    /// The level towards which the program goes, and the speed that belongs to it.
    end: (Amax, Turns),
    /// Phase at which the cranks park, as they stand, and as the master counts it.
    park_crank: Turns,
    park: Turns,
    amplitude: AmplitudeOverride,
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
    hold: HoldWatch,
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

    /// Replaces the program of a machine that is idle or parked, and begins it anew. Returns false in any other state.
    ///
    /// The program must have been made for this controller's tick rate, mechanism and greatest speed.
    #[inline(never)]
    pub fn load_program(&mut self, program: &Program) -> bool {
        if !matches!(self.supervisor.state(), State::Idle | State::Parked) {
            return false;
        }
        self.program.copy_from(program);
        self.cursor = Cursor::new();
        true
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

    /// True if work that can wait may be done in this tick: in one that is not busy, or after too many that were.
    const fn has_time(&self) -> bool {
        !self.is_busy || self.busy_ticks >= MOST_BUSY_TICKS
    }

    /// The master's phase as the cranks stand.
    fn crank_phase(&self) -> Phase {
        self.shaft.phase().advanced(self.homing.home_offset())
    }
}

#[cfg(test)]
mod tests;
