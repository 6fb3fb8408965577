//! Phase offsets: slow, bounded shifts of axes against the master, in whole steps.
//!
//! Each axis has one phase offset: the sum of a *user's part* and a *controller's part*. One limit applies to the sum.
//! Offsets are whole steps, so that axes with equal gears keep the same fraction of a step and share their edges.
//!
//! **Motion.** Axes take turns. In its *slot*, an axis moves by whole steps at constant speed, or not at all. A *round* has one slot for
//! each axis. So at most one axis has a motion of its own in any tick. Its speed in the slot is up to the number of axes times its
//! rate; averaged over a round it stays within its rate. All axes of a part reach their targets in the same round. After every
//! round each is at most a slot's steps behind the straight line to its target.
//!
//! **Two moves at once.** An axis moves by the user's part first. After a round in which that part moved, or took the room of the controller's,
//! the controller's part waits with all its axes, so that they stay together on their line. The user's part waits axis by axis: its axes are
//! independent, and two parts that wait as a whole may wait for each other.

mod correction;
mod lane;
mod part;

use core::hash::{Hash, Hasher};

use crate::settings::{Settings, slot_steps, slot_ticks};
use crate::units::{MAX_AXES, ONE_TURN, PerAxis, Turns};
use lane::{Lane, STEP};
use part::Part;

/// Phase offsets of all axes.
#[derive(Clone, Debug)]
pub struct PhaseOffsets {
    lanes: heapless::Vec<Lane, MAX_AXES>,
    slot_ticks: u32,
    slot: Slot,
    user: Part,
    controller: Part,
    /// Controller's part as moved so far, turns.
    now: PerAxis<Turns>,
    /// Fraction of a difference that is corrected at once, 16 fraction bits.
    gain: i64,
}

/// Motion of one axis by its phase offset in one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OffsetMotion {
    /// The axis that moves.
    pub axis: usize,
    /// Its motion in half-steps of 2⁻⁴⁸; their sum over a slot is a whole number of steps, exactly.
    pub half_steps: i64,
    /// Its motion in turns, to 2⁻⁴⁸.
    pub turns: Turns,
}

impl Default for PhaseOffsets {
    fn default() -> Self {
        Self::new()
    }
}

impl PhaseOffsets {
    /// Phase offsets of no axes.
    pub const fn new() -> Self {
        Self {
            lanes: heapless::Vec::new(),
            slot_ticks: 1,
            slot: Slot::IDLE,
            user: Part::NONE,
            controller: Part::NONE,
            now: [Turns::ZERO; MAX_AXES],
            gain: 0,
        }
    }

    /// Resets all offsets and takes over checked settings.
    #[cold]
    pub fn configure(&mut self, settings: &Settings) {
        *self = Self::new();
        let ticks = slot_ticks(settings);
        self.slot_ticks = ticks;
        for axis in &settings.axes {
            let steps = slot_steps(settings, axis, ticks);
            let pushed = self.lanes.push(Lane::new(axis, ticks, steps));
            debug_assert!(pushed.is_ok(), "settings hold no more axes than these");
        }
        self.gain = libm::round(settings.correction.gain * 65_536.0) as i64;
    }

    /// Hashes what no tick changes of all axes.
    #[inline(always)]
    pub(crate) fn hash_common(&self, hasher: &mut impl Hasher) {
        let Self {
            lanes,
            slot_ticks,
            slot: _,
            user: _,
            controller: _,
            now: _,
            gain,
        } = self;
        (lanes.len(), slot_ticks, gain).hash(hasher);
    }

    /// Hashes one of three slices of the constants of an axis. Returns false for the axis after the last.
    #[inline(always)]
    pub(crate) fn hash_axis(&self, axis: usize, slice: usize, hasher: &mut impl Hasher) -> bool {
        // Beyond their capacity there are none, even if their number is wrong.
        match self.lanes.get(axis) {
            Some(lane) if axis < MAX_AXES => {
                lane.hash_slice(slice, hasher);
                true
            }
            _ => false,
        }
    }

    /// Ticks of a slot, in which one axis moves by whole steps: in each tick but the last by an equal part of them, rounded down.
    pub const fn slot_ticks(&self) -> u32 {
        self.slot_ticks
    }

    /// True if the settings request corrections by the controller.
    pub const fn corrects(&self) -> bool {
        self.gain > 0
    }

    /// Controller's part of the offsets as moved so far, turns.
    pub const fn now(&self) -> &PerAxis<Turns> {
        &self.now
    }

