//! Square root, normalised: 32 significant bits whatever the size of the argument.
//!
//! The profile's ω = sqrt(amax / …) is followed down to a thousandth of its greatest value, so it is
//! the relative error that counts. The argument is shifted up until its top bits are used, an exact
//! integer root is taken, and the shift is handed on for the caller to fold into its own.

/// A root as `mantissa / 2^shift`; the mantissa has its top bit set, except for the root of zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Root {
    /// From 2³¹ up, or 0.
    pub mantissa: u32,
    /// 0 to 31.
    pub shift: u32,
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
    let normalised = x << (2 * shift);
    Root {
        mantissa: normalised.isqrt() as u32,
        shift,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
