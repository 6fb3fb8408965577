//! Turns that were commanded in the last ticks: a log, which only the monitor reads.
//!
//! Most axes make the master's turns, so only the turns of other axes are stored. Past phases are computed from the present one.

use super::modes::AxisSet;
use super::tick_phase::TickPhase;
use crate::units::{MAX_AXES, PerAxis, Phase, Turns};

/// Turns that are commanded in one tick.
#[derive(Clone, Copy, Debug)]
pub struct TickTurns {
    master: Turns,
    /// Axes that make other turns, and their turns.
    own: AxisSet,
    turns: PerAxis<Turns>,
    /// Upper bound on the turns of an axis.
    most: Turns,
}

impl TickTurns {
    const NONE: Self = Self::by_master(Turns::ZERO);

    /// Turns of a tick in which every axis makes the master's.
    #[inline(always)]
    pub const fn by_master(master: Turns) -> Self {
        Self {
            master,
            own: 0,
            turns: [master; MAX_AXES],
            most: master,
        }
    }

    /// Sets the turns of one axis.
    #[inline(always)]
    pub fn set(&mut self, axis: usize, turns: Turns) {
        if let Some(own) = self.turns.get_mut(axis) {
            *own = turns;
            self.own |= 1 << axis;
            self.most = self.most.max(turns);
        }
    }

    /// Turns of an axis.
    #[inline(always)]
    pub fn of(&self, axis: usize) -> Turns {
        if self.own & 1 << axis == 0 {
            self.master
        } else {
            self.turns.get(axis).copied().unwrap_or_default()
        }
    }

    /// Axes that make other turns than the master.
    #[inline(always)]
    pub const fn own(&self) -> AxisSet {
        self.own
    }
}

/// The ticks of a [`History`], the latest first.
#[derive(Clone, Copy, Debug)]
pub struct Recent<'a> {
    planned: &'a TickTurns,
    played: &'a TickTurns,
    before: &'a TickTurns,
}

impl Recent<'_> {
    /// Axes that made other turns than the master in one of the ticks.
    #[inline(always)]
    pub const fn own(&self) -> AxisSet {
        self.planned.own | self.played.own | self.before.own
    }

    /// The same as [`Self::over`], for axes that made the master's turns.
    #[inline(always)]
    pub fn over_by_master(&self, phase: Phase) -> (TickPhase, Turns) {
        let end = phase.advanced(self.planned.master.wrapping_neg());
        let over = TickPhase::ending_at(end, self.played.master);
        (over, self.before.master)
    }

    /// Phase of an axis over the tick that is over, and its turns in the tick before. `phase` is its commanded phase at the end of
    /// the tick that was planned last.
    #[inline(always)]
    pub fn over(&self, axis: usize, phase: Phase) -> (TickPhase, Turns) {
        let end = phase.advanced(self.planned.of(axis).wrapping_neg());
        let over = TickPhase::ending_at(end, self.played.of(axis));
        (over, self.before.of(axis))
    }
}

/// Turns of all axes in three ticks: the one that is being played, the one that is over, and the one before that.
#[derive(Clone, Debug)]
pub struct History {
    ticks: [TickTurns; 3],
    newest: usize,
}

impl History {
    /// History of axes at rest.
    pub const fn new() -> Self {
        Self {
            ticks: [TickTurns::NONE; 3],
            newest: 0,
        }
    }

    /// Adds a planned tick.
    #[inline]
    pub fn push(&mut self, planned: &TickTurns) {
        self.newest = if self.newest == 2 { 0 } else { self.newest + 1 };
        if let Some(logged) = self.ticks.get_mut(self.newest) {
            logged.master = planned.master;
            logged.own = planned.own;
            logged.most = planned.most;
            // Most ticks have none. A copy would take 170 cycles on the board.
            if planned.own != 0 {
                logged.turns = planned.turns;
            }
        }
    }

    /// Phase of an axis over the tick that is over. `phase` is its commanded phase at the end of the tick that was planned last.
    pub fn over(&self, axis: usize, phase: Phase) -> TickPhase {
        self.recent().over(axis, phase).0
    }

    /// The three ticks, the latest first.
    pub fn recent(&self) -> Recent<'_> {
        Recent {
            planned: self.made(0),
            played: self.made(1),
            before: self.made(2),
        }
    }

    /// Upper bound on the turns of an axis in the tick that is over.
    #[inline]
    pub fn most(&self) -> Turns {
        self.made(1).most
    }

    #[inline(always)]
    fn made(&self, ago: usize) -> &TickTurns {
        // A remainder would be slow: the processor has no divide instruction.
        let place = if self.newest < ago {
            self.newest + 3 - ago
        } else {
            self.newest - ago
        };
        let [first, second, third] = &self.ticks;
        match place {
            0 => first,
            1 => second,
            _ => third,
        }
    }
}

impl Default for History {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_ticks_are_known_of_each_axis() {
        let turns = |n: i64| Turns::from_bits(n);
        let mut history = History::new();
        let mut phase = [Phase::ZERO; 2];
        let mut begins = std::vec::Vec::new();
        for tick in 1..20_i64 {
            begins.push(phase);
            let mut planned = TickTurns::by_master(turns(tick));
            let own = if tick % 3 == 0 { tick + 5 } else { tick };
            if tick % 3 == 0 {
                planned.set(1, turns(own));
            }
            history.push(&planned);
            phase = [
                phase[0].advanced(turns(tick)),
                phase[1].advanced(turns(own)),
            ];
            if tick < 3 {
                continue;
            }
            let own = |tick: i64| if tick % 3 == 0 { tick + 5 } else { tick };
            for (axis, made) in [tick - 1, own(tick - 1)].into_iter().enumerate() {
                let over = history.over(axis, phase[axis]);
                assert_eq!(over.turns, turns(made));
                assert_eq!(over.start, begins[tick as usize - 2][axis]);
            }
            let before = |axis| history.recent().over(axis, Phase::ZERO).1;
            assert_eq!(before(0), turns(tick - 2));
            assert_eq!(before(1), turns(own(tick - 2)));
            assert_eq!(history.most(), turns(own(tick - 1)));
        }
    }
}