    /// Target of the controller's part, turns.
    pub fn target(&self) -> PerAxis<Turns> {
        self.turns_of(&self.controller.target)
    }

    /// Stops the controller's part at its present value.
    pub const fn hold(&mut self) {
        self.controller.hold();
    }

    /// True while the controller's part moves.
    pub const fn is_moving(&self) -> bool {
        self.controller.is_moving
    }

    /// Sets the target of the user's part of an axis, rounded to whole steps. Returns false if the limit of the axis cut it, or
    /// if the axis does not exist.
    pub fn set_user(&mut self, axis: usize, target: Turns) -> bool {
        let other = self.target();
        let (Some(lane), Some(&other)) = (self.lanes.get(axis), other.get(axis)) else {
            return false;
        };
        let cut = lane.limited(target.saturating_add(other)) - other;
        let mut targets = self.user.target;
        if let Some(steps) = targets.get_mut(axis) {
            let controller = self.controller.target.get(axis).copied();
            (*steps, _) = lane.rounded(cut, controller.unwrap_or_default());
        }
        let is_idle = self.is_idle();
        self.user.go_to(&self.lanes, targets);
        self.begin_with_first_axis(is_idle);
        cut == target
    }

    /// Axis, if any, whose offset would exceed its limit with this controller's part, turns.
    pub fn beyond_limit(&self, target: &PerAxis<Turns>) -> Option<usize> {
        let user = self.turns_of(&self.user.target);
        let offsets = target.iter().zip(&user).zip(&self.lanes);
        offsets
            .enumerate()
            .find(|(_, ((target, user), lane))| {
                target.wrapping_add(**user).wrapping_abs() > lane.limit
            })
            .map(|(axis, _)| axis)
    }

    /// Starts a move of the controller's part to `target`, turns, [rounded](Self::rounded) to whole steps.
    pub fn go_to(&mut self, target: &PerAxis<Turns>) {
        self.start(self.rounded(target));
    }

    /// Controller's part in whole steps, for a target in turns. If the targets have the sum zero, the rounded ones have it to half a step.
    #[inline(never)]
    pub fn rounded(&self, target: &PerAxis<Turns>) -> PerAxis<i32> {
        let mut steps = self.controller.target;
        let mut rounding = [0; MAX_AXES];
        let axes = steps.iter_mut().zip(&mut rounding).zip(&self.user.target);
        for (((steps, rounding), &user), (lane, (&target, &now))) in
            axes.zip(self.lanes.iter().zip(target.iter().zip(&self.now)))
        {
            if target != now {
                (*steps, *rounding) = lane.rounded(target, user);
            }
        }
        self.balance(&mut steps, &mut rounding);
        steps
    }

    /// Starts a move of the controller's part to a target in whole steps.
    pub fn start(&mut self, target: PerAxis<i32>) {
        let is_idle = self.is_idle();
        self.controller.go_to(&self.lanes, target);
        self.begin_with_first_axis(is_idle);
    }

    /// Changes offsets by whole steps until the sum of the rounding errors is at most half a step. It begins with those that rounding moved
    /// furthest. Offsets in other steps than those of the first axis do not change.
    #[inline(never)]
    fn balance(&self, steps: &mut PerAxis<i32>, rounding: &mut PerAxis<i64>) {
        let steps_per_turn = self.lanes.first().map(|lane| lane.steps_per_turn);
        for (rounding, lane) in rounding.iter_mut().zip(&self.lanes) {
            if Some(lane.steps_per_turn) != steps_per_turn {
                *rounding = 0;
            }
        }
        let mut sum: i64 = rounding.iter().sum();
        for _ in 0..self.lanes.len() {
            if sum.abs() <= ONE_TURN / 2 {
                return;
            }
            let (by, sign) = if sum > 0 { (-1, 1) } else { (1, -1) };
            let mut furthest: Option<(usize, i64)> = None;
            for (axis, (lane, &rounding)) in self.lanes.iter().zip(&*rounding).enumerate() {
                let parts = steps.get(axis).zip(self.user.target.get(axis));
                let offset = parts.map_or(0, |(steps, user)| steps + user + by);
                let moved = rounding * sign;
                if moved > furthest.map_or(0, |(_, moved)| moved)
                    && offset.abs() <= lane.limit_steps
                {
                    furthest = Some((axis, moved));
                }
            }
            let Some((axis, _)) = furthest else {
                return;
            };
            sum -= sign * ONE_TURN;
            if let (Some(steps), Some(rounding)) = (steps.get_mut(axis), rounding.get_mut(axis)) {
                *steps += by;
                *rounding -= sign * ONE_TURN;
            }
        }
    }

