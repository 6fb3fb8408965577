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

/// Electrical cycles that a stepper may gain at once.
const MOST_GAINED: i64 = 4;

/// What one axis did, as far as its name depends on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct History {
    /// An electrical cycle, turns; zero if it has none.
    cycle: Turns,
    /// What two readings may differ by, of themselves.
    tolerance: Turns,
    /// How many turns in a row it has jumped the same way, and by how much in the last.
    row: u8,
    last: Turns,
}

impl History {
    pub(super) const fn new(cycle: Turns, tolerance: Turns) -> Self {
        Self {
            cycle,
            tolerance,
            row: 0,
            last: Turns::ZERO,
        }
    }

    /// Half of an electrical cycle, turns.
    pub(super) fn half_cycle(&self) -> Turns {
        Turns::from_bits(self.cycle.to_bits() / 2)
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
                || self.row == 2 && self.is_whole_in_two(before.wrapping_add(by))
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

    /// Whether the crank jumped forward in the last turn.
    pub(super) fn is_ahead(&self) -> bool {
        self.row > 0 && self.last > 0
    }

    /// What one jump is called that stands for itself.
    pub(super) fn of_one(&self, by: Turns) -> FaultKind {
        if self.is_whole(by) {
            FaultKind::LostSteps
        } else {
            FaultKind::Slip
        }
    }

    /// The same of two parts of a jump. Of large jumps one in four is whole by chance: what gains more than a few cycles is no stepper
    /// that was pulled on, but one that runs away.
    fn is_whole_in_two(&self, by: Turns) -> bool {
        self.is_whole(by)
            && by.to_bits() <= MOST_GAINED * self.cycle.to_bits() + self.cycle.to_bits() / 2
    }

    /// Whether a jump is one or more whole electrical cycles.
    fn is_whole(&self, by: Turns) -> bool {
        if self.cycle <= 0 {
            return false;
        }
        let cycle = self.cycle.to_bits();
        let by = by.wrapping_abs().to_bits();
        // Half a turn and more has 32 bits so, and a cycle is not below 2⁻¹⁴ turn: how many there are comes out right.
        let units = |turns: i64| (turns >> 17) as u32;
        let cycles = units(by + cycle / 2).checked_div(units(cycle)).unwrap_or(0);
        let off = nearest(Turns::from_bits(by - i64::from(cycles) * cycle));
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
            | FaultKind::IndexTimeout
            | FaultKind::IndexExtra
            | FaultKind::Capture => 0,
            FaultKind::LostSteps | FaultKind::Slip => 1,
            FaultKind::IndexMissing | FaultKind::Stuck | FaultKind::Runaway => 2,
            // At first a crank may seem to stand. One that turns back must not be driven on.
            FaultKind::Reversed => 3,
            _ => 4,
        }
    }
    if let FaultKind::IndexMissing = new {
        return matches!(old, FaultKind::IndexTimeout);
    }
    let (new_rank, old_rank) = (rank(new), rank(old));
    // Of lost steps and slip the later shows.
    let is_other_kind = new_rank == 1 && old_rank == 1 && new as u8 != old as u8;
    new_rank < 4 && (new_rank > old_rank || is_other_kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE_DEG: f64 = 7.2;

    fn deg(deg: f64) -> Turns {
        Turns::from_num(deg / 360.0)
    }

    fn history() -> History {
        History::new(deg(CYCLE_DEG), deg(0.45))
    }

    #[test]
    fn whole_cycles_are_lost_steps_and_nothing_else_is() {
        for cycles in [-20.0, -3.0, -1.0, 1.0, 2.0] {
            for off in [-0.4, 0.0, 0.4] {
                let by = deg(cycles * CYCLE_DEG + off);
                assert_eq!(history().jumped(by), FaultKind::LostSteps, "{by}");
            }
        }
        for off in [-3.6, -2.0, 2.0, 10.0, 30.0] {
            assert_eq!(history().jumped(deg(off)), FaultKind::Slip, "{off}");
        }
        let mut servo = History::new(Turns::ZERO, deg(0.9));
        assert_eq!(servo.jumped(deg(7.2)), FaultKind::Slip);
    }

    /// One jump of many may be whole by chance; the next shows.
    #[test]
    fn what_goes_on_is_no_loss_of_steps_and_what_gains_runs_away() {
        let mut walk = history();
        assert_eq!(walk.jumped(deg(-7.2)), FaultKind::LostSteps);
        assert_eq!(walk.jumped(deg(-9.7)), FaultKind::Slip);
        let mut slips = history();
        assert_eq!(slips.jumped(deg(-7.2)), FaultKind::LostSteps);
        assert_eq!(slips.jumped(deg(-14.4)), FaultKind::LostSteps);
        let mut gains = history();
        gains.jumped(deg(50.0));
        assert_eq!(gains.jumped(deg(83.0)), FaultKind::Runaway);
        let mut in_two = history();
        assert_eq!(in_two.jumped(deg(9.4)), FaultKind::Slip);
        assert_eq!(in_two.jumped(deg(5.0)), FaultKind::LostSteps);
        assert_eq!(in_two.jumped(deg(7.2)), FaultKind::Runaway);
        let mut by_chance = history();
        by_chance.jumped(deg(51.456));
        assert_eq!(by_chance.jumped(deg(107.477)), FaultKind::Runaway);
        gains.rest();
        assert_eq!(gains.jumped(deg(7.2)), FaultKind::LostSteps);
    }

    /// Were a crank that turns back still called stuck, its drive would stay on; were one that swings ahead as it is let go called a
    /// runaway, a stop would end as a coast.
    #[test]
    fn what_turns_back_is_no_longer_stuck_and_what_swings_ahead_is() {
        assert!(is_better(FaultKind::Reversed, FaultKind::Stuck));
        assert!(is_better(FaultKind::Reversed, FaultKind::Tilt));
        assert!(!is_better(FaultKind::Stuck, FaultKind::Reversed));
        assert!(!is_better(FaultKind::Runaway, FaultKind::Stuck));
        assert!(!is_better(FaultKind::Reversed, FaultKind::SwappedWiring));
    }
}
