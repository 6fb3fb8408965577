//! Angles in 32 bits, and the common part of several of them.

use fixed::Wrapping;
use fixed::types::I0F32;

use crate::units::{AxisSet, FRACTION_BITS, MAX_AXES, PerAxis, Turns};

/// Angle within a turn, from −½ to ½ turn in units of 2⁻³² turn. It wraps with the turn, so no sum or difference has to be reduced.
pub type Angle = Wrapping<I0F32>;

const ANGLE_CUT: u32 = FRACTION_BITS - 32;

/// The part of these turns within a turn.
pub(super) const fn angle(turns: Turns) -> Angle {
    Wrapping(I0F32::from_bits((turns.to_bits() >> ANGLE_CUT) as i32))
}

/// The angle in turns.
pub(super) const fn of_angle(angle: Angle) -> Turns {
    Turns::from_bits((angle.0.to_bits() as i64) << ANGLE_CUT)
}

/// True if an angle, without its sign, is more than `limit` of at most half a turn.
pub(super) const fn exceeds(angle: Angle, limit: Turns) -> bool {
    angle.0.to_bits().unsigned_abs() > self::angle(limit).0.to_bits().unsigned_abs()
}

/// Common phase error of a set of axes. For a single axis, its own phase error.
#[inline(never)]
pub(super) fn in_common(errors: &PerAxis<Angle>, set: AxisSet) -> Angle {
    let mut angles = *errors;
    let mut count = 0;
    for (axis, &error) in errors.iter().enumerate() {
        if set & 1 << axis != 0
            && let Some(place) = angles.get_mut(count)
        {
            *place = error;
            count += 1;
        }
    }
    match angles.get_mut(..count) {
        Some([only]) => *only,
        Some(several) => middle(several),
        None => Angle::ZERO,
    }
}

/// Common part of `values`: their median, as few axes fail at once; 0 if there are fewer than two. Of two middle values it takes the
/// smaller. So if two axes differ, the one that moved more counts as moved. Sorts the values.
#[inline(never)]
pub(super) fn middle(values: &mut [Angle]) -> Angle {
    // There are at most six values. The sort of the core library would take longer, and would run from the flash.
    for placed in 1..values.len() {
        let Some((last, before)) = values.get_mut(..=placed).and_then(<[_]>::split_last_mut) else {
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
    let (low, high) = (
        values.get(count.saturating_sub(1) / 2),
        values.get(count / 2),
    );
    match (low, high) {
        (Some(&low), Some(&high)) if count > 1 => {
            if high.0.to_bits().unsigned_abs() < low.0.to_bits().unsigned_abs() {
                high
            } else {
                low
            }
        }
        _ => Angle::ZERO, // one axis alone shows no common part
    }
}

const _: () = assert!(MAX_AXES <= AxisSet::BITS as usize);

#[cfg(test)]
mod tests {
    use super::*;

    fn common(values: &[i32]) -> i32 {
        let mut angles: std::vec::Vec<_> = values
            .iter()
            .map(|&v| Wrapping(I0F32::from_bits(v)))
            .collect();
        middle(&mut angles).0.to_bits()
    }

    #[test]
    fn what_all_do_is_no_ones_own() {
        assert_eq!(common(&[-30, -30, -100, -30]), -30);
        assert_eq!(common(&[0, -72]), 0);
        assert_eq!(common(&[72, 0]), 0);
        assert_eq!(common(&[5]), 0);
        assert_eq!(common(&[]), 0);
        assert_eq!(common(&[9, 1, 8, 2, 7, i32::MIN]), 2);
    }
}
