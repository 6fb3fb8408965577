//! One part of the phase offsets of all axes, and its move to a target.

use super::lane::Lane;
use crate::functions::{Divisor, multiply_long};
use crate::units::{MAX_AXES, PerAxis};

/// One part of the offsets of all axes, and its move. Steps.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Offsets, including the steps of the present slot.
    pub(super) now: PerAxis<i32>,
    pub(super) target: PerAxis<i32>,
    /// Length of the move, its remaining rounds, and the divisor for all of its rounds.
    pub(super) length: PerAxis<i32>,
    pub(super) rounds_left: u32,
    pub(super) per_round: Option<Divisor>,
    pub(super) is_moving: bool,
    /// In this round the user's part moved, or an axis had no room within its limit. Only the controller's part then waits.
    pub(super) waits: bool,
}

impl Part {
    pub(super) const NONE: Self = Self {
        now: [0; MAX_AXES],
        target: [0; MAX_AXES],
        length: [0; MAX_AXES],
        rounds_left: 0,
        per_round: None,
        is_moving: false,
        waits: false,
    };

    pub(super) const fn hold(&mut self) {
        self.target = self.now;
        self.length = [0; MAX_AXES];
        self.rounds_left = 0;
        self.is_moving = false;
    }

    #[inline(never)]
    pub(super) fn go_to(&mut self, lanes: &[Lane], target: PerAxis<i32>) {
        self.target = target;
        let mut rounds = 0;
        let axes = self
            .length
            .iter_mut()
            .zip(self.target.iter().zip(&self.now));
        for ((length, (target, now)), lane) in axes.zip(lanes) {
            *length = target - now;
            let steps = length.unsigned_abs();
            let own = match lane.slot_steps {
                1 => steps,
                max => lane.per_slot.divide(u64::from(steps + max - 1)).0 as u32,
            };
            rounds = rounds.max(own);
        }
        self.rounds_left = rounds;
        self.per_round = Some(Divisor::new(rounds));
        self.is_moving = rounds > 0;
    }

    pub(super) fn begin_round(&mut self) {
        if self.rounds_left > 0 {
            self.rounds_left -= 1;
        } else if self.is_moving {
            let mut axes = self.now.iter().zip(&self.target);
            self.is_moving = axes.any(|(now, target)| now != target);
        }
    }

    /// Takes the steps of an axis in its slot. Returns this part of its offset before them, and the steps; none if the axis does not move.
    pub(super) fn take(&mut self, axis: usize, lane: &Lane, offset: i32) -> Option<(i32, i32)> {
        let now = self.now.get_mut(axis)?;
        let (&target, &length) = (self.target.get(axis)?, self.length.get(axis)?);
        if !self.is_moving || *now == target {
            return None;
        }
        let ahead = multiply_long(u64::from(length.unsigned_abs()), self.rounds_left);
        let ahead = self.per_round?.divide(ahead).0 as i32;
        let aim = if length < 0 {
            target + ahead
        } else {
            target - ahead
        };
        let max = lane.slot_steps as i32;
        let steps = (aim - *now).max(-max).min(max); // `clamp` may panic
        if steps == 0 {
            return None;
        }
        if (offset + steps).abs() > lane.limit_steps.max(offset.abs()) {
            self.waits = true;
            return None;
        }
        let from = *now;
        *now += steps;
        Some((from, steps))
    }
}
