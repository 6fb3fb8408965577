//! Two brakes in one: all of one and a part λ of what the other goes further.
//!
//! Both keep limits of speed, acceleration and jerk, so λ of one and 1 − λ of the other do. With λ = rest/D, where the
//! later brake goes D further than the earlier, the shaft goes `rest` further, to the count.
//!
//! The share is λ rounded up at 2⁻⁶³; that makes the way greater by less than a unit as long as D is below 2⁶³, and
//! what is below a unit is dropped. So the phase is rounded by less than a unit, hence the speed by less than one,
//! the acceleration by less than two and the jerk by less than four. It never turns the shaft back: phases rounded
//! down are in the order of those that are not.

use super::brake::{about, times};
use super::limits::RampLimits;
use super::regulator;
use crate::functions::multiply;

/// How a shaft moves: turns a tick, and a tick².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub speed: i64,
    pub acceleration: i64,
}

impl State {
    /// A tick on, with this acceleration.
    pub const fn after(self, acceleration: i64) -> Self {
        Self {
            speed: self.speed + acceleration,
            acceleration,
        }
    }

    /// A tick on, braking.
    pub fn braked(self, limits: &RampLimits) -> Self {
        self.after(regulator::brake(limits, self.speed, self.acceleration))
    }

    /// How far the fastest brake goes: units, modulo 2⁶⁴.
    pub fn braking_way(self, limits: &RampLimits) -> i64 {
        limits.braking_way(self.speed, self.acceleration)
    }

    const fn stands(self) -> bool {
        self.speed == 0 && self.acceleration == 0
    }
}

/// Two brakes that are under way, and what is taken of either.
#[derive(Clone, Debug)]
pub(super) struct Blend {
    earlier: State,
    later: State,
    /// λ, in 2⁻⁶⁴.
    share: u64,
    /// How much further the later has come.
    apart: i64,
    /// How much of that was taken.
    taken: i64,
}

impl Blend {
    /// From two states that are reached in the coming tick, of which the later brakes over a way `further` by D; the
    /// shaft is to go `rest` further than the earlier, 0 ≤ rest < D < 2⁶⁰.
    pub fn new(earlier: State, later: State, rest: i64, further: i64) -> Self {
        Self {
            earlier,
            later: if rest == 0 { earlier } else { later },
            share: share(rest, further),
            apart: 0,
            taken: 0,
        }
    }

    /// The speed of the coming tick; readies those of the next.
    pub fn advance(&mut self, limits: &RampLimits) -> i64 {
        let speed = self.earlier.speed;
        self.apart += self.later.speed - speed;
        let taken = part(self.apart, self.share);
        let speed = speed + taken - self.taken;
        self.taken = taken;
        self.earlier = self.earlier.braked(limits);
        self.later = self.later.braked(limits);
        speed
    }

    /// Whether both stand from now on.
    pub const fn is_done(&self) -> bool {
        self.earlier.stands() && self.later.stands()
    }
}

/// `rest / whole` in 2⁻⁶⁴, rounded up to an even number; 0 ≤ rest < whole < 2⁶⁰.
fn share(rest: i64, whole: i64) -> u64 {
    const DIGIT: u32 = 21;
    let (mut share, mut rest) = (0, rest);
    // By long division in three digits, each of which is known but for one.
    for _ in 0..63 / DIGIT {
        let mut digit = about(rest, whole, DIGIT);
        rest = (rest << DIGIT).wrapping_sub(times(digit, whole));
        if rest < 0 {
            (digit, rest) = (digit - 1, rest + whole);
        } else if rest >= whole {
            (digit, rest) = (digit + 1, rest - whole);
        }
        share = share << DIGIT | u64::from(digit);
    }
    (share + u64::from(rest > 0)) << 1
}

/// `way · share / 2⁶⁴`, rounded down.
const fn part(way: i64, share: u64) -> i64 {
    let (high, low) = (
        ((way.unsigned_abs() >> 32) as u32),
        way.unsigned_abs() as u32,
    );
    let (share_high, share_low) = ((share >> 32) as u32, share as u32);
    let lowest = multiply(low, share_low);
    let one = multiply(high, share_low) + (lowest >> 32);
    let other = multiply(low, share_high) + (one & 0xFFFF_FFFF);
    let whole = (multiply(high, share_high) + (one >> 32) + (other >> 32)) as i64;
    let rest = other as u32 | lowest as u32;
    if way >= 0 {
        whole
    } else {
        -whole - (rest != 0) as i64
    }
}
