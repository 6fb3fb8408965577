//! Shifts of 64-bit numbers that need only one word of the result.
//!
//! A Cortex-M0+ shifts words only and cannot count leading zeros. Through `u64` both are library calls, of 30 and of
//! 40 cycles. A processor with 64-bit registers has instructions for both.

/// Upper word of a number that is shifted up until its top bit is set, and the shift in bits. Zero gives (0, 64).
#[inline(always)]
pub const fn normalised(x: u64) -> (u32, u32) {
    if cfg!(target_pointer_width = "64") && x != 0 {
        let up = x.leading_zeros();
        return (((x << up) >> 32) as u32, up);
    }
    normalised_in_words(x)
}

#[inline(always)]
const fn normalised_in_words(x: u64) -> (u32, u32) {
    let (mut high, mut low, mut up) = ((x >> 32) as u32, x as u32, 0);
    if high == 0 {
        if low == 0 {
            return (0, 64);
        }
        (high, low, up) = (low, 0, 32);
    }
    if high >> 16 == 0 {
        (high, low, up) = (high << 16 | low >> 16, low << 16, up + 16);
    }
    if high >> 24 == 0 {
        (high, low, up) = (high << 8 | low >> 24, low << 8, up + 8);
    }
    if high >> 28 == 0 {
        (high, low, up) = (high << 4 | low >> 28, low << 4, up + 4);
    }
    if high >> 30 == 0 {
        (high, low, up) = (high << 2 | low >> 30, low << 2, up + 2);
    }
    if high >> 31 == 0 {
        (high, up) = (high << 1 | low >> 31, up + 1);
    }
    (high, up)
}

/// Upper word of `x` shifted up by `up` bits, from 0 to 63.
#[inline(always)]
pub const fn upper_word(x: u64, up: u32) -> u32 {
    if cfg!(target_pointer_width = "64") {
        return ((x << up) >> 32) as u32;
    }
    upper_word_in_words(x, up)
}

#[inline(always)]
const fn upper_word_in_words(x: u64, up: u32) -> u32 {
    let (high, low) = ((x >> 32) as u32, x as u32);
    if up >= 32 {
        return low << (up - 32);
    }
    // Two steps, as a word cannot be shifted by 32.
    high << up | low >> 1 >> (31 - up)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn zero_has_no_top_bit() {
        assert_eq!(normalised(0), (0, 64));
        assert_eq!(normalised_in_words(0), (0, 64));
    }

    proptest! {
        #[test]
        fn upper_words_match_a_64_bit_shift(bits: u64, zeros in 0_u32..64, up in 0_u32..64) {
            let x = bits >> zeros;
            let whole = ((x << up) >> 32) as u32;
            prop_assert_eq!([upper_word(x, up), upper_word_in_words(x, up)], [whole; 2]);
            if x != 0 {
                let up = x.leading_zeros();
                let whole = (((x << up) >> 32) as u32, up);
                prop_assert_eq!([normalised(x), normalised_in_words(x)], [whole; 2]);
            }
        }
    }
}
