//! Control loop: one tick of the whole path. It leads from program and mechanism through master shaft and axes to pulses and setpoints. It
//! leads back from the index pulses through the phase-drift monitor to the supervisor.
//!
//! **Times.** The output that [`Controller::tick`] returns at one deadline is played for one tick from the next deadline on. The index
//! pulses that it reads arrived between the previous deadline and this one, while the output of two ticks ago was played.

mod channel;
mod checksum;
mod configure;
mod correct;
mod correction;
mod deadline_monitor;
mod drive;
mod events;
mod hold;
mod homing;
mod tick;
mod wiring_proof;

use crate::axes::Cams;
use crate::commanded::History;
use crate::mechanism::AnyMechanism;
use crate::monitor::DriftMonitor;
use crate::phase_offset::PhaseOffsets;
use crate::program::{AmplitudeOverride, Cursor, Program};
use crate::pulse::StepRates;
use crate::servo::{Coupling, ServoPart};
use crate::shaft::{Motion, Shaft};
use crate::signals::Output;
use crate::supervisor::{Fault, FaultKind, State, Supervisor};
use crate::units::{Amax, AxisSet, MAX_AXES, Phase, Turns};
use channel::Channel;
use checksum::SettingsCheck;
use correction::Correction;
use deadline_monitor::DeadlineMonitor;
use hold::HoldWatch;
use homing::Homing;

/// The control loop: its settings in use, its parts, and its own state.
#[derive(Clone, Debug)]
#[repr(C)] // The fields that every tick needs come first: the board's instructions reach 32 bytes, or 128 by words.
pub struct Controller {
    state: LoopState,
    has_servos: bool,
    /// Axes that do not make the master's own turns.
    followers: AxisSet,
    tick_hz: u32,
    /// Phase at which the cranks park.
    park_crank: Turns,
    amplitude: AmplitudeOverride,
    supervisor: Supervisor,
    shaft: Shaft,
    step_rate: StepRates,
    program: Program,
    mechanism: AnyMechanism,
    channels: heapless::Vec<Channel, MAX_AXES>,
    monitor: DriftMonitor,
    offsets: PhaseOffsets,
    homing: Homing,
    /// Curves of the cam tables.
    cams: Cams,
    coupling: Option<ServoPart<Coupling>>,
    output: Output,
    check: SettingsCheck,
}

/// State of the loop itself, which ticks change. At power-up it is [`LoopState::new`].
#[derive(Clone, Debug)]
#[repr(C)] // as in `Controller`
struct LoopState {
    /// True if this tick has done work that is not due in every tick.
    is_busy: bool,
    /// Number of busy ticks in a row.
    busy_ticks: u8,
    /// True if deadlines were missed: index pulses since then belong to no known phase.
    was_late: bool,
    /// Level of the stop input in the last tick.
    stop_input: bool,
    /// Axis that has a plan of its own, because its phase offset moves.
    apart: Option<usize>,
    deadlines: DeadlineMonitor,
    motion: Motion,
    /// Speed that the program requested last.
    requested: Turns,
    ticks: u64,
    /// Last tick in which the drives were on, outside the fault state in which they may hold.
    driven: u64,
    /// Level toward which the program moves, and the speed for it.
    end: (Amax, Turns),
    /// Event that is published in the next tick, as another one was published in this tick.
    unpublished: Option<Fault>,
    overrun: Option<Fault>,
    /// Turns that were commanded in the last outputs.
    history: History,
    cursor: Cursor,
    correction: Correction,
    hold: HoldWatch,
}

impl LoopState {
    const fn new() -> Self {
        Self {
            is_busy: false,
            busy_ticks: 0,
            was_late: false,
            stop_input: false,
            apart: None,
            deadlines: DeadlineMonitor::new(),
            motion: Motion::AT_REST,
            requested: Turns::ZERO,
            ticks: 0,
            driven: 0,
            end: (Amax::ZERO, Turns::ZERO),
            unpublished: None,
            overrun: None,
            history: History::new(),
            cursor: Cursor::new(),
            correction: Correction::new(),
            hold: HoldWatch::new(),
        }
    }
}

