//! What a crank that has moved is called.
//!
//! - A jump by whole electrical cycles of a stepper: *lost steps*.
//! - Any other jump, and a walk that goes on: *slip*.
//! - Jumps ahead, turn after turn: it *runs away*.
//!
//! Evidence comes in turn by turn, and a better name may replace a worse one while the machine is being stopped: at first
//! a crank may only be overdue, or the platform tilted.

use crate::supervisor::FaultKind;
use crate::units::{Turns, nearest};

/// What one axis did, as far as its name depends on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Story {
    /// An electrical cycle, turns; zero if it has none.
    cycle: Turns,
    /// What two readings may differ by, of themselves.
    tolerance: Turns,
    /// How many turns in a row it has jumped the same way, and by how much in the last.
    row: u8,
    last: Turns,
}

impl Story {
    pub(super) const fn new(cycle: Turns, tolerance: Turns) -> Self {
        Self {
            cycle,
            tolerance,
            row: 0,
            last: Turns::ZERO,
        }
    }

    /// A turn without a jump.
    pub(super) const fn rest(&mut self) {
        self.row = 0;
    }

    /// The crank jumped, forward if `by` is positive.
    pub(super) fn jumped(&mut self, by: Turns) -> FaultKind {
        let before = core::mem::replace(&mut self.last, by);
        let goes_on = self.row > 0 && (before < 0) == (by < 0);
        self.row = if goes_on {
            self.row.saturating_add(1)
        } else {
            1
        };
        let whole = if goes_on {
            // A crank that passes its index while it jumps shows part of it then, and the rest a turn later.
            self.is_whole(by) && self.is_whole(before)
                || self.row == 2 && self.is_whole(before.wrapping_add(by))
        } else {
            self.is_whole(by)
        };
        // What runs away gains more in its second turn than in what was left of the first.
        let gains = goes_on && by > 0 && (by > before || self.row > 2);
        if gains {
            FaultKind::Runaway
        } else if whole {
            FaultKind::LostSteps
        } else {
            FaultKind::Slip
        }
    }

    /// What one jump is called that stands for itself.
    pub(super) fn of_one(&self, by: Turns) -> FaultKind {
        if self.is_whole(by) {
            FaultKind::LostSteps
        } else {
            FaultKind::Slip
        }
    }

    /// Whether a jump is one or more whole electrical cycles.
    fn is_whole(&self, by: Turns) -> bool {
        if self.cycle <= 0 {
            return false;
        }
        let cycle = self.cycle.to_bits();
        let cycles = (by.to_bits().abs() + cycle / 2) / cycle;
        let off = nearest(Turns::from_bits(by.to_bits().abs() - cycles * cycle));
        cycles > 0 && off.abs() <= self.tolerance
    }
}

/// Whether `new` says more than `old`, of the same axis in the same stop.
pub(crate) fn is_better(new: FaultKind, old: FaultKind) -> bool {
    const fn rank(kind: FaultKind) -> u8 {
        match kind {
            FaultKind::Tilt
            | FaultKind::Warp
            | FaultKind::CommonLag
            | FaultKind::Silent
            | FaultKind::IndexExtra => 0,
            FaultKind::LostSteps | FaultKind::Slip => 1,
            FaultKind::IndexMissing
            | FaultKind::Stuck
            | FaultKind::Reversed
            | FaultKind::Runaway => 2,
            _ => 3,
        }
    }
    let (new_rank, old_rank) = (rank(new), rank(old));
    // Of lost steps and slip the later tells.
    let told_apart = new_rank == 1 && old_rank == 1 && new as u8 != old as u8;
    new_rank < 3 && (new_rank > old_rank || told_apart)
}

/// What all of `values` have in common when few of them differ: the middle one; of two middle ones the smaller, so that of two
/// axes the one counts as moved that moved more. The first `count` count, at least one.
pub(super) fn in_common<const N: usize>(values: &[Turns; N], count: usize) -> Turns {
    let mut sorted = *values;
    let count = count.clamp(1, N);
    let (counted, _) = sorted.split_at_mut(count);
    counted.sort_unstable();
    let (low, high) = (counted.get((count - 1) / 2), counted.get(count / 2));
    match (low, high) {
        (Some(&low), Some(&high)) if high.abs() < low.abs() => high,
        (Some(&low), _) => low,
        _ => Turns::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE_DEG: f64 = 7.2;

    fn deg(deg: f64) -> Turns {
        Turns::from_num(deg / 360.0)
    }

    fn story() -> Story {
        Story::new(deg(CYCLE_DEG), deg(0.45))
    }

    #[test]
    fn whole_cycles_are_lost_steps_and_nothing_else_is() {
        for cycles in [-20.0, -3.0, -1.0, 1.0, 2.0] {
            for off in [-0.4, 0.0, 0.4] {
                let by = deg(cycles * CYCLE_DEG + off);
                assert_eq!(story().jumped(by), FaultKind::LostSteps, "{by}");
            }
        }
        for off in [-3.6, -2.0, 2.0, 10.0, 30.0] {
            assert_eq!(story().jumped(deg(off)), FaultKind::Slip, "{off}");
        }
        let mut servo = Story::new(Turns::ZERO, deg(0.9));
        assert_eq!(servo.jumped(deg(7.2)), FaultKind::Slip);
    }

    /// One jump of many may be whole by chance; the next tells.
    #[test]
    fn what_goes_on_is_no_loss_of_steps_and_what_gains_runs_away() {
        let mut walk = story();
        assert_eq!(walk.jumped(deg(-7.2)), FaultKind::LostSteps);
        assert_eq!(walk.jumped(deg(-9.7)), FaultKind::Slip);
        let mut slips = story();
        assert_eq!(slips.jumped(deg(-7.2)), FaultKind::LostSteps);
        assert_eq!(slips.jumped(deg(-14.4)), FaultKind::LostSteps);
        let mut gains = story();
        gains.jumped(deg(50.0));
        assert_eq!(gains.jumped(deg(83.0)), FaultKind::Runaway);
        let mut in_two = story();
        assert_eq!(in_two.jumped(deg(9.4)), FaultKind::Slip);
        assert_eq!(in_two.jumped(deg(5.0)), FaultKind::LostSteps);
        assert_eq!(in_two.jumped(deg(7.2)), FaultKind::Runaway);
        gains.rest();
        assert_eq!(gains.jumped(deg(7.2)), FaultKind::LostSteps);
    }

    #[test]
    fn what_all_do_is_no_ones_own() {
        let all = |turns: &[f64; 4], count| in_common(&turns.map(deg), count);
        assert_eq!(all(&[-3.0, -3.0, -10.0, -3.0], 4), deg(-3.0));
        assert_eq!(all(&[0.0, -7.2, 9.0, 9.0], 2), deg(0.0));
        assert_eq!(all(&[7.2, 0.0, 9.0, 9.0], 2), deg(0.0));
        assert_eq!(all(&[5.0, 9.0, 9.0, 9.0], 1), deg(5.0));
    }
}
