//! Braking distance in closed form: how far a shaft still turns if it brakes as fast as possible from now on.
//!
//! The brake is that of the regulator towards speed 0 ([`super::regulator::brake`]). In each tick it takes the greatest
//! deceleration b that can still be released in time, g(b) ≤ v (see [`super::gain`]). From b₀ = q J + f, 0 ≤ f < J, it
//! has three parts, each a sum of known terms.
//!
//! *Rising*, by J a tick. In the i-th tick b = n J + f with n = q + i. The condition that g(b) does not exceed the
//! remaining speed is J n² + 2 f n ≤ v₀ + J q (q + 1)/2 + f q. A root gives the last such n. For a shaft that still
//! accelerates b₀ is negative, and the same holds.
//!
//! *Holding*, at the limit A, as long as g(A) ≤ v.
//!
//! *Release*, from the greatest b with g(b) ≤ v. The speed exceeds g(b) by s ≤ ⌊b/J⌋ units, which the last s ticks take
//! up, a unit each. With b⁽ʲ⁾ in the j-th of these ticks, from 0, the distance is Σ j b⁽ʲ⁾.
//!
//! Everything is exact modulo 2⁶⁴, as 3, by which a sum of squares is divided, has an inverse there. So the difference of
//! two distances is exact, and so is a distance modulo a turn. Speeds and all compared values stay below 2⁵⁰.

use super::limits::RampLimits;
use crate::functions::{isqrt, multiply, multiply_long, normalised, reciprocal};

/// The inverse of 3 modulo 2⁶⁴.
const THIRD: i64 = 0xAAAA_AAAA_AAAA_AAAB_u64 as i64;

/// Sum 1 + 2 + … + n, for `n` below 2³¹.
const fn triangle(n: u32) -> i64 {
    (multiply(n, n + 1) / 2) as i64
}

/// Product n `x`, modulo 2⁶⁴.
pub(super) const fn times(n: u32, x: i64) -> i64 {
    multiply_long(x as u64, n) as i64
}

/// Approximate reciprocal of a divisor, to divide by it several times.
#[derive(Clone, Debug, Hash)]
pub(super) struct Inverse {
    pub inverse: u32,
    /// Bits by which the divisor was shifted up.
    pub up: u32,
}

impl Inverse {
    /// Reciprocal of `d`, which must be above 0.
    pub const fn new(d: i64) -> Self {
        let (d, up) = normalised(d.unsigned_abs());
        Self {
            inverse: reciprocal(d),
            up,
        }
    }

    /// Approximate quotient `x · 2^up / d`; 0 ≤ x < 2⁶⁰, `up` at most 21.
    ///
    /// It is within a relative error of 2⁻²⁵ plus one unit.
    pub fn times(&self, x: i64, up: u32) -> u64 {
        let (x, x_up) = normalised(x.unsigned_abs());
        let quotient = multiply(x, self.inverse);
        let down = 63 + x_up - self.up - up;
        if down >= 64 {
            return 0;
        }
        // Shifts of words: that of a long is a call.
        let (high, low) = ((quotient >> 32) as u32, quotient as u32);
        if down >= 32 {
            return u64::from(high >> (down - 32));
        }
        let low = low >> down | high << 1 << (31 - down);
        u64::from(high >> down) << 32 | u64::from(low)
    }
}

/// Quotient `x / d`, rounded down, for quotients below 2²⁴.
pub(super) fn quotient(x: i64, d: i64) -> u32 {
    let about = Inverse::new(d).times(x, 0) as u32;
    let rest = x - times(about, d);
    if rest < 0 {
        about - 1
    } else {
        about + u32::from(rest >= d)
    }
}

/// State of a brake: speed, deceleration, and the distance covered.
#[derive(Clone, Copy)]
struct Braking {
    speed: i64,
    b: i64,
    distance: i64,
}

impl Braking {
    /// State after `ticks` of raising b by `jerk`: after i ticks the speed is v − i b − J i (i + 1)/2.
    fn raised(self, ticks: u32, jerk: i64) -> Self {
        let Self { speed, b, distance } = self;
        let sum = triangle(ticks);
        let raised = jerk.wrapping_mul(sum);
        // J Σ i (i + 1)/2 = J i (i + 1) (i + 2)/6.
        let sums = times(ticks + 2, raised).wrapping_mul(THIRD);
        Self {
            speed: speed - times(ticks, b) - raised,
            b: b + times(ticks, jerk),
            distance: distance
                .wrapping_add(times(ticks, speed))
                .wrapping_sub(b.wrapping_mul(sum))
                .wrapping_sub(sums),
        }
    }
}

