//! The numbers that the tick works with, and what they mean.
//!
//! *Turns* are fixed point with 48 fraction bits ([`Turns`]). A speed is turns a tick, an
//! acceleration turns a tick², a jerk turns a tick³, all in that same format, so that one tick of
//! integration is one addition and nothing is ever rounded. 48 bits rather than 32, because at a
//! 10 kHz tick a jerk of 50 rev/s³ is 5e-11 turns a tick³: a fifth of 2⁻³², but 14,000 of 2⁻⁴⁸.
//!
//! A [`Phase`] wraps at ±32,768 turns. Only differences of phases mean anything, and those are
//! exact as long as the two are less than 32,768 turns apart.

use fixed::types::{I16F16, I16F48, U16F48};

/// Most axes that a machine may have; the least is 1.
pub const MAX_AXES: usize = 6;

/// One entry for each axis that a machine may have; entries of axes that it does not have are zero or none.
pub type PerAxis<T> = [T; MAX_AXES];

/// A difference of phases, in turns; also turns a tick, a tick² and a tick³.
///
/// Range ±32,768 turns, resolution 2⁻⁴⁸ turn (3.6e-15).
pub type Turns = I16F48;

/// An acceleration amplitude amax, in m/s². Range 0 to 65,536, resolution 2⁻⁴⁸.
pub type Amax = U16F48;

/// A torque, in N·m. Range ±32,768, resolution 2⁻¹⁶.
pub type Torque = I16F16;

/// Fraction bits of [`Turns`].
pub const FRACTION_BITS: u32 = Turns::FRAC_NBITS;

/// One turn, in units of the last place of [`Turns`].
pub const ONE_TURN: i64 = 1 << FRACTION_BITS;

/// The angle of a shaft, in turns, wrapping: only differences mean something.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phase(Turns);

impl Phase {
    /// The angle at which every index sensor stands unless its axis says otherwise.
    pub const ZERO: Self = Self(Turns::ZERO);

    /// The phase that lies `turns` after zero.
    pub const fn from_turns(turns: Turns) -> Self {
        Self(turns)
    }

    /// The phase `by` further on; wraps.
    #[must_use]
    pub const fn advanced(self, by: Turns) -> Self {
        Self(self.0.wrapping_add(by))
    }

    /// How far this phase is past `earlier`, exact within ±32,768 turns.
    pub const fn since(self, earlier: Self) -> Turns {
        self.0.wrapping_sub(earlier.0)
    }

    /// The part within the turn, from 0 up to but not including 1.
    pub const fn within_turn(self) -> Turns {
        Turns::from_bits(self.0.to_bits() & (ONE_TURN - 1))
    }
}

/// Wraps a difference to the nearest turn: the result is from −½ up to but not including ½.
pub const fn nearest(difference: Turns) -> Turns {
    const HALF: i64 = ONE_TURN / 2;
    let bits = difference.to_bits().wrapping_add(HALF) & (ONE_TURN - 1);
    Turns::from_bits(bits - HALF)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Were wrapping lossy, a shaft would jump once every 32,768 turns.
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
    fn nearest_goes_the_short_way_round() {
        assert_eq!(nearest(Turns::from_num(0.75)), Turns::from_num(-0.25));
        assert_eq!(nearest(Turns::from_num(-7.25)), Turns::from_num(-0.25));
        assert_eq!(nearest(Turns::from_num(0.5)), Turns::from_num(-0.5));
        assert_eq!(nearest(Turns::from_num(0.25)), Turns::from_num(0.25));
    }
}
