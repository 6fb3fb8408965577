//! Normalised square root: 32 significant bits for every size of the argument.
//!
//! The profile's ω = sqrt(amax / …) is followed down to a thousandth of its greatest value, so the relative error
//! counts. The argument is shifted up until its top bits are used, and an exact integer root is taken. The caller
//! combines the returned shift with its own.
//!
//! No 64-bit division is used, as a Cortex-M0+ has none. The reciprocal root y ≈ 1/√high of the upper word comes from
//! a table and never exceeds the exact value. It replaces a division twice. √high ≈ high · y gives the upper half of
//! the root. The remainder of that, times y, gives the lower half (one step of Newton's method). Each half falls short
//! by a few units at most. It is raised until its remainder shows that it is the floor. A processor with 64-bit registers
//! also has a root of floating-point numbers. That is within one of the floor, and is corrected likewise.

/// A root as `mantissa / 2^shift`; the mantissa has its top bit set, except for the root of zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Root {
    /// Mantissa, from 2³¹ to 2³² − 1, or 0.
    pub mantissa: u32,
    /// Binary exponent, from 0 to 31: the root is the mantissa shifted down by this.
    pub shift: u32,
}

/// Square root of `x`, rounded down; the relative error is below 2⁻³¹ (tested). Defined for every `x`.
#[inline(always)] // It has few callers, and a call would cost an eighth more.
pub fn root(x: u64) -> Root {
    if cfg!(target_pointer_width = "64") && x != 0 {
        let shift = x.leading_zeros() / 2;
        return Root {
            mantissa: root_of_normalised(x << (2 * shift)),
            shift,
        };
    }
    root_in_words(x)
}

/// Floor of √x, for `x` from 2⁶² up.
fn root_of_normalised(x: u64) -> u32 {
    // The number and its root are rounded, each by 2⁻⁵³ of it: the root by less than 2⁻²⁰.
    let near = (libm::sqrt(x as f64) as u64).min(u64::from(u32::MAX));
    let floor = match x.checked_sub(near * near) {
        None => near - 1,
        Some(rest) => near + u64::from(rest > 2 * near),
    };
    floor as u32
}

#[inline(always)]
const fn root_in_words(x: u64) -> Root {
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

/// Integer square root of `x`, rounded down. Exact, as `u64::isqrt` is, in a tenth of its time on a Cortex-M0+.
pub fn isqrt(x: u64) -> u32 {
    let Root { mantissa, shift } = root(x);
    mantissa >> shift
}

/// Floor of √(high · 2³² + low), for `high` from 2³⁰ up.
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
    // The lower half is (rest · 2³² + low) / (2¹⁷ · upper), or one less, as its square is not subtracted yet.
    // rest ≤ 2 · upper, so no product exceeds 32 bits.
    let mut lower = (rest * y) >> 16;
    let mut left = (rest << 15 | low >> 17) - lower * upper;
    // It is short by less than 10: 6 from y, 2 as `upper` is a floor, 1 from `low`, and 1 as it is a floor itself.
    // The same quotient of the remainder gives this shortfall, or one less.
    let short = ((left >> 2) * (y >> 2)) >> 27;
    lower += short;
    left -= short * upper;
    if left >= upper {
        left -= upper;
        lower += 1;
    }
    let root = (upper << 16).wrapping_add(lower);
    // The total remainder in units of 2¹⁶; its lowest 16 bits are those of `low`.
    if left >> 15 != 0 {
        return root;
    }
    let left = left << 17 | (low & 0x1_ffff);
    if lower >> 16 == 0 && left >= lower * lower {
        return root;
    }
    root.wrapping_sub(1)
}

/// Lower bound of 2³¹/√high for `high` from 2³⁰ up: never above it, and less than 3 below (tested).
const fn reciprocal_root(high: u32) -> u32 {
    let index = (high >> 24) as usize;
    let (from, to) = (RECIPROCAL[index], RECIPROCAL[index + 1]);
    let within = (high >> 8) & 0xffff;
    (from - (((from - to) * within) >> 16)) >> 5
}

/// Table of 2²⁴/√i, rounded down, minus the greatest excess of linear interpolation to the next entry.
///
/// Entries below 64 are never read; leaving them out would cost a subtraction.
static RECIPROCAL: [u32; 257] = reciprocals();

const fn reciprocals() -> [u32; 257] {
    let mut table = [0; 257];
    let mut i = 64;
    while i <= 256 {
        let exact = ((1_u128 << 48) / i).isqrt();
        // The curve lies below its chord by at most f''/8 = 3/32 · i^(-5/2). As the product in the interpolation is
        // rounded down, the line is raised by less than 1.
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
        assert_eq!(root(x), root_in_words(x), "of {x}");
        let Root { mantissa, shift } = root_in_words(x);
        let normalised = x << (2 * shift);
        assert_eq!(mantissa, normalised.isqrt() as u32, "of {x}");
        assert!(x == 0 || mantissa >> 31 == 1, "of {x}: {mantissa}");
    }

    /// Every upper half, with its extreme and middle remainders, and the lower words at which a bit moves from one part
    /// of the computation to another.
    #[test]
    fn root_is_the_floor_for_every_upper_half() {
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
    fn root_is_the_floor_at_squares_and_their_neighbours() {
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

    /// Upper words at a stride that is coprime to all powers of two, with the extremes of the lower word.
    #[test]
    fn root_is_the_floor_over_upper_words() {
        for high in (0..u32::MAX).step_by(4_099) {
            for low in [0, 1, 0x1_ffff, 0x2_0000, u32::MAX - 1, u32::MAX] {
                is_floor(u64::from(high) << 32 | u64::from(low));
            }
        }
    }

    #[test]
    fn root_is_the_floor_at_extremes() {
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
        fn root_is_the_floor_for_random_numbers(x: u64, zeros in 0_u32..64) {
            is_floor(x >> zeros);
        }
    }

    /// If this fails and the reciprocal is above the exact value, the products overflow and the floors are too high. If
    /// it is far below, the root takes more time.
    #[test]
    fn reciprocal_root_is_a_close_lower_bound() {
        let mut max_shortfall = 0.0_f64;
        for high in (1_u32 << 30..=u32::MAX).step_by(1_009).chain([u32::MAX]) {
            let short = 2_f64.powi(31) / f64::from(high).sqrt() - f64::from(reciprocal_root(high));
            assert!(short >= 0.0, "of {high}: over by {}", -short);
            max_shortfall = max_shortfall.max(short);
        }
        assert!(max_shortfall < 3.0, "{max_shortfall}");
    }

    /// The documented bound, over all sizes of argument.
    #[test]
    fn relative_error_is_below_two_to_the_minus_31() {
        let mut worst = 0.0_f64;
        let mut x = 1_u64;
        while x < u64::MAX / 3 * 2 {
            let Root { mantissa, shift } = root(x);
            let actual = f64::from(mantissa) / f64::from(1_u32 << shift);
            let expected = (x as f64).sqrt();
            worst = worst.max((actual - expected).abs() / expected);
            x += x / 1000 + 1;
        }
        assert!(worst < (-31.0_f64).exp2(), "{worst:e}");
    }
}
