//! Square root, normalised: 32 significant bits whatever the size of the argument.
//!
//! The profile's ω = sqrt(amax / …) is followed down to a thousandth of its greatest value, so it is
//! the relative error that counts. The argument is shifted up until its top bits are used, an exact
//! integer root is taken, and the shift is handed on for the caller to fold into its own.
//!
//! The board has no 64-bit division, and none is used. The reciprocal root y ≈ 1/√high of the upper
//! word comes from a table; it never exceeds the truth. It then serves twice as a multiplication in
//! place of a division: √high ≈ high · y gives the upper half of the root, and what that leaves over,
//! times y, the lower half (one step of Newton's method). Each half falls short by a few units at
//! most, and is raised to where its remainder says that it is the floor.

/// A root as `mantissa / 2^shift`; the mantissa has its top bit set, except for the root of zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Root {
    /// From 2³¹ up, or 0.
    pub mantissa: u32,
    /// 0 to 31.
    pub shift: u32,
}

/// The root of `x`, rounded down; relative error below 2⁻³¹.
#[inline(always)] // it has few callers, and a call would cost an eighth more
pub const fn root(x: u64) -> Root {
    let (mut high, mut low, mut shift) = ((x >> 32) as u32, x as u32, 0);
    if high == 0 {
        if low == 0 {
            return Root {
                mantissa: 0,
                shift: 0,
            };
        }
        (high, low, shift) = (low, 0, 16);
    }
    if high >> 16 == 0 {
        (high, low, shift) = (high << 16 | low >> 16, low << 16, shift + 8);
    }
    if high >> 24 == 0 {
        (high, low, shift) = (high << 8 | low >> 24, low << 8, shift + 4);
    }
    if high >> 28 == 0 {
        (high, low, shift) = (high << 4 | low >> 28, low << 4, shift + 2);
    }
    if high >> 30 == 0 {
        (high, low, shift) = (high << 2 | low >> 30, low << 2, shift + 1);
    }
    Root {
        mantissa: normalised_root(high, low),
        shift,
    }
}

/// The integer root of `x`, rounded down: exact, as `u64::isqrt` is, in a tenth of the board's time.
pub const fn isqrt(x: u64) -> u32 {
    let Root { mantissa, shift } = root(x);
    mantissa >> shift
}

/// The floor of √(high · 2³² + low), for `high` from 2³⁰ up.
const fn normalised_root(high: u32, low: u32) -> u32 {
    let y = reciprocal_root(high);
    // y ≤ 2³¹/√high, so the product is at most √high · 2¹⁶.
    let mut upper = ((high >> 15) * y) >> 16;
    let mut rest = high - upper * upper;
    let mut twice = 2 * upper;
    while rest > twice {
        rest -= twice + 1;
        twice += 2;
    }
    upper = twice / 2;
    // The lower half is (rest · 2³² + low) / (2¹⁷ · upper), or one less: its square is still to be
    // taken off. rest ≤ 2 · upper, so no product exceeds 32 bits.
    let mut lower = (rest * y) >> 16;
    let mut left = (rest << 15 | low >> 17) - lower * upper;
    // Short by less than 10: 6 by y's own shortness, 2 by upper being a floor, 1 by `low`, 1 by being
    // a floor itself. The same quotient of what is left says by how many, or by one less.
    let short = ((left >> 2) * (y >> 2)) >> 27;
    lower += short;
    left -= short * upper;
    if left >= upper {
        left -= upper;
        lower += 1;
    }
    let root = (upper << 16).wrapping_add(lower);
    // What is left over all, in units of 2¹⁶; its lowest 16 bits are those of `low`.
    if left >> 15 != 0 {
        return root;
    }
    let left = left << 17 | (low & 0x1_ffff);
    if lower >> 16 == 0 && left >= lower * lower {
        return root;
    }
    root.wrapping_sub(1)
}

