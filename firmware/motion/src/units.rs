//! Number formats of the tick: phase, speed, acceleration, jerk, amplitude and torque.
//!
//! *Turns* are fixed point with 48 fraction bits ([`Turns`]). A speed is in turns a tick, an acceleration in turns a
//! tick², a jerk in turns a tick³. All have that same format, so that one tick of integration is one addition without
//! rounding. The format has 48 bits rather than 32 because of small jerks. At a 10 kHz tick a jerk of 50 rev/s³ is
//! 5e-11 turns a tick³: a fifth of 2⁻³², but 14,000 times 2⁻⁴⁸.
//!
//! A [`Phase`] wraps at ±32,768 turns. Only differences of phases have a meaning. A difference is exact as long as the
//! two phases are less than 32,768 turns apart.

use fixed::types::{I16F16, I16F48, U16F48};

/// Standard gravity, m/s².
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;

/// Greatest number of axes of a machine; the smallest is 1.
pub const MAX_AXES: usize = 6;

/// One entry for each possible axis; entries of absent axes are zero or none.
pub type PerAxis<T> = [T; MAX_AXES];

/// A set of axes: a bit for each.
pub type AxisSet = u8;

/// Difference of phases in turns; also a speed in turns a tick, an acceleration (tick²) or a jerk (tick³).
///
/// Range ±32,768 turns, resolution 2⁻⁴⁸ turn (3.6e-15).
pub type Turns = I16F48;

/// Acceleration amplitude amax, in m/s². Range 0 to 65,536, resolution 2⁻⁴⁸.
pub type Amax = U16F48;

/// Torque in N·m. Range ±32,768, resolution 2⁻¹⁶.
pub type Torque = I16F16;

/// Fraction bits of [`Turns`].
pub const FRACTION_BITS: u32 = Turns::FRAC_NBITS;

/// One turn, in units of the last place of [`Turns`].
pub const ONE_TURN: i64 = 1 << FRACTION_BITS;

/// Angle of a shaft in turns, wrapping at ±32,768 turns; only differences have a meaning.
///
/// ```
/// use cophase_motion::units::{Phase, Turns};
/// let last = Phase::from_turns(Turns::MAX);
/// let step = Turns::from_num(0.25);
/// assert_eq!(last.advanced(step).since(last), step);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phase(Turns);

impl Phase {
    /// Phase zero: the angle of every index sensor, unless the settings of its axis differ.
    pub const ZERO: Self = Self(Turns::ZERO);

    /// Phase that lies `turns` after zero.
    pub const fn from_turns(turns: Turns) -> Self {
        Self(turns)
    }

    /// Phase that lies `by` further on; wraps.
    #[must_use]
    pub const fn advanced(self, by: Turns) -> Self {
        Self(self.0.wrapping_add(by))
    }

    /// Difference between this phase and `earlier`, in turns; exact within ±32,768 turns.
    pub const fn since(self, earlier: Self) -> Turns {
        self.0.wrapping_sub(earlier.0)
    }

    /// Fraction of the turn, from 0 up to but not including 1.
    pub const fn within_turn(self) -> Turns {
        Turns::from_bits(self.0.to_bits() & (ONE_TURN - 1))
    }
}

/// Wraps a difference to the nearest turn; the result lies from −½ up to but not including ½ turn. Exact.
pub const fn nearest(difference: Turns) -> Turns {
    const HALF: i64 = ONE_TURN / 2;
    let bits = difference.to_bits().wrapping_add(HALF) & (ONE_TURN - 1);
    Turns::from_bits(bits - HALF)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, wrapping loses bits, and a shaft jumps once every 32,768 turns.
    #[test]
    fn differences_are_exact_across_the_wrap() {
        let step = Turns::from_num(0.4);
        let last = Phase::from_turns(Turns::MAX);
        assert_eq!(last.advanced(step).since(last), step);
        assert_eq!(last.since(last.advanced(step)), -step);
    }

    #[test]
    fn within_turn_is_never_negative() {
        let behind = Phase::from_turns(Turns::from_num(-0.25));
        assert_eq!(behind.within_turn(), Turns::from_num(0.75));
    }

    #[test]
    fn nearest_takes_the_shorter_arc() {
        assert_eq!(nearest(Turns::from_num(0.75)), Turns::from_num(-0.25));
        assert_eq!(nearest(Turns::from_num(-7.25)), Turns::from_num(-0.25));
        assert_eq!(nearest(Turns::from_num(0.5)), Turns::from_num(-0.5));
        assert_eq!(nearest(Turns::from_num(0.25)), Turns::from_num(0.25));
    }
}
