//! Angles in 32 bits, and the common part of several of them.

use super::modes::AxisSet;
use crate::units::{FRACTION_BITS, MAX_AXES, PerAxis, Turns};

/// Angle in units of 2⁻³² turn. It wraps with the turn, so no sum or difference has to be reduced.
pub(in crate::drift) const fn angle(turns: Turns) -> i32 {
    (turns.to_bits() >> ANGLE_CUT) as i32
}

const ANGLE_CUT: u32 = FRACTION_BITS - 32;

pub(in crate::drift) fn of_angle(angle: i32) -> Turns {
    Turns::from_bits(i64::from(angle) << ANGLE_CUT)
}

/// Angles of up to all axes.
pub(in crate::drift) type Angles = heapless::Vec<i32, MAX_AXES>;

/// Common phase error of a set of axes. For a single axis, its own phase error.
#[inline(never)]
pub(in crate::drift) fn in_common(errors: &PerAxis<Turns>, set: AxisSet) -> Turns {
    let mut angles = Angles::new();
    for (axis, &error) in errors.iter().enumerate() {
        if set & 1 << axis != 0 {
            let _ = angles.push(angle(error)); // There is room.
        }
    }
    of_angle(match angles.as_mut_slice() {
        [only] => *only,
        several => middle(several),
    })
}

/// Common part of `values`, wrapping angles: their median, as few axes fail at once; 0 if there are fewer than two. Of two middle values it
/// takes the smaller. So if two axes differ, the one that moved more counts as moved. Sorts the values.
#[inline(never)]
pub(in crate::drift) fn middle(values: &mut [i32]) -> i32 {
    // There are at most six values. The sort of the core library would take longer, and would run from the flash.
    for placed in 1..values.len() {
        let Some((last, before)) = values.get_mut(..=placed).and_then(<[i32]>::split_last_mut)
        else {
            break;
        };
        let mut held = *last;
        for value in before.iter_mut() {
            if *value > held {
                core::mem::swap(value, &mut held);
            }
        }
        *last = held;
    }
    let count = values.len();
    if count < 2 {
        return 0; // one axis alone shows no common part
    }
    let low = values.get(count.saturating_sub(1) / 2).copied();
    let high = values.get(count / 2).copied();
    match (low, high) {
        (Some(low), Some(high)) if high.unsigned_abs() < low.unsigned_abs() => high,
        (Some(low), _) => low,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_all_do_is_no_ones_own() {
        assert_eq!(middle(&mut [-30, -30, -100, -30]), -30);
        assert_eq!(middle(&mut [0, -72]), 0);
        assert_eq!(middle(&mut [72, 0]), 0);
        assert_eq!(middle(&mut [5]), 0);
        assert_eq!(middle(&mut []), 0);
        assert_eq!(middle(&mut [9, 1, 8, 2, 7, i32::MIN]), 2);
    }
}
