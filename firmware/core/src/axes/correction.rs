//! Trims of all axes together, against what drives their cranks apart.
//!
//! The sum of these trims is zero at any time, to the count: what all cranks have in common is not corrected, or the machine would
//! walk away from its program. They go to their targets together, each by its share of the way in every tick, none faster than
//! its rate, and no axis further than its limit.

use crate::settings::{Settings, turns_at_most};
use crate::units::{MAX_AXES, PerAxis, Turns};

/// 1, ½, ⅓ … with 16 fraction bits: nothing is divided in a tick.
const SHARES: PerAxis<u32> = [65_536, 32_768, 21_845, 16_384, 13_107, 10_922];

/// The trims of all axes.
#[derive(Clone, Debug)]
pub struct Correction {
    now: PerAxis<Turns>,
    target: PerAxis<Turns>,
    /// What changes in a tick, and for how many more.
    change: PerAxis<Turns>,
    left: u32,
    count: usize,
    limit: PerAxis<Turns>,
    /// The slowest axis's rate, turns a tick.
    rate: u64,
    /// Part of a difference that is corrected at once, 16 fraction bits.
    part: i64,
}

impl Correction {
    /// The trims of no axes.
    pub const fn new() -> Self {
        Self {
            now: [Turns::ZERO; MAX_AXES],
            target: [Turns::ZERO; MAX_AXES],
            change: [Turns::ZERO; MAX_AXES],
            left: 0,
            count: 0,
            limit: [Turns::ZERO; MAX_AXES],
            rate: 1,
            part: 0,
        }
    }

    /// Begins anew, without trims, with settings that have been checked.
    #[cold]
    pub fn configure(&mut self, settings: &Settings) {
        *self = Self::new();
        let hz = f64::from(settings.tick_hz);
        let rates = settings.axes.iter().map(|axis| axis.trim_rate_hz);
        let rate = turns_at_most(rates.fold(f64::INFINITY, f64::min) / hz);
        self.rate = rate.max(1).unsigned_abs();
        for (limit, axis) in self.limit.iter_mut().zip(&settings.axes) {
            *limit = Turns::from_bits(turns_at_most(axis.trim_limit_turns));
        }
        self.count = settings.axes.len();
        self.part = libm::round(settings.correction.part * 65_536.0) as i64;
    }

    /// Whether anything is to be corrected at all.
    pub const fn is_on(&self) -> bool {
        self.part > 0
    }

    /// The trims that are in force.
    pub const fn now(&self) -> &PerAxis<Turns> {
        &self.now
    }

    /// Where the trims are going, or are.
    pub const fn target(&self) -> &PerAxis<Turns> {
        if self.left > 0 {
            &self.target
        } else {
            &self.now
        }
    }

    /// Stays where the trims are.
    pub const fn hold(&mut self) {
        self.left = 0;
    }

    /// Whether trims are on their way.
    pub const fn is_moving(&self) -> bool {
        self.left > 0
    }

    /// Trims that would take away all of the differences between `error`s, what cranks are off with the trims in force; or
    /// the part that is taken away at once. Axes that are not `watched` keep theirs.
    pub fn against(&self, error: &PerAxis<Turns>, watched: u8, all: bool) -> PerAxis<Turns> {
        let mut target = self.now;
        if watched.count_ones() > 1 {
            let mean = self.mean(error, watched);
            take_away(
                &mut target,
                error,
                watched,
                mean,
                (!all).then_some(self.part),
            );
        }
        target
    }

    /// The mean of what some axes are off by, to a part in 10,000; zero of none.
    pub fn mean(&self, error: &PerAxis<Turns>, watched: u8) -> Turns {
        let axes = (watched.count_ones() as usize).wrapping_sub(1);
        let share = SHARES.get(axes).copied();
        Turns::from_bits(sum(error, watched) * i64::from(share.unwrap_or(0)))
    }

    /// The axis, if any, whose limit a target is past.
    pub fn past_limit(&self, target: &PerAxis<Turns>) -> Option<usize> {
        let axes = target.iter().zip(&self.limit);
        axes.enumerate()
            .find(|(_, (target, limit))| target.wrapping_abs() > **limit)
            .map(|(axis, _)| axis)
    }

    /// Goes to `target`, whose sum is that of the trims in force, from where the trims are.
    pub fn go_to(&mut self, target: PerAxis<Turns>) {
        let doublings = share_out(&mut self.change, &self.now, &target, self.count, self.rate);
        self.target = target;
        self.left = 1 << doublings;
    }

    /// What changed in the tick that was played last, if trims were on their way in it.
    pub const fn change(&self) -> &PerAxis<Turns> {
        &self.change
    }

    /// Plays one tick; whether trims change in it.
    pub fn advance(&mut self) -> bool {
        match self.left {
            0 => return false,
            1 => {
                let way = self.target.iter().zip(&self.now);
                for (change, (target, &now)) in self.change.iter_mut().zip(way) {
                    *change = target.wrapping_sub(now);
                }
            }
            _ => {}
        }
        self.left -= 1;
        for (now, &change) in self.now.iter_mut().zip(&self.change) {
            *now = now.wrapping_add(change);
        }
        true
    }
}

/// The sum of what some axes are off by, less 16 fraction bits.
#[inline(never)]
fn sum(error: &[Turns], watched: u8) -> i64 {
    let axes = error.iter().enumerate();
    axes.filter(|(axis, _)| watched & 1 << axis != 0)
        .map(|(_, error)| error.to_bits() >> 16)
        .sum()
}

/// Takes away from trims what some axes are off from the mean, or a part of that. The last of them makes up for the rest, so that their
/// sum stays.
#[inline(never)]
fn take_away(trims: &mut [Turns], error: &[Turns], watched: u8, mean: Turns, part: Option<i64>) {
    let mut rest = Turns::ZERO;
    let mut left = watched;
    for (axis, (trim, &error)) in trims.iter_mut().zip(error).enumerate() {
        let own = 1 << axis;
        if left & own == 0 {
            continue;
        }
        left &= !own;
        let off = mean.wrapping_sub(error);
        let by = match part {
            _ if left == 0 => rest,
            None => off,
            Some(part) => Turns::from_bits((off.to_bits() >> 16) * part),
        };
        *trim = trim.wrapping_add(by);
        rest = rest.wrapping_sub(by);
    }
}

/// What changes in a tick, of the way from trims to where they are to be: the way over a power of two of ticks, so that nothing has
/// to be divided. Which power.
#[inline(never)]
fn share_out(
    change: &mut PerAxis<Turns>,
    now: &PerAxis<Turns>,
    target: &PerAxis<Turns>,
    count: usize,
    rate: u64,
) -> u32 {
    let mut most = 0;
    let way = target.iter().zip(now);
    for (change, (target, &now)) in change.iter_mut().zip(way) {
        *change = target.wrapping_sub(now);
        most = most.max(change.to_bits().unsigned_abs());
    }
    let mut doublings = 0;
    while most > rate {
        most >>= 1;
        doublings += 1;
    }
    // The last axis takes what rounding leaves over, so that the sum is zero.
    let mut rest = Turns::ZERO;
    for (axis, change) in change.iter_mut().enumerate().take(count) {
        if axis + 1 == count {
            *change = rest;
        } else {
            *change = Turns::from_bits(change.to_bits() >> doublings);
            rest = rest.wrapping_sub(*change);
        }
    }
    doublings
}