/// 2³¹/√high for `high` from 2³⁰ up: never above it, and less than 3 below (tested).
const fn reciprocal_root(high: u32) -> u32 {
    let index = (high >> 24) as usize;
    let (from, to) = (RECIPROCAL[index], RECIPROCAL[index + 1]);
    let within = (high >> 8) & 0xffff;
    (from - (((from - to) * within) >> 16)) >> 5
}

/// 2²⁴/√i, rounded down, less what a straight line to the next entry is too high by.
///
/// Entries below 64 are never read; leaving them out would cost a subtraction.
static RECIPROCAL: [u32; 257] = reciprocals();

const fn reciprocals() -> [u32; 257] {
    let mut table = [0; 257];
    let mut i = 64;
    while i <= 256 {
        let exact = ((1_u128 << 48) / i).isqrt();
        // The curve's sag below its chord is at most f''/8 = 3/32 · i^(-5/2); and as the product in the
        // line is rounded down, the line is raised by less than 1.
        let sag = exact * 3 / (32 * i * i) + 1;
        table[i as usize] = (exact - sag - 1) as u32;
        i += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn is_floor(x: u64) {
        assert_eq!(isqrt(x), x.isqrt() as u32, "of {x}");
        let Root { mantissa, shift } = root(x);
        let normalised = x << (2 * shift);
        assert_eq!(mantissa, normalised.isqrt() as u32, "of {x}");
        assert!(x == 0 || mantissa >> 31 == 1, "of {x}: {mantissa}");
    }

    /// Every upper half, with what it can leave over at its ends and in between, and the lower words at
    /// which a bit passes from one part of the reckoning to another.
    #[test]
    fn floor_for_every_upper_half() {
        for upper in 1_u64 << 15..1 << 16 {
            for rest in [0, 1, upper, 2 * upper - 1, 2 * upper] {
                for low in [
                    0,
                    1,
                    0xffff,
                    0x1_0000,
                    0x1_ffff,
                    0x2_0000,
                    u32::MAX - 1,
                    u32::MAX,
                ] {
                    is_floor((upper * upper + rest) << 32 | u64::from(low));
                }
            }
        }
    }

    #[test]
    fn floor_at_squares_and_their_neighbours() {
        for root in 1..=0xffff_u64 {
            for factor in [
                root,
                root << 16,
                root << 16 | 0xffff,
                root * 65_521 + 40_503,
            ] {
                let square = factor * factor;
                for x in [square - 1, square, square + 1, square + 2 * factor] {
                    is_floor(x);
                }
            }
        }
    }

    /// Every upper word at a stride that is prime to all powers of two, with the extremes of the lower.
    #[test]
    fn floor_over_upper_words() {
        for high in (0..u32::MAX).step_by(4_099) {
            for low in [0, 1, 0x1_ffff, 0x2_0000, u32::MAX - 1, u32::MAX] {
                is_floor(u64::from(high) << 32 | u64::from(low));
            }
        }
    }

    #[test]
    fn floor_at_extremes() {
        for bits in 0..64 {
            for x in [
                (1_u64 << bits) - 1,
                1 << bits,
                (1 << bits) + 1,
                u64::MAX >> bits,
            ] {
                is_floor(x);
            }
        }
        assert_eq!(root(0).mantissa, 0);
        assert_eq!(root(u64::MAX).mantissa, u32::MAX);
    }

    proptest! {
        #[test]
        fn floor_anywhere(x: u64, zeros in 0_u32..64) {
            is_floor(x >> zeros);
        }
    }

    /// A reciprocal above the truth would overflow the products and overshoot the floors; one far
    /// below would cost time.
    #[test]
    fn reciprocal_root_is_a_close_lower_bound() {
        let mut most_short = 0.0_f64;
        for high in (1_u32 << 30..=u32::MAX).step_by(1_009).chain([u32::MAX]) {
            let short = 2_f64.powi(31) / f64::from(high).sqrt() - f64::from(reciprocal_root(high));
            assert!(short >= 0.0, "of {high}: over by {}", -short);
            most_short = most_short.max(short);
        }
        assert!(most_short < 3.0, "{most_short}");
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
}
