//! Products wider than those of a Cortex-M0+, which multiplies 32 by 32 bits into 32 in one cycle.
//!
//! Through `u64` every product costs a call of some 50 cycles, even where the range of its factors is known. These
//! functions build the product from 16-bit parts inline, in 20 to 30 cycles, and give the same bits. A processor with
//! 64-bit registers multiplies at once.

/// Full 64-bit product a b. Exact.
#[inline(always)]
pub const fn multiply(a: u32, b: u32) -> u64 {
    if cfg!(target_pointer_width = "64") {
        return a as u64 * b as u64;
    }
    let (high, low) = parts(a, b);
    (high as u64) << 32 | low as u64
}

/// Upper half of the product: a b / 2³², rounded down. Exact.
#[inline(always)]
pub const fn multiply_high(a: u32, b: u32) -> u32 {
    if cfg!(target_pointer_width = "64") {
        return (multiply(a, b) >> 32) as u32;
    }
    parts(a, b).0
}

/// Upper and lower half of a product, from 16-bit parts.
///
/// The carry comes from `overflowing_add`. Compilers recognise additions of 16 bits at a time and turn them back into
/// the library call.
#[inline(always)]
const fn parts(a: u32, b: u32) -> (u32, u32) {
    let (a_low, a_high) = (a & 0xFFFF, a >> 16);
    let (b_low, b_high) = (b & 0xFFFF, b >> 16);
    let low = a_low * b_low;
    let one = a_high * b_low + (low >> 16);
    let (middle, carry) = one.overflowing_add(a_low * b_high);
    let high = a_high * b_high + (middle >> 16) + ((carry as u32) << 16);
    (high, middle << 16 | low & 0xFFFF)
}

/// Lower 64 bits of the product a b, that is a b modulo 2⁶⁴.
///
/// The result is the whole product where that is below 2⁶⁴. Two's complement holds: the bits of a negative `a` give the
/// bits of the negative product.
#[inline(always)]
pub const fn multiply_long(a: u64, b: u32) -> u64 {
    let upper = ((a >> 32) as u32).wrapping_mul(b);
    multiply(a as u32, b).wrapping_add((upper as u64) << 32)
}

/// Product of two numbers with 30 fraction bits, rounded down.
///
/// The result must lie within ±2; beyond that it wraps. Callers multiply sines, cosines and factors from 0.8 to 1.25.
/// The error lies between −2⁻³⁰ and 0.
#[inline(always)]
pub const fn multiply_q30(a: i32, b: i32) -> i32 {
    if cfg!(target_pointer_width = "64") {
        return ((a as i64 * b as i64) >> 30) as i32;
    }
    parts_q30(a, b)
}

/// [`multiply_q30`] from 16-bit parts.
#[inline(always)]
const fn parts_q30(a: i32, b: i32) -> i32 {
    let (a_low, a_high) = (a & 0xFFFF, a >> 16);
    let (b_low, b_high) = (b & 0xFFFF, b >> 16);
    // A signed 16-bit number times an unsigned one, plus 16 bits, still fits in 32 bits signed.
    let lowest = (a_low as u32 * b_low as u32) >> 16;
    let middle = a_high * b_low + lowest as i32;
    let other = a_low * b_high + (middle & 0xFFFF);
    let top = a_high * b_high + (middle >> 16); // 28 fraction bits; `other` has 44
    // The first term alone may exceed ±2 slightly; the sum is right modulo 2³².
    (top << 2).wrapping_add(other >> 14)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Factors whose halves lie at their extremes, where carries occur.
    fn factor() -> impl Strategy<Value = u32> {
        let half = || {
            prop_oneof![
                prop::sample::select(std::vec![0_u32, 1, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF]),
                0..=0xFFFF_u32
            ]
        };
        (half(), half()).prop_map(|(high, low)| high << 16 | low)
    }

    proptest! {
        #[test]
        fn products_are_exact(a in factor(), b in factor(), c in factor()) {
            let whole = u64::from(a) * u64::from(b);
            prop_assert_eq!(multiply(a, b), whole);
            prop_assert_eq!(multiply_high(a, b), (whole >> 32) as u32);
            prop_assert_eq!(parts(a, b), ((whole >> 32) as u32, whole as u32));
            let long = u64::from(c) << 32 | u64::from(a);
            prop_assert_eq!(multiply_long(long, b), long.wrapping_mul(u64::from(b)));
        }

        #[test]
        fn signed_products_are_rounded_down(a in factor(), b in factor()) {
            let (a, b) = (a as i32, b as i32);
            let whole = (i64::from(a) * i64::from(b)) >> 30;
            // Beyond ±2 the lower 32 bits of it.
            prop_assert_eq!(multiply_q30(a, b), whole as i32);
            prop_assert_eq!(parts_q30(a, b), whole as i32);
        }
    }
}
