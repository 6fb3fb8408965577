//! Edges from samples: the runs that the loop planned are planned again.
//!
//! The runs of a tick depend on the turns of the axis in it and on its place within a step. So the core's planner can plan them again
//! from samples of consecutive ticks. Nothing must have moved since power-up before the first of these ticks. A phase
//! offset moves by whole steps in a *slot*. Its turns are rounded and its half-steps are not, so the half-steps of each tick of a slot
//! are derived from the turns, as the core divides them.
//!
//! The resulting whole steps are compared with those of each sample. If they differ, no edges are written.

use cophase_core::axes::{AnyFollower, Cams, Follower};
use cophase_core::phase_offset::PhaseOffsets;
use cophase_core::pulse::{Planner, PulseTiming, Runs, StepRates, StepsPerTurn};
use cophase_core::settings::Settings;
use cophase_core::units::{ONE_TURN, Turns};
use cophase_link::sample::{Sample, flags};

use super::played_ns;
use crate::trace::TickEdges;

/// One step, in half-steps of 2⁻⁴⁸.
const STEP: i64 = 2 * ONE_TURN;

/// Reason why a recording has no edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "each variant's message says what it means")]
pub enum NoEdges {
    #[error("nothing was recorded")]
    Nothing,
    #[error("not every tick was recorded; record with --every 1")]
    NotEveryTick,
    #[error("a channel is missing; record with the channels state, phase, lead and steps")]
    Channels,
    #[error("samples were lost")]
    Lost,
    #[error(
        "the machine had moved since power-up when the recording began; restart the controller, and record from then on"
    )]
    HadMoved,
    #[error("deadlines were missed, and all axes stood still for a tick")]
    Missed,
    #[error("the steps that were derived are not those of the controller")]
    Differ,
}

/// Planners of all axes, which take samples.
pub struct Derivation {
    axes: Vec<Axis>,
    cams: Cams,
    rates: StepRates,
    slot_ticks: u32,
    tick_cycles: u32,
    tick_ns: u64,
    reversed: Vec<bool>,
    last: Option<Sample>,
    /// Runs of the last sample. They are kept until the next sample, because only that one has the level of the enable output.
    planned: Vec<Runs>,
    moves: bool,
    /// Runs that are returned.
    passed: Vec<Runs>,
}

struct Axis {
    planner: Planner,
    follower: AnyFollower,
    takes_pulses: bool,
    steps_per_turn: StepsPerTurn,
    steps: i64,
    slot: Slot,
}

/// Slot in which the phase offset of an axis moves.
#[derive(Clone, Copy, Default)]
struct Slot {
    /// Ticks in which it has moved.
    ticks: u32,
    steps: i64,
    half_steps: i64,
}

impl Derivation {
    pub(super) fn new(settings: &Settings) -> Result<Self, NoEdges> {
        let timing = PulseTiming::new(&settings.pulse, settings.clock_hz, settings.tick_hz)
            .map_err(|_| NoEdges::Differ)?;
        let cams = settings.curves();
        let mut offsets = PhaseOffsets::new();
        offsets.configure(settings);
        let axis = |axis: &cophase_core::settings::AxisSettings| Axis {
            planner: Planner::new(timing, axis.steps_per_crank_turn()),
            follower: axis.follower.follower(&cams),
            takes_pulses: axis.drive.takes_pulses(),
            steps_per_turn: axis.steps_per_crank_turn(),
            steps: 0,
            slot: Slot::default(),
        };
        Ok(Self {
            axes: settings.axes.iter().map(axis).collect(),
            cams: settings.curves(),
            rates: StepRates::new(timing.tick()),
            slot_ticks: offsets.slot_ticks(),
            tick_cycles: timing.tick(),
            tick_ns: 1_000_000_000 / u64::from(settings.tick_hz),
            reversed: settings.axes.iter().map(|axis| axis.reversed).collect(),
            last: None,
            planned: vec![Runs::new(); settings.axes.len()],
            moves: false,
            passed: vec![Runs::new(); settings.axes.len()],
        })
    }

