//! Correction: trims of all axes together, against differences between their cranks.
//!
//! The sum of these trims is always exactly zero. The common error of all cranks is not corrected, or the machine would
//! move away from its program. All trims go to their targets together, each by its share in every tick. None is faster
//! than its rate, and no axis exceeds its limit.

use crate::settings::{Settings, turns_at_most};
use crate::units::{MAX_AXES, PerAxis, Turns};

/// Reciprocals 1, ½, ⅓ … with 16 fraction bits, so that a tick needs no division.
const SHARES: PerAxis<u32> = [65_536, 32_768, 21_845, 16_384, 13_107, 10_922];

/// Trims of all axes.
#[derive(Clone, Debug)]
pub struct Correction {
    now: PerAxis<Turns>,
    target: PerAxis<Turns>,
    /// Change in a tick, and the number of remaining ticks.
    change: PerAxis<Turns>,
    left: u32,
    count: usize,
    limit: PerAxis<Turns>,
    /// Rate of the slowest axis, turns a tick.
    rate: u64,
    /// Fraction of a difference that is corrected at once, 16 fraction bits.
    gain: i64,
}

impl Default for Correction {
    fn default() -> Self {
        Self::new()
    }
}

impl Correction {
    /// Correction without axes.
    pub const fn new() -> Self {
        Self {
            now: [Turns::ZERO; MAX_AXES],
            target: [Turns::ZERO; MAX_AXES],
            change: [Turns::ZERO; MAX_AXES],
            left: 0,
            count: 0,
            limit: [Turns::ZERO; MAX_AXES],
            rate: 1,
            gain: 0,
        }
    }

    /// Resets all trims and takes over checked settings.
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
        self.gain = libm::round(settings.correction.gain * 65_536.0) as i64;
    }

    /// True if the settings request a correction.
    pub const fn is_on(&self) -> bool {
        self.gain > 0
    }

    /// Present trims.
    pub const fn now(&self) -> &PerAxis<Turns> {
        &self.now
    }

    /// Target of the trims, or their present values at rest.
    pub const fn target(&self) -> &PerAxis<Turns> {
        if self.left > 0 {
            &self.target
        } else {
            &self.now
        }
    }

    /// Keeps the present trims.
    pub const fn hold(&mut self) {
        self.left = 0;
    }

    /// True while trims change.
    pub const fn is_moving(&self) -> bool {
        self.left > 0
    }

    /// Trims that remove the differences between the `error`s of the cranks with the present trims.
    ///
    /// With `all` they remove the whole difference, otherwise the fraction that is corrected at once. Axes that are not
    /// `watched` keep their trims.
    pub fn against(&self, error: &PerAxis<Turns>, watched: u8, all: bool) -> PerAxis<Turns> {
        let mut target = self.now;
        if watched.count_ones() > 1 {
            let mean = self.mean(error, watched);
            take_away(
                &mut target,
                error,
                watched,
                mean,
                (!all).then_some(self.gain),
            );
        }
        target
    }

    /// Mean error of the `watched` axes, to a part in 10,000; zero without axes.
    pub fn mean(&self, error: &PerAxis<Turns>, watched: u8) -> Turns {
        let axes = (watched.count_ones() as usize).wrapping_sub(1);
        let share = SHARES.get(axes).copied();
        Turns::from_bits(sum(error, watched) * i64::from(share.unwrap_or(0)))
    }

    /// Axis, if any, whose limit a target exceeds.
    pub fn beyond_limit(&self, target: &PerAxis<Turns>) -> Option<usize> {
        let axes = target.iter().zip(&self.limit);
        axes.enumerate()
            .find(|(_, (target, limit))| target.wrapping_abs() > **limit)
            .map(|(axis, _)| axis)
    }

    /// Starts a move from the present trims to `target`, which must have the same sum.
    pub fn go_to(&mut self, target: PerAxis<Turns>) {
        let doublings = share_out(&mut self.change, &self.now, &target, self.count, self.rate);
        self.target = target;
        self.left = 1 << doublings;
    }

    /// Advances by one tick; returns the changes in it.
    pub fn advance(&mut self) -> Option<&PerAxis<Turns>> {
        match self.left {
            0 => return None,
            1 => {
                let pairs = self.target.iter().zip(&self.now);
                for (change, (target, &now)) in self.change.iter_mut().zip(pairs) {
                    *change = target.wrapping_sub(now);
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

/// Sum of the errors of the `watched` axes, with 16 fraction bits fewer.
#[inline(never)]
fn sum(error: &[Turns], watched: u8) -> i64 {
    let axes = error.iter().enumerate();
    axes.filter(|(axis, _)| watched & 1 << axis != 0)
        .map(|(_, error)| error.to_bits() >> 16)
        .sum()
}

/// Subtracts from trims the deviations of the `watched` axes from the mean, or a fraction of them. The last of these axes
/// takes the remainder, so that the sum does not change.
#[inline(never)]
fn take_away(trims: &mut [Turns], error: &[Turns], watched: u8, mean: Turns, gain: Option<i64>) {
    let mut rest = Turns::ZERO;
    let mut left = watched;
    for (axis, (trim, &error)) in trims.iter_mut().zip(error).enumerate() {
        let own = 1 << axis;
        if left & own == 0 {
            continue;
        }
        left &= !own;
        let off = mean.wrapping_sub(error);
        let by = match gain {
            _ if left == 0 => rest,
            None => off,
            Some(gain) => Turns::from_bits((off.to_bits() >> 16) * gain),
        };
        *trim = trim.wrapping_add(by);
        rest = rest.wrapping_sub(by);
    }
}

/// Computes the change per tick from the present trims to their targets; returns the binary logarithm of the ticks.
///
/// The number of ticks is a power of two, so that no division is needed.
#[inline(never)]
fn share_out(
    change: &mut PerAxis<Turns>,
    now: &PerAxis<Turns>,
    target: &PerAxis<Turns>,
    count: usize,
    rate: u64,
) -> u32 {
    let mut most = 0;
    let pairs = target.iter().zip(now);
    for (change, (target, &now)) in change.iter_mut().zip(pairs) {
        *change = target.wrapping_sub(now);
        most = most.max(change.to_bits().unsigned_abs());
    }
    let mut doublings = 0;
    while most > rate {
        most >>= 1;
        doublings += 1;
    }
    // The last axis takes the remainder of rounding, so that the sum is zero.
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
