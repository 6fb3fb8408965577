//! Square root, normalised: 32 significant bits whatever the size of the argument.
//!
//! The profile's ω = sqrt(amax / …) is followed down to a thousandth of its greatest value, so it is
//! the relative error that counts. The argument is shifted up until its top bits are used, an exact
//! integer root is taken, and the shift is handed on for the caller to fold into its own.
//!
//! The root comes without a division. Newton's iteration for 1/sqrt(f), y (3 − f y²)/2, takes a relative error e to
//! 1.5 e²; from a straight line within 9 % over f from ¼ to 1, three steps with 14 fraction bits end within 2⁻¹³.
//! With that y, s = f y has 13 bits, s + (x − s²) y/2 twice as many, and doing it once more all; at most a unit then
//! remains to be put right.

use super::multiply;

/// A root as `mantissa / 2^shift`; the mantissa has its top bit set, except for the root of zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Root {
    /// From 2³¹ up, or 0.
    pub mantissa: u32,
    /// 0 to 31.
    pub shift: u32,
}

impl Root {
    /// The integer root: the largest whole number whose square is not above the argument.
    pub const fn whole(self) -> u64 {
        (self.mantissa >> self.shift) as u64
    }
}

/// The root of `x`, rounded down; relative error below 2⁻³¹.
pub const fn root(x: u64) -> Root {
    if x == 0 {
        return Root {
            mantissa: 0,
            shift: 0,
        };
    }
    let shift = x.leading_zeros() / 2;
    Root {
        mantissa: root_of_normalised(x << (2 * shift)),
        shift,
    }
}

/// ⌊sqrt(x)⌋, for `x` from 2⁶² up.
const fn root_of_normalised(x: u64) -> u32 {
    let f = (x >> 48) as u32; // 16 fraction bits
    let mut y = 34_898 - ((19_907 * f) >> 16); // 2.13 − 1.215 f, 14 fraction bits
    let mut step = 0;
    while step < 3 {
        let product = f * ((y * y) >> 14); // f y², near 1, 30 fraction bits
        y = (y * (((3 << 30) - product) >> 16)) >> 15;
        step += 1;
    }
    let near = f * y; // sqrt(f), 30 fraction bits
    let near = if near < 1 << 30 { near } else { (1 << 30) - 1 } << 2;
    // Of x − s², below 2^52 and then 2^40, the upper 15 bits are as good as y.
    let near = near.saturating_add_signed(((rest(x, near) >> 37) as i32 * y as i32) >> 10);
    let mut near = near.saturating_add_signed(((rest(x, near) >> 25) as i32 * y as i32) >> 22);
    let rest = rest(x, near);
    if rest < 0 {
        near -= 1;
    } else if rest as u64 > (near as u64) << 1 {
        near += 1;
    }
    near
}

/// x − s², which is known to be small.
#[inline(always)]
const fn rest(x: u64, s: u32) -> i64 {
    x.wrapping_sub(multiply(s, s)) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// To the last place, at any argument and next to squares.
        #[test]
        fn it_is_the_integer_root(x in 1_u64 << 62.., s in 1_u32 << 31.., off in -2_i64..=2) {
            prop_assert_eq!(u64::from(root_of_normalised(x)), x.isqrt());
            let x = multiply(s, s).saturating_add_signed(off).max(1 << 62);
            prop_assert_eq!(u64::from(root_of_normalised(x)), x.isqrt());
        }
    }

    proptest! {
        #[test]
        fn the_whole_root_is_the_integer_root(x in any::<u64>(), shift in 0_u32..64) {
            prop_assert_eq!(root(x >> shift).whole(), (x >> shift).isqrt());
        }
    }

    /// The bound in the documentation, over all sizes of argument.
    #[test]
    fn relative_error_is_below_two_to_the_minus_31() {
        let mut worst = 0.0_f64;
        let mut x = 1_u64;
        while x < u64::MAX / 3 * 2 {
            let Root { mantissa, shift } = root(x);
            let got = f64::from(mantissa) / f64::from(1_u32 << shift);
            let want = (x as f64).sqrt();
            worst = worst.max((got - want).abs() / want);
            x += x / 1000 + 1;
        }
        assert!(worst < (-31.0_f64).exp2(), "{worst:e}");
    }

    #[test]
    fn exact_where_the_root_is_whole() {
        assert_eq!(root(0).mantissa, 0);
        let nine = root(9);
        assert_eq!(nine.mantissa >> nine.shift, 3);
        assert_eq!(root(u64::MAX).mantissa, u32::MAX);
    }
}