/// Number of busy ticks in a row after which work is no longer postponed. The pulses of all axes and a correction take fewer.
const MAX_BUSY_TICKS: u8 = MAX_AXES as u8 + 12;

impl Controller {
    /// Number of axes.
    pub fn axis_count(&self) -> usize {
        self.channels.len()
    }

    /// Control ticks per second.
    pub const fn tick_hz(&self) -> u32 {
        self.tick_hz
    }

    /// True if an axis is mounted in reverse, so that its DIR must be inverted. False for an axis that does not exist.
    pub fn is_reversed(&self, axis: usize) -> bool {
        self.channels
            .get(axis)
            .is_some_and(|channel| channel.reversed)
    }

    /// Program and the position in it.
    pub const fn program(&self) -> (&Program, &Cursor) {
        (&self.program, &self.state.cursor)
    }

    /// Replaces the program and its position, if the machine is idle or parked. Returns false in any other state.
    ///
    /// The program must have been made for this controller's tick rate, mechanism and greatest speed.
    #[inline(never)]
    pub fn load_program(&mut self, program: &Program) -> bool {
        if !matches!(self.supervisor.state(), State::Idle | State::Parked) {
            return false;
        }
        self.program.copy_from(program);
        self.state.cursor = Cursor::new();
        self.check.program_changed();
        true
    }

    /// Moves to a position in the program, in ticks from its start. This acts like a jump of the level: the shaft follows within its
    /// limits.
    pub fn seek(&mut self, elapsed: u64) {
        self.state.cursor.seek(&self.program, elapsed);
    }

    /// Mechanism, which converts between speed and amax.
    pub const fn mechanism(&self) -> &AnyMechanism {
        &self.mechanism
    }

    /// Sets the user's part of an axis's phase offset, rounded to whole steps. Returns false if the limit of the axis cut it, or if the
    /// axis does not exist.
    pub fn set_trim(&mut self, axis: usize, turns: Turns) -> bool {
        self.offsets.set_user(axis, turns)
    }

    /// Records a deadline that was met late, after `missed` deadlines that were not met at all. `over_half` is true if it was late by more
    /// than half a tick.
    ///
    /// While deadlines are missed, the step hardware has nothing to play. All axes stand still, and continue from the same phases. No phase
    /// is lost and none is caught up: the time of the machine lags by as many ticks.
    pub fn late(&mut self, missed: u32, over_half: bool) {
        let limits = &mut self.output.telemetry.limits;
        limits.late_deadlines = limits.late_deadlines.saturating_add(u32::from(over_half));
        if missed == 0 {
            return;
        }
        limits.missed_deadlines = limits.missed_deadlines.saturating_add(missed);
        self.state.history = History::new();
        self.stood(missed);
    }

    /// Records that the last output was handed over `missed` ticks late and is played that much later. As with [`Self::late`], the machine
    /// stands still meanwhile, and its time lags.
    pub const fn held_over(&mut self, missed: u32) {
        let limits = &mut self.output.telemetry.limits;
        limits.missed_deadlines = limits.missed_deadlines.saturating_add(missed);
        self.stood(missed);
    }

    const fn stood(&mut self, missed: u32) {
        self.state.was_late = true;
        if self.state.deadlines.missed(missed) {
            self.state.overrun = Some(Fault::new(FaultKind::Overrun));
        }
    }

    /// Begins in the fault state, for faults that are known before the first tick.
    pub const fn begin_with(&mut self, fault: Fault) {
        self.supervisor.begin_with(fault);
    }

    /// True if work that can wait may be done in this tick: the tick is not busy, or too many busy ones came before.
    const fn has_time(&self) -> bool {
        !self.state.is_busy || self.state.busy_ticks >= MAX_BUSY_TICKS
    }

    /// Phase of the master plus the home offset: the phase at which the cranks are.
    fn crank_phase(&self) -> Phase {
        self.shaft.phase().advanced(self.homing.home_offset())
    }

    /// Phase of the master at which the cranks park, within a turn.
    fn park(&self) -> Turns {
        let park = self.park_crank.wrapping_sub(self.homing.home_offset());
        Phase::from_turns(park).within_turn()
    }
}

#[cfg(test)]
mod tests;
