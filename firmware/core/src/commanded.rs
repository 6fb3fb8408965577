//! Commanded phases: of an axis over one tick, and of all axes in the last ticks.
//!
//! Most axes make the master's turns, so only the turns of other axes are stored. Past phases are computed from the present one.

use crate::functions::{multiply_high, multiply_long};
use crate::units::{AxisSet, MAX_AXES, PerAxis, Phase, Turns};

/// Phase of an axis over one tick, at constant speed.
#[derive(Clone, Copy, Debug, Default)]
pub struct TickPhase {
    /// Phase at the tick's beginning.
    pub start: Phase,
    /// Turns in the tick.
    pub turns: Turns,
}

/// A tick has at most 18 bits of cycles.
const CYCLE_SPARE_BITS: u32 = 14;

/// Length of a tick.
#[derive(Clone, Copy, Debug, Hash)]
pub(crate) struct TickClock {
    pub(crate) cycles: u32,
    /// 2⁴² / cycles.
    per_cycle: u32,
}

impl TickClock {
    /// Clock of a tick of `cycles`, at least 2048.
    pub(crate) const fn new(cycles: u32) -> Self {
        Self {
            cycles,
            per_cycle: ((1 << (24 + 32 - CYCLE_SPARE_BITS)) / cycles as u64) as u32, // at most 2³¹
        }
    }
}

impl TickPhase {
    /// A tick in which nothing moves.
    pub const fn still(phase: Phase) -> Self {
        Self {
            start: phase,
            turns: Turns::ZERO,
        }
    }

    /// A tick of `turns` that ends at this phase.
    pub(crate) const fn ending_at(end: Phase, turns: Turns) -> Self {
        Self {
            start: end.advanced(turns.wrapping_neg()),
            turns,
        }
    }

    /// Phase at the tick's end.
    pub(crate) const fn end(&self) -> Phase {
        self.start.advanced(self.turns)
    }

    /// Phase `cycle` cycles into a tick.
    pub(crate) fn at(&self, cycle: u32, clock: TickClock) -> Phase {
        // cycle / tick_cycles with 24 fraction bits; and of the turns of a tick, below ½, the upper 40: 2⁻²⁴ of a tick
        // is less than a cycle.
        let part = multiply_high(cycle << CYCLE_SPARE_BITS, clock.per_cycle).min(1 << 24);
        let travel = self.turns.to_bits().unsigned_abs() >> 8;
        let travel = (multiply_long(travel, part) >> 16) as i64;
        self.start.advanced(Turns::from_bits(if self.turns < 0 {
            -travel
        } else {
            travel
        }))
    }
}

/// Turns that are commanded in one tick.
#[derive(Clone, Copy, Debug)]
pub struct TickTurns {
    master: Turns,
    /// Axes that make other turns, and their turns.
    own: AxisSet,
    turns: PerAxis<Turns>,
    /// Upper bound on the turns of an axis.
    max: Turns,
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
            max: master,
        }
    }

    /// Sets the turns of one axis.
    #[inline(always)]
    pub fn set(&mut self, axis: usize, turns: Turns) {
        if let Some(own) = self.turns.get_mut(axis) {
            *own = turns;
            self.own |= 1 << axis;
            self.max = self.max.max(turns);
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

/// The ticks of a [`History`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recent<'a> {
    planned: &'a TickTurns,
    over: &'a TickTurns,
    before: &'a TickTurns,
}

impl Recent<'_> {
    /// Phase of an axis over the tick that is over. `phase` is its commanded phase at the end of the tick that was planned last.
    #[inline(always)]
    pub fn over(&self, axis: usize, phase: Phase) -> TickPhase {
        TickPhase::ending_at(self.end(axis, phase), self.over.of(axis))
    }

    /// The same phase at the end of that tick.
    #[inline(always)]
    pub fn end(&self, axis: usize, phase: Phase) -> Phase {
        phase.advanced(self.planned.of(axis).wrapping_neg())
    }

    /// Turns of an axis in the tick before.
    #[inline(always)]
    pub fn before(&self, axis: usize) -> Turns {
        self.before.of(axis)
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
            logged.max = planned.max;
            // Most ticks have none. A copy would take 170 cycles on the board.
            if planned.own != 0 {
                logged.turns = planned.turns;
            }
        }
    }

    /// The three ticks.
    pub(crate) fn recent(&self) -> Recent<'_> {
        Recent {
            planned: self.made(0),
            over: self.made(1),
            before: self.made(2),
        }
    }

    /// Upper bound on the turns of an axis in the tick that is over.
    #[inline]
    pub fn max(&self) -> Turns {
        self.made(1).max
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
                let over = history.recent().over(axis, phase[axis]);
                assert_eq!(over.turns, turns(made));
                assert_eq!(over.start, begins[tick as usize - 2][axis]);
            }
            let before = |axis| history.recent().before(axis);
            assert_eq!(before(0), turns(tick - 2));
            assert_eq!(before(1), turns(own(tick - 2)));
            assert_eq!(history.max(), turns(own(tick - 1)));
        }
    }
}
