//! A stop at a chosen phase, hit to the count.
//!
//! From a constant speed v, a ramp down of n + m ticks takes away v · W(k) / (n m) by its k-th tick,
//! where the weights w = W' are a trapezoid: 1, 2, … n, … n, … 2, 1 (two boxcars of n and m ticks,
//! n ≤ m, convolved). Its acceleration is at most v/m, its jerk v/(n m), and being symmetric it
//! covers a way that is known beforehand to half a unit.
//!
//! Starting the ramp a tick later lengthens the way by exactly v, so that some number of ticks at
//! constant speed and a rest r < v remain to be covered. The rest comes from *blending*: r/v parts of
//! the ramp that starts one tick later and 1 − r/v of the one that starts now. Both keep the limits,
//! so their mean does, and its way is exactly r longer.
//!
//! The blend is carried in exact rational arithmetic over the denominator n m (quotient and rest,
//! additions only), and only the phase is rounded. Rounding the phase by less than one unit changes
//! the jerk by less than four and the acceleration by less than two: by that the ramp is planned
//! gentler than the limits.

use super::limits::RampLimits;
use crate::functions::isqrt;
use crate::units::{ONE_TURN, Turns};

/// A stop that is under way.
#[derive(Clone, Debug)]
pub(super) struct StopPlan {
    speed: i64,
    /// Ticks at constant speed that are left.
    wait: u64,
    /// Ticks of the ramp that are done.
    tick: u64,
    /// The boxcars' lengths, `short ≤ long`.
    short: u64,
    long: u64,
    /// Their product.
    denominator: u64,
    /// `speed · w / (short · long)` and its sums: acceleration, speed taken, way taken.
    weight: Ladder,
    /// `rest · w / (short · long)` and its sum.
    blend: Ladder,
    /// Way taken away so far, rounded.
    taken: i64,
}

impl StopPlan {
    /// From constant `speed` (above 0), a stop at the first possible passage through the phase that
    /// lies `ahead` turns (modulo 1).
    pub fn new(speed: i64, ahead: Turns, limits: &RampLimits) -> Self {
        let v = speed.unsigned_abs().max(1);
        let (short, long) = boxcars(v, limits);
        // After short + long ticks the ramp that starts now has taken v (short + long + 2)/2.
        let ticks = short + long;
        let ramp_way = ticks * v - (v * (ticks + 2)) / 2;
        let left = ahead.to_bits().wrapping_sub(ramp_way as i64) & (ONE_TURN - 1);
        let left = left as u64;
        let denominator = (short * long).max(1);
        Self {
            speed,
            wait: left / v,
            tick: 0,
            short,
            long,
            denominator,
            weight: Ladder::new(v, denominator),
            blend: Ladder::new(left % v, denominator),
            taken: 0,
        }
    }

    /// The speed of the coming tick.
    pub fn advance(&mut self) -> i64 {
        if self.wait > 0 {
            self.wait -= 1;
            return self.speed;
        }
        self.tick += 1;
        let slope = if self.tick <= self.short {
            Slope::Up
        } else if self.tick <= self.long {
            Slope::Flat
        } else {
            Slope::Down
        };
        let denominator = self.denominator;
        self.weight.step(slope, denominator);
        self.blend.step(slope, denominator);
        let taken = self
            .weight
            .second
            .minus(self.blend.first, denominator)
            .whole;
        let speed = self.speed - (taken - self.taken);
        self.taken = taken;
        speed
    }

    /// Whether the shaft stands.
    pub const fn is_done(&self) -> bool {
        self.wait == 0 && self.tick == self.short + self.long
    }
}

/// Lengths (short, long) of the two boxcars: the fewest ticks that keep the limits.
fn boxcars(v: u64, limits: &RampLimits) -> (u64, u64) {
    let acceleration = (limits.acceleration - 2).max(1).unsigned_abs();
    let jerk = (limits.jerk - 4).max(1).unsigned_abs();
    let long = v.div_ceil(acceleration);
    let short = v.div_ceil((jerk * long).max(1));
    if short <= long {
        return (short, long);
    }
    // The jerk alone decides. Two equal boxcars, or one shorter by a tick where that is enough.
    let square = v.div_ceil(jerk);
    let root = u64::from(isqrt(square));
    let long = root + u64::from(root * root < square);
    (v.div_ceil((jerk * long).max(1)), long)
}

#[derive(Clone, Copy)]
enum Slope {
    Up,
    Flat,
    Down,
}

/// A quantity times the trapezoid's weight, with its running sum and that sum's running sum.
#[derive(Clone, Copy, Debug)]
struct Ladder {
    unit: Rational,
    level: Rational,
    first: Rational,
    second: Rational,
}

impl Ladder {
    const fn new(numerator: u64, denominator: u64) -> Self {
        let unit = Rational {
            whole: (numerator / denominator) as i64,
            rest: numerator % denominator,
        };
        Self {
            unit,
            level: Rational::ZERO,
            first: Rational::ZERO,
            second: Rational::ZERO,
        }
    }

    fn step(&mut self, slope: Slope, denominator: u64) {
        match slope {
            Slope::Up => self.level = self.level.plus(self.unit, denominator),
            Slope::Flat => {}
            Slope::Down => self.level = self.level.minus(self.unit, denominator),
        }
        self.first = self.first.plus(self.level, denominator);
        self.second = self.second.plus(self.first, denominator);
    }
}

/// `whole + rest / denominator`, 0 ≤ rest < denominator, which all of one plan share.
#[derive(Clone, Copy, Debug)]
struct Rational {
    whole: i64,
    rest: u64,
}

impl Rational {
    const ZERO: Self = Self { whole: 0, rest: 0 };

    const fn plus(self, other: Self, denominator: u64) -> Self {
        let (whole, rest) = (self.whole + other.whole, self.rest + other.rest);
        if rest >= denominator {
            Self {
                whole: whole + 1,
                rest: rest - denominator,
            }
        } else {
            Self { whole, rest }
        }
    }

    const fn minus(self, other: Self, denominator: u64) -> Self {
        let whole = self.whole - other.whole;
        if self.rest < other.rest {
            Self {
                whole: whole - 1,
                rest: self.rest + denominator - other.rest,
            }
        } else {
            Self {
                whole,
                rest: self.rest - other.rest,
            }
        }
    }
}