    const fn is_idle(&self) -> bool {
        !self.user.is_moving && !self.controller.is_moving
    }

    /// Lets a move begin with the first axis, unless another is under way.
    fn begin_with_first_axis(&mut self, was_idle: bool) {
        if was_idle && self.slot.ticks == 0 {
            self.slot.axis = self.lanes.len();
        }
    }

    /// Axis that is within its slot and has moved by a fraction of a step.
    pub const fn displaced(&self) -> Option<usize> {
        if self.slot.ticks != 0 && self.slot.half_steps != 0 {
            Some(self.slot.axis)
        } else {
            None
        }
    }

    /// Advances by one tick; returns the motion of the axis that moves in it, if one does. An axis begins its slot only if it `may_begin`,
    /// because such a tick takes longer than the others.
    #[inline]
    pub fn advance(&mut self, may_begin: bool) -> Option<OffsetMotion> {
        if self.slot.ticks == 0 && (self.is_idle() || !may_begin || !self.begin_slot()) {
            return None;
        }
        self.slot.ticks -= 1;
        if self.slot.half_steps == 0 {
            return None;
        }
        Some(self.move_axis())
    }

    #[inline(never)]
    fn move_axis(&mut self) -> OffsetMotion {
        let slot = &mut self.slot;
        let (half_steps, turns) = if slot.ticks == 0 {
            (slot.half_steps, slot.turns)
        } else {
            (slot.half_steps_per_tick, slot.turns_per_tick)
        };
        slot.half_steps -= half_steps;
        slot.turns = slot.turns.wrapping_sub(turns);
        let now = self.now.get_mut(slot.axis).filter(|_| slot.by_controller);
        if let Some(now) = now {
            *now = now.wrapping_add(turns);
        }
        OffsetMotion {
            axis: slot.axis,
            half_steps,
            turns,
        }
    }

    /// Begins the slot of the next axis. Returns false once no axis has to move.
    #[inline(never)]
    fn begin_slot(&mut self) -> bool {
        self.slot.axis += 1;
        if self.slot.axis >= self.lanes.len() {
            self.slot.axis = 0;
            self.user.begin_round();
            if !core::mem::take(&mut self.controller.waits) {
                self.controller.begin_round();
            }
            if self.is_idle() {
                return false;
            }
        }
        let axis = self.slot.axis;
        self.slot.ticks = self.slot_ticks;
        self.slot.half_steps = 0;
        let Some(lane) = self.lanes.get(axis) else {
            return true;
        };
        // A part whose move would exceed the limit waits for the other part.
        let at = |part: &Part| part.now.get(axis).copied().unwrap_or_default();
        let offset = at(&self.user) + at(&self.controller);
        let by_user = self.user.take(axis, lane, offset);
        self.slot.by_controller = by_user.is_none();
        self.controller.waits |= by_user.is_some();
        if let Some((from, steps)) = by_user.or_else(|| self.controller.take(axis, lane, offset)) {
            let sign = i64::from(steps);
            self.slot.half_steps = sign * STEP;
            self.slot.half_steps_per_tick = sign * lane.half_steps_per_tick;
            self.slot.turns = lane
                .turns_of(from + steps)
                .wrapping_sub(lane.turns_of(from));
            self.slot.turns_per_tick = Turns::from_bits(sign * lane.turns_per_tick);
        }
        true
    }

    fn turns_of(&self, steps: &PerAxis<i32>) -> PerAxis<Turns> {
        let mut turns = [Turns::ZERO; MAX_AXES];
        for (turns, (lane, &steps)) in turns.iter_mut().zip(self.lanes.iter().zip(steps)) {
            *turns = lane.turns_of(steps);
        }
        turns
    }
}

/// Ticks of motion of one axis.
#[derive(Clone, Debug)]
struct Slot {
    axis: usize,
    /// Remaining ticks.
    ticks: u32,
    /// Remaining motion, in half-steps of 2⁻⁴⁸ and in turns, each with the motion in one tick.
    half_steps: i64,
    half_steps_per_tick: i64,
    turns: Turns,
    turns_per_tick: Turns,
    by_controller: bool,
}

impl Slot {
    const IDLE: Self = Self {
        axis: 0,
        ticks: 0,
        half_steps: 0,
        half_steps_per_tick: 0,
        turns: Turns::ZERO,
        turns_per_tick: Turns::ZERO,
        by_controller: false,
    };
}

#[cfg(test)]
mod tests;
