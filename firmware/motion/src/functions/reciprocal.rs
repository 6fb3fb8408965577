//! Reciprocal 1/d by Newton's iteration.
//!
//! A processor without a divider takes hundreds of cycles for a division, and some 50 for this.
//!
//! With d from ½ to 1, 48/17 − 32/17 d is within 1/17 of 1/d, and x (2 − d x) squares the relative error of x. Two such
//! steps with 16 bits of d bring the error below 2⁻¹⁴, which 15 fraction bits can hold. A third step with all bits of
//! d leaves only its rounding, 2⁻²⁷.

/// Reciprocal 2⁶³ / `d`, for `d` from 2³¹ to 2³² − 1 (top bit set).
///
/// The relative error lies between −2⁻²⁶ and 2⁻³¹ (tested). A `d` without its top bit gives no meaningful result.
#[inline(always)]
pub const fn reciprocal(d: u32) -> u32 {
    let (high, low) = (d >> 16, d & 0xFFFF);
    // x is 1/d with 15 fraction bits, below 2^16. With 31 fraction bits d x is near 2^31, and 2 − d x is its two's
    // complement negation.
    let mut x = 92_521 - ((61_681 * high) >> 16);
    x = (x * ((high * x).wrapping_neg() >> 16)) >> 15;
    x = (x * ((high * x).wrapping_neg() >> 16)) >> 15;
    let product = high * x + ((low * x) >> 16);
    let error = (1_u32 << 31).wrapping_sub(product) as i32; // below 2^18
    let step = (x as i32 * (error >> 4)) >> 11;
    (x << 16).wrapping_add_signed(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The documented bounds, over both ends of the range, both ends of every upper half, and a sweep.
    #[test]
    fn error_is_within_its_bounds() {
        const MIN: u32 = 1 << 31;
        let ends = (0..1 << 16).flat_map(|i| [MIN + i, u32::MAX - i]);
        let steps = (MIN >> 16..1 << 16).flat_map(|high| [high << 16, high << 16 | 0xFFFF]);
        let sweep = (MIN..u32::MAX - 9973).step_by(9973);
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for d in ends.chain(steps).chain(sweep) {
            let expected = 63.0_f64.exp2() / f64::from(d);
            let error = f64::from(reciprocal(d)) / expected - 1.0;
            low = low.min(error);
            high = high.max(error);
        }
        assert!(low > -(-26.0_f64).exp2(), "{low:e}");
        assert!(high < (-31.0_f64).exp2(), "{high:e}");
    }
}