impl RampLimits {
    /// Speed gained while `acceleration`, not negative, is released: D(a).
    pub(super) const fn let_go(&self, acceleration: i64) -> i64 {
        self.gain.of(acceleration.unsigned_abs()) as i64 - acceleration
    }

    /// True if the speed is high enough to release a negative acceleration before standstill.
    pub(super) const fn can_brake(&self, speed: i64, acceleration: i64) -> bool {
        acceleration >= 0 || self.let_go(-acceleration) <= speed
    }

    /// Distance of the fastest brake from a state that [can brake](Self::can_brake), in units modulo 2⁶⁴.
    #[inline(never)]
    pub(super) fn braking_distance(&self, speed: i64, acceleration: i64) -> i64 {
        let b = -acceleration;
        let distance = 0;
        let begun = Braking { speed, b, distance };
        let raised = begun.raised(self.rising_ticks(speed, b), self.jerk);
        let held = self.held(raised);
        held.distance
            .wrapping_add(self.letting_go(held.speed, held.b))
    }

    /// Number of ticks for which the deceleration rises by the whole jerk from `b`.
    fn rising_ticks(&self, speed: i64, b: i64) -> u32 {
        let jerk = self.jerk;
        let step = self.gain.step(b.unsigned_abs());
        let over = b.abs() - step.base as i64;
        if b >= 0 {
            let (q, f) = (step.number, over);
            let max = speed + jerk * triangle(q) + times(q, f);
            return self.last_rising(max, f).map_or(0, |n| n.saturating_sub(q));
        }
        // This q is −q in −q J + f.
        let (q, f) = match over {
            0 => (step.number, 0),
            _ => (step.number + 1, jerk - over),
        };
        let max = speed + jerk * triangle(q - 1) - times(q, f);
        // The tick before n = 0 is always within the limits.
        self.last_rising(max, f).map_or(q - 1, |n| n + q)
    }

    /// Greatest n with n J + f within the limit and J n² + 2 f n ≤ `max`.
    fn last_rising(&self, max: i64, f: i64) -> Option<u32> {
        let jerk = self.jerk;
        let room = self.acceleration - f;
        if max < 0 || room < 0 {
            return None;
        }
        // J n² alone gives an n that is at most one too high, and the approximation is off by less than one.
        let mut n = isqrt(self.gain.per_jerk.times(max, 0)) + 1;
        // The limit has one step less above `f` if `f` is more than what it has above its last step.
        let last = self.limit.number - u32::from(room < self.limit.base as i64);
        n = n.min(last);
        while times(n, times(n, jerk) + 2 * f) > max {
            n -= 1;
        }
        Some(n)
    }

    /// State after holding the deceleration at the limit, if it reaches the limit.
    fn held(&self, from: Braking) -> Braking {
        let Braking { speed, b, distance } = from;
        let over = speed - self.gain_from_limit as i64;
        let max = self.acceleration;
        if over < 0 || b + self.jerk < max {
            return from;
        }
        let ticks = quotient(over, max) + 1;
        let taken = max.wrapping_mul(triangle(ticks));
        Braking {
            speed: speed - times(ticks, max),
            b: max,
            distance: distance
                .wrapping_add(times(ticks, speed))
                .wrapping_sub(taken),
        }
    }

    /// Distance of the release, from a deceleration that is within a jerk of `b`.
    fn letting_go(&self, speed: i64, b: i64) -> i64 {
        let min = (b - self.jerk).max(0);
        let max = (b + self.jerk).min(self.acceleration);
        let mut step = self.limit;
        let first = self.gain.inverse(
            speed.unsigned_abs(),
            min.unsigned_abs(),
            max.unsigned_abs(),
            &mut step,
        );
        if first.wrapping_sub(step.base) >= self.jerk.unsigned_abs() {
            step = self.gain.step(first);
        }
        let n = step.number;
        let more = speed - self.gain.above(&step, first) as i64;
        let sum = triangle(n);
        let squares = times(2 * n + 1, self.jerk.wrapping_mul(sum)).wrapping_mul(THIRD);
        (first as i64)
            .wrapping_mul(sum)
            .wrapping_sub(squares)
            .wrapping_add(times(more as u32, i64::from(2 * n + 1) - more) / 2)
    }
}
