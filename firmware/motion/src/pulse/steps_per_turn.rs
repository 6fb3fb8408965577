//! Steps per turn of a shaft, exactly: through a belt or a gearbox they are not always a whole number.

use crate::functions::{Ratio, multiply_long};
use crate::units::{FRACTION_BITS, ONE_TURN};

/// Steps, or counts, per turn of a shaft, as an exact ratio in lowest terms.
///
/// ```
/// use cophase_motion::pulse::StepsPerTurn;
/// let belt = StepsPerTurn::geared(3200, (57, 11)); // 57 turns of the motor are 11 of the shaft
/// assert_eq!(belt.to_f64(), 182_400.0 / 11.0);
/// assert_eq!(StepsPerTurn::geared(3200, (3, 1)), StepsPerTurn::whole(9600));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StepsPerTurn {
    steps: u32,
    turns: u32,
}

impl StepsPerTurn {
    /// Largest number of steps per turn that every calculation holds: 2²⁰. The bound is that of the phase offsets: a fifth of a turn of
    /// 2⁴⁸ units, times this, is below 2⁶³ after the eight bits that [`Self::distance`] drops above 2¹⁶ steps.
    pub const MAX: f64 = 1_048_576.0;

    /// A whole number of steps per turn, at least 1.
    pub const fn whole(steps: u32) -> Self {
        Self { steps, turns: 1 }
    }

    /// Steps per turn of a shaft, from those of its motor and the gear between: turns of the motor and turns of the shaft that belong
    /// together, each at least 1. The steps times the motor's turns must be below 2³².
    pub const fn geared(steps: u32, (motor_turns, shaft_turns): (u32, u32)) -> Self {
        let steps = steps.saturating_mul(motor_turns);
        let common = common_divisor(steps, shaft_turns);
        Self {
            steps: steps / common,
            turns: shaft_turns / common,
        }
    }

    /// True if a turn has a whole number of half-steps, so that no remainder is left to carry.
    pub const fn is_whole(self) -> bool {
        self.half_steps().1.is_none()
    }

    /// Steps per turn as one number, for set-up.
    pub fn to_f64(self) -> f64 {
        f64::from(self.steps) / f64::from(self.turns)
    }

    /// Turns of a number of steps, for set-up and simulation.
    pub fn turns_of(self, steps: f64) -> f64 {
        steps * f64::from(self.turns) / f64::from(self.steps)
    }

    /// One step in turns of 2⁻⁶⁴, rounded down; steps per turn must be above 1.
    pub const fn step_in_2_64(self) -> u64 {
        (((self.turns as u128) << 64) / self.steps as u128) as u64
    }

    /// One step in turns of 2⁻⁴⁸: the whole part, and the part that is carried as a [`Ratio`] per step.
    pub const fn step_turns(self) -> (i64, Ratio) {
        let all = ONE_TURN as u128 * self.turns as u128;
        let rest = (all % self.steps as u128) as u32;
        (
            (all / self.steps as u128) as i64,
            Ratio::new(rest, self.steps),
        )
    }

    /// Half-steps per turn: the whole ones, and the fraction of one that is left; `None` if nothing is left.
    pub(super) const fn half_steps(self) -> (u32, Option<Ratio>) {
        let all = 2 * self.steps as u64;
        let turns = self.turns as u64;
        let fraction = if all.is_multiple_of(turns) {
            None
        } else {
            Some(Ratio::new((all % turns) as u32, self.turns))
        };
        ((all / turns) as u32, fraction)
    }

    /// Distance in steps of 2⁻⁴⁸ of up to a fifth of a turn of 2⁻⁴⁸, modulo 2⁶⁴ and rounded down, and the same in whole steps, rounded to
    /// the nearest. With more than 2¹⁶ steps per turn, the nearest may be that of a turn of 2⁻⁴⁰.
    pub const fn distance(self, turns: i64) -> (i64, i32) {
        let shift = if self.steps > self.turns << 16 { 8 } else { 0 };
        let coarse = self.product(turns >> shift);
        let half_steps = (coarse >> (FRACTION_BITS - shift - 1)) as i32;
        (self.product(turns), (half_steps + 1) >> 1)
    }

    /// Product with a distance, modulo 2⁶⁴, rounded down.
    const fn product(self, turns: i64) -> i64 {
        if self.turns == 1 {
            return multiply_long(turns as u64, self.steps) as i64;
        }
        let Some(whole) = self.steps.checked_div(self.turns) else {
            return 0; // no constructor makes it 0, which the compiler cannot see
        };
        let mut fraction = Ratio::new(self.steps - whole * self.turns, self.turns);
        (multiply_long(turns as u64, whole) as i64).wrapping_add(fraction.advance(turns))
    }
}

const fn common_divisor(mut a: u32, mut b: u32) -> u32 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    if a == 0 { 1 } else { a }
}
