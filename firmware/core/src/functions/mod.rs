//! The elementary functions that the tick needs, one a file.
//!
//! Each states its range and its error against f64, and its test measures that error. Everything
//! here is integer arithmetic: the same bits on every machine. The board multiplies 32 by 32 bits to
//! 32 in a cycle; wider products and all divisions are calls, which these functions do without. What
//! each costs there, beside others' ways, is measured in `docs/functions.md`.

mod inverse_root;
mod root;
mod sine;

pub use inverse_root::inverse_root_of_one_minus;
pub use root::{Root, isqrt, root};
pub use sine::{SineCosine, sine_cosine};

/// 1.0 in the format of sines, cosines and inverse roots: signed, 30 fraction bits.
pub const ONE_Q30: i32 = 1 << 30;

/// Product of two numbers with 30 fraction bits, rounded down: exact.
///
/// The result must lie within ±2: the callers' operands are sines, cosines, and factors from 0.8
/// to 1.25. Made of four products of halves, in a third of the time of a 64-bit product.
pub const fn multiply_q30(a: i32, b: i32) -> i32 {
    let (a_high, a_low) = (a >> 16, a & 0xffff);
    let (b_high, b_low) = (b >> 16, b & 0xffff);
    // A signed 16 bits times an unsigned, plus 16 bits, is still within 32 bits signed.
    let lowest = (a_low as u32 * b_low as u32) >> 16;
    let middle = a_high * b_low + lowest as i32;
    let other = a_low * b_high + (middle & 0xffff);
    let top = a_high * b_high + (middle >> 16); // 28 fraction bits; `other` has 44
    // The first alone may pass ±2 by a little; the sum is right modulo 2³².
    (top << 2).wrapping_add(other >> 14)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The same bits as a product of 64 bits, wherever the result fits.
        #[test]
        fn product_is_exact(a: i32, b: i32) {
            let exact = (i64::from(a) * i64::from(b)) >> 30;
            // Halved until it fits
            let (mut a, mut exact) = (a, exact);
            while i32::try_from(exact).is_err() {
                a /= 2;
                exact = (i64::from(a) * i64::from(b)) >> 30;
            }
            prop_assert_eq!(i64::from(multiply_q30(a, b)), exact);
        }
    }

    #[test]
    fn product_is_exact_at_extremes() {
        let edges = [0, 1, 0xffff, 0x1_0000, ONE_Q30 - 1, ONE_Q30, i32::MAX];
        for a in edges.iter().flat_map(|&a| [a, -a]) {
            for b in edges.iter().flat_map(|&b| [b, -b]) {
                if let Ok(exact) = i32::try_from((i64::from(a) * i64::from(b)) >> 30) {
                    assert_eq!(multiply_q30(a, b), exact, "{a} × {b}");
                }
            }
        }
    }
}