    /// Takes the sample of the next tick. Returns the edges of the tick before, if there was one.
    pub(super) fn push(&mut self, sample: &Sample) -> Result<Option<TickEdges<'_>>, NoEdges> {
        let before = self.last.replace(*sample);
        let moved = self.moves;
        std::mem::swap(&mut self.planned, &mut self.passed);
        let Some(before) = before else {
            let count = self.axes.len();
            if sample.phase != 0 || sample.steps[..count].iter().any(|&steps| steps != 0) {
                return Err(NoEdges::HadMoved);
            }
            self.plan(sample, sample)?;
            return Ok(None);
        };
        self.plan(&before, sample)?;
        Ok(Some(self.edges(&before, moved, sample.flags)))
    }

    /// Edges of the last tick.
    pub(super) fn last(&mut self) -> Option<TickEdges<'_>> {
        let last = self.last?;
        std::mem::swap(&mut self.planned, &mut self.passed);
        Some(self.edges(&last, self.moves, last.flags))
    }

    fn edges(&self, sample: &Sample, moves: bool, next_flags: u8) -> TickEdges<'_> {
        let start_ns = played_ns(sample.tick, self.tick_ns);
        TickEdges {
            start_ns,
            end_ns: start_ns + self.tick_ns,
            tick_cycles: self.tick_cycles,
            moves,
            runs: self.passed.iter().collect(),
            reversed: &self.reversed,
            enable: next_flags & flags::DRIVES != 0,
            sensed: None,
        }
    }

    /// Plans the tick of a sample.
    fn plan(&mut self, before: &Sample, sample: &Sample) -> Result<(), NoEdges> {
        let master = Turns::from_bits(sample.phase.wrapping_sub(before.phase));
        self.moves = master != Turns::ZERO;
        for (i, (axis, runs)) in self.axes.iter_mut().zip(&mut self.planned).enumerate() {
            let lead = Turns::from_bits(sample.lead[i].wrapping_sub(before.lead[i]));
            let all = master.wrapping_add(lead);
            let turns = if axis.follower.is_direct() {
                master
            } else {
                axis.follower.advance(master, &self.cams)
            };
            let half_steps = axis.slot.advance(
                all.wrapping_sub(turns).to_bits(),
                axis.steps_per_turn,
                self.slot_ticks,
            )?;
            axis.steps += i64::from(if axis.takes_pulses {
                axis.planner.plan(turns, half_steps, &mut self.rates, runs)
            } else {
                axis.planner.count(turns, half_steps, &mut self.rates, runs)
            });
            if axis.steps != sample.steps[i] {
                return Err(NoEdges::Differ);
            }
        }
        Ok(())
    }
}

impl Slot {
    /// Half-steps of 2⁻⁴⁸ of a tick in which the offset moves by `turns`, in 2⁻⁴⁸.
    ///
    /// In each tick of a slot but the last, the offset moves by an equal part of the slot's whole steps. Half-steps and turns are
    /// rounded down. The last tick has the remainder.
    fn advance(
        &mut self,
        turns: i64,
        steps_per_turn: StepsPerTurn,
        slot_ticks: u32,
    ) -> Result<i64, NoEdges> {
        if turns == 0 {
            return Ok(0);
        }
        let ticks = i64::from(slot_ticks);
        if self.ticks == 0 {
            self.half_steps = 0;
            let step = steps_per_turn.step_turns().0 / ticks;
            self.steps = if slot_ticks == 1 {
                (turns + step / 2 * turns.signum()) / step
            } else if turns % step == 0 {
                turns / step
            } else {
                return Err(NoEdges::Differ);
            };
        }
        self.ticks += 1;
        let half_steps = if self.ticks < slot_ticks {
            self.steps * (STEP / ticks)
        } else {
            self.ticks = 0;
            self.steps * STEP - self.half_steps
        };
        self.half_steps += half_steps;
        Ok(half_steps)
    }
}
