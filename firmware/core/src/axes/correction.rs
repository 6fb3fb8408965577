//! Trims of all axes together, against what drives their cranks apart.
//!
//! The sum of these trims is zero at any time, to the count: what all cranks have in common is not corrected, or the machine would
//! walk away from its program. They go to their targets together, each by its share of the way in every tick, none faster than
//! its rate, and no axis further than its limit.

use crate::settings::{Settings, turns_at_most};
use crate::units::Turns;

/// The trims of `N` axes.
#[derive(Clone, Debug)]
pub struct Correction<const N: usize> {
    now: [Turns; N],
    target: [Turns; N],
    /// What changes in a tick, and for how many more.
    change: [Turns; N],
    left: u32,
    limit: [Turns; N],
    /// The slowest axis's rate, turns a tick.
    rate: u64,
    /// Part of a difference that is corrected at once, 16 fraction bits.
    part: i64,
}

impl<const N: usize> Correction<N> {
    /// Of settings that have been checked; nothing is trimmed yet.
    pub fn new(settings: &Settings<N>) -> Self {
        let hz = f64::from(settings.tick_hz);
        let rates = settings
            .axes
            .iter()
            .map(|axis| turns_at_most(axis.trim_rate_hz / hz));
        Self {
            now: [Turns::ZERO; N],
            target: [Turns::ZERO; N],
            change: [Turns::ZERO; N],
            left: 0,
            limit: core::array::from_fn(|axis| {
                Turns::from_bits(turns_at_most(settings.axes[axis].trim_limit_turns))
            }),
            rate: rates.min().unwrap_or(0).max(1).unsigned_abs(),
            part: libm::round(settings.correction.part * 65_536.0) as i64,
        }
    }

    /// Whether anything is to be corrected at all.
    pub const fn is_on(&self) -> bool {
        self.part > 0
    }

    /// The trims that are in force.
    pub const fn now(&self) -> &[Turns; N] {
        &self.now
    }

    /// Whether trims are on their way.
    pub const fn is_moving(&self) -> bool {
        self.left > 0
    }

    /// Trims that would take away all of the differences between `error`s, what cranks are off with the trims in force; or
    /// the part that is taken away at once. Axes that are not `watched` keep theirs.
    pub fn against(&self, error: &[Turns; N], watched: u8, all: bool) -> [Turns; N] {
        let mut target = self.now;
        let is_watched = |axis: usize| watched & 1 << axis != 0;
        let axes = || (0..N).filter(|&axis| is_watched(axis));
        let count = axes().count();
        let Some(last) = axes().next_back().filter(|_| count > 1) else {
            return target;
        };
        // 1/count with 16 fraction bits: what that is off, the last axis makes up for below.
        let share = 65_536 / count as i64;
        let sum: i64 = axes().map(|axis| error[axis].to_bits() >> 16).sum();
        let mean = sum * share;
        let mut rest = Turns::ZERO;
        for axis in axes().filter(|&axis| axis != last) {
            let off = mean - error[axis].to_bits();
            let by = Turns::from_bits(if all { off } else { (off >> 16) * self.part });
            target[axis] = target[axis].wrapping_add(by);
            rest = rest.wrapping_sub(by);
        }
        target[last] = target[last].wrapping_add(rest);
        target
    }

    /// The axis, if any, whose limit a target is past.
    pub fn past_limit(&self, target: &[Turns; N]) -> Option<usize> {
        let axes = target.iter().zip(&self.limit);
        axes.enumerate()
            .find(|(_, (target, limit))| target.wrapping_abs() > **limit)
            .map(|(axis, _)| axis)
    }

    /// Goes to `target`, whose sum is that of the trims in force, from where the trims are.
    pub fn go_to(&mut self, target: [Turns; N]) {
        let way = |axis: usize| target[axis].wrapping_sub(self.now[axis]);
        let most = (0..N).map(|axis| way(axis).to_bits().unsigned_abs()).max();
        // A power of two of ticks, so that nothing has to be divided.
        let mut doublings = 0;
        while most.unwrap_or(0) >> doublings > self.rate {
            doublings += 1;
        }
        let mut rest = Turns::ZERO;
        for axis in 0..N - 1 {
            self.change[axis] = Turns::from_bits(way(axis).to_bits() >> doublings);
            rest = rest.wrapping_sub(self.change[axis]);
        }
        self.change[N - 1] = rest;
        self.target = target;
        self.left = 1 << doublings;
    }

    /// Plays one tick; what changes in it.
    pub fn advance(&mut self) -> Option<&[Turns; N]> {
        match self.left {
            0 => return None,
            1 => {
                for axis in 0..N {
                    self.change[axis] = self.target[axis].wrapping_sub(self.now[axis]);
                }
            }
            _ => {}
        }
        self.left -= 1;
        for (now, &change) in self.now.iter_mut().zip(&self.change) {
            *now = now.wrapping_add(change);
        }
        Some(&self.change)
    }
}
