//! Units, and conversion of the core's numbers into units for people. `fixed`'s own conversions are exact for every type, and slow. These
//! are for few types, and run in every tick.

pub use cophase_core::units::STANDARD_GRAVITY_MPS2;
use cophase_core::units::{Amax, ONE_TURN, Torque, Turns};

/// Turns as a float; exact below 32 turns.
#[inline]
pub fn turns(turns: Turns) -> f64 {
    turns.to_bits() as f64 / ONE_TURN as f64
}

/// Amplitude, m/s², rounded to 53 bits.
#[inline]
pub fn mps2(amax: Amax) -> f64 {
    amax.to_bits() as f64 / (1_u64 << Amax::FRAC_NBITS) as f64
}

/// Torque, N·m; exact.
#[inline]
pub fn nm(torque: Torque) -> f64 {
    f64::from(torque.to_bits()) / f64::from(1 << Torque::FRAC_NBITS)
}

/// Degrees.
#[inline]
pub fn degrees(angle: Turns) -> f64 {
    turns(angle) * 360.0
}

/// A speed in turns a tick, as rev/s.
#[inline]
pub fn speed_hz(speed: Turns, tick_hz: u32) -> f64 {
    turns(speed) * f64::from(tick_hz)
}

/// Largest minus smallest value. A NaN is ignored, as by `f64::max`, at a lower cost.
#[inline]
pub fn spread(values: &[f64]) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for &value in values {
        low = if value < low { value } else { low };
        high = if value > high { value } else { high };
    }
    high - low
}

/// Nearest whole number, as `value.round() as i64`, without a call where the processor has no instruction for it.
#[inline]
pub fn nearest(value: f64) -> i64 {
    // Just below a half, because adding a half would round up a value just below a half.
    const HALF: f64 = 0.5 - f64::EPSILON / 4.0;
    (value + HALF.copysign(value)) as i64
}

/// Largest whole number up to a value, as `value.floor() as i64`, without a call where the processor has no instruction for it.
#[inline]
pub fn floor(value: f64) -> i64 {
    let whole = value as i64;
    whole.saturating_sub(i64::from(whole as f64 > value))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a bound on the tilt is too small, and a run reports a largest tilt that is too small.
    #[test]
    fn the_spread_is_the_largest_minus_the_smallest_value() {
        assert_eq!(spread(&[0.5]), 0.0);
        assert_eq!(spread(&[-1.5, 3.0, f64::NAN, 0.25]), 4.5);
    }

    /// If this fails, a half, a value next to it, or a large number is rounded differently, and counts of encoders are off by
    /// one.
    #[test]
    fn nearest_and_floor_equal_the_standard_library() {
        let wholes = [
            0.0,
            1.0,
            2.0,
            1e6 + 1.0,
            2_f64.powi(31),
            2_f64.powi(51) + 1.0,
        ];
        let large = [
            2_f64.powi(52) + 1.0,
            2_f64.powi(53) - 1.0,
            2_f64.powi(62),
            1e300,
        ];
        let special = [f64::INFINITY, f64::NAN, f64::MIN_POSITIVE];
        let around = wholes
            .into_iter()
            .flat_map(|whole| [whole, whole + 0.25, whole + 0.5, whole + 0.75].into_iter());
        for value in around.chain(large).chain(special) {
            for value in [value.next_down(), value, value.next_up()] {
                for value in [value, -value] {
                    assert_eq!(nearest(value), value.round() as i64, "{value:e}");
                    assert_eq!(floor(value), value.floor() as i64, "{value:e}");
                }
            }
        }
    }
}
