//! One segment: the ramp to a level, and the time at it.

use core::hash::{Hash, Hasher};

use crate::functions::{multiply, multiply_high, multiply_long};
use crate::units::Amax;

/// Shape of a segment's ramp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub enum Shape {
    /// Linear in time.
    Linear,
    /// Polynomial x³ (10 − 15 x + 6 x²). Its first and second derivatives are zero at both ends, so that the level and
    /// its first two derivatives are continuous through the program.
    #[default]
    Smooth,
}

/// Level with its ramp and its hold time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Level at the end of the ramp.
    pub level: Amax,
    /// Length of the ramp, ticks.
    pub ramp_ticks: u32,
    /// Time at the level, ticks.
    pub hold_ticks: u64,
    /// Shape of the ramp.
    pub shape: Shape,
    /// Reciprocal 2⁶⁴ / `ramp_ticks`, which avoids a division in the tick.
    per_ramp_tick: u64,
}

impl Segment {
    /// Creates a segment; its duration is `ramp_ticks + hold_ticks`.
    pub const fn new(level: Amax, ramp_ticks: u32, hold_ticks: u64, shape: Shape) -> Self {
        let per_ramp_tick = match ramp_ticks {
            0 | 1 => u64::MAX, // A ramp of one tick ends with that tick, so this is never read.
            n => u64::MAX / n as u64,
        };
        Self {
            level,
            ramp_ticks,
            hold_ticks,
            shape,
            per_ramp_tick,
        }
    }

    /// Hashes one of three slices.
    #[inline(always)]
    pub(super) fn hash_slice(&self, slice: usize, hasher: &mut impl Hasher) {
        let Self {
            level,
            ramp_ticks,
            hold_ticks,
            shape,
            per_ramp_tick,
        } = self;
        match slice {
            0 => (level, ramp_ticks).hash(hasher),
            1 => (hold_ticks, shape).hash(hasher),
            _ => per_ramp_tick.hash(hasher),
        }
    }

    /// Duration of ramp and hold, in ticks.
    pub const fn ticks(&self) -> u64 {
        self.ramp_ticks as u64 + self.hold_ticks
    }

    /// Level after `tick` ticks of the segment, which starts from level `from`.
    ///
    /// It is exact at both ends of the ramp, and between them within 2⁻²⁶ of the difference of the levels.
    pub fn level_at(&self, tick: u64, from: Amax) -> Amax {
        if tick >= u64::from(self.ramp_ticks) {
            return self.level;
        }
        // The part of the ramp that is over, 32 fraction bits. As tick < ramp_ticks, the product is below 2⁶⁴.
        let x = (multiply_long(self.per_ramp_tick, tick as u32) >> 32) as u32;
        let part = match self.shape {
            Shape::Linear => u64::from(x),
            Shape::Smooth => smooth(x),
        };
        if self.level >= from {
            from.saturating_add(scale(self.level - from, part))
        } else {
            from.saturating_sub(scale(from - self.level, part))
        }
    }
}

/// Polynomial x³ (10 − 15 x + 6 x²), all with 32 fraction bits, for x from 0 up to, not including, 1.
const fn smooth(x: u32) -> u64 {
    // Powers are computed one by one, so that each product fits 64 bits.
    let cube = multiply_high(multiply_high(x, x), x);
    let fourth = multiply_high(cube, x);
    let fifth = multiply_high(fourth, x);
    let sum = multiply(cube, 10) + multiply(fifth, 6);
    let part = sum.saturating_sub(multiply(fourth, 15));
    // The powers are rounded down by up to 2, 3 and 4 units, so near the end the sum may exceed 1.
    if part > 1 << 32 { 1 << 32 } else { part }
}

/// Product `difference * part`, `part` with 32 fraction bits, up to 1.
const fn scale(difference: Amax, part: u64) -> Amax {
    if part >> 32 != 0 {
        return difference;
    }
    // Upper and lower half are multiplied separately, as the whole product has 96 bits.
    let (bits, part) = (difference.to_bits(), part as u32);
    let high = multiply((bits >> 32) as u32, part);
    let low = multiply_high(bits as u32, part);
    Amax::from_bits(high + low as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quintic(x: f64) -> f64 {
        x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    }

    /// The powers are rounded by at most 10 · 2 + 6 · 4 or 15 · 3 units of 2⁻³², relative to the polynomial itself.
    #[test]
    fn smooth_follows_its_polynomial() {
        let mut worst = 0.0_f64;
        for i in 0..100_000_u64 {
            let x = ((i << 32) / 100_000) as u32;
            let actual = smooth(x) as f64 / 4294967296.0;
            worst = worst.max((actual - quintic(f64::from(x) / 4294967296.0)).abs());
        }
        assert!(worst < 45.0 / 4294967296.0, "{worst:e}");
    }

    #[test]
    fn ramps_end_exactly_on_their_level_and_go_both_ways() {
        for shape in [Shape::Linear, Shape::Smooth] {
            let low = Amax::from_num(98.0665);
            let high = Amax::from_num(1961.33);
            for (from, to) in [(low, high), (high, low)] {
                let segment = Segment::new(to, 4001, 3, shape);
                assert_eq!(segment.level_at(0, from), from);
                assert_eq!(segment.level_at(4001, from), to);
                assert_eq!(segment.level_at(4003, from), to);
                let ends = (from.min(to), from.max(to));
                let mut last = from;
                for tick in 0..=4001 {
                    let level = segment.level_at(tick, from);
                    assert!(
                        ends.0 <= level && level <= ends.1,
                        "the ramp leaves its ends"
                    );
                    let slack = Amax::from_bits(1 << 22); // the polynomial's rounding
                    if to > from {
                        assert!(level + slack >= last, "the ramp turns back at {tick}");
                    } else {
                        assert!(level <= last + slack, "the ramp turns back at {tick}");
                    }
                    last = level;
                }
            }
        }
    }

    #[test]
    fn the_middle_of_a_ramp_has_the_mean_level() {
        for shape in [Shape::Linear, Shape::Smooth] {
            let segment = Segment::new(Amax::from_num(200), 1000, 0, shape);
            let actual: f64 = segment.level_at(500, Amax::from_num(100)).to_num();
            assert!(
                (actual - 150.0).abs() < 100.0 * (-26.0_f64).exp2(),
                "{actual}"
            );
        }
    }
}
