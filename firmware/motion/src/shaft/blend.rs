//! Blend of two brakes: the earlier one, plus a share λ of the extra distance of the later one.
//!
//! Both keep the limits of speed, acceleration and jerk, so the weighted mean with λ and 1 − λ keeps them too. The later
//! brake goes D further than the earlier. With λ = rest/D the shaft goes exactly `rest` further.
//!
//! The share is λ rounded up at 2⁻⁶³. That lengthens the distance by less than a unit as long as D is below 2⁶³, and
//! fractions of a unit are dropped. So the phase is rounded by less than a unit, the speed by less than one, the
//! acceleration by less than two and the jerk by less than four. The shaft never turns back, as rounding down keeps the
//! order of phases.

use super::brake::{Inverse, times};
use super::gain::Step;
use super::limits::RampLimits;
use super::regulator;
use crate::functions::multiply;

/// Speed and acceleration of a shaft, in units of 2⁻⁴⁸ turn a tick and a tick².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub speed: i64,
    pub acceleration: i64,
}

impl State {
    /// State after a tick with this acceleration.
    pub const fn after(self, acceleration: i64) -> Self {
        Self {
            speed: self.speed + acceleration,
            acceleration,
        }
    }

    /// State after a tick of braking.
    pub fn braked(self, limits: &RampLimits, near: &mut Step) -> Self {
        self.after(regulator::brake(
            limits,
            self.speed,
            self.acceleration,
            near,
        ))
    }

    /// Distance of the fastest brake, in units modulo 2⁶⁴.
    pub fn braking_distance(self, limits: &RampLimits) -> i64 {
        limits.braking_distance(self.speed, self.acceleration)
    }

    const fn stands(self) -> bool {
        self.speed == 0 && self.acceleration == 0
    }
}

/// Two brakes in progress, and their blend.
#[derive(Clone, Debug)]
pub(super) struct Blend {
    earlier: State,
    later: State,
    /// λ, in 2⁻⁶⁴.
    share: u64,
    /// Lead of the later brake over the earlier one.
    lead: i64,
    /// Part of the lead that the shaft has covered.
    taken: i64,
    /// Steps of the gain near the decelerations of the two.
    near: [Step; 2],
}

impl Blend {
    /// Blend of two brakes that start from the given states, reached in the coming tick.
    ///
    /// The later brake goes D = `further` units further than the earlier. The shaft is to go `rest` further than the
    /// earlier, 0 ≤ rest < D < 2⁶⁰.
    pub fn new(earlier: State, later: State, rest: i64, further: i64) -> Self {
        Self {
            earlier,
            later: if rest == 0 { earlier } else { later },
            share: share(rest, further),
            lead: 0,
            taken: 0,
            near: [Step::ZERO; 2],
        }
    }

    /// Speed of the coming tick; advances both brakes to the next.
    pub fn advance(&mut self, limits: &RampLimits) -> i64 {
        let speed = self.earlier.speed;
        self.lead += self.later.speed - speed;
        let taken = share_of(self.lead, self.share);
        let speed = speed + taken - self.taken;
        self.taken = taken;
        let [earlier, later] = &mut self.near;
        self.earlier = self.earlier.braked(limits, earlier);
        self.later = self.later.braked(limits, later);
        speed
    }

    /// True when both are at rest.
    pub const fn is_done(&self) -> bool {
        self.earlier.stands() && self.later.stands()
    }
}

/// Quotient `rest / whole` in 2⁻⁶⁴, rounded up to an even number; 0 ≤ rest < whole < 2⁶⁰.
fn share(rest: i64, whole: i64) -> u64 {
    const DIGIT: u32 = 21;
    let (mut share, mut rest) = (0, rest);
    let inverse = Inverse::new(whole);
    // Long division in three digits; the estimate of each is off by at most one.
    for _ in 0..63 / DIGIT {
        let mut digit = inverse.times(rest, DIGIT) as u32;
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

/// Product `distance · share / 2⁶⁴`, rounded down.
const fn share_of(distance: i64, share: u64) -> i64 {
    let (high, low) = (
        ((distance.unsigned_abs() >> 32) as u32),
        distance.unsigned_abs() as u32,
    );
    let (share_high, share_low) = ((share >> 32) as u32, share as u32);
    let lowest = multiply(low, share_low);
    let one = multiply(high, share_low) + (lowest >> 32);
    let other = multiply(low, share_high) + (one & 0xFFFF_FFFF);
    let whole = (multiply(high, share_high) + (one >> 32) + (other >> 32)) as i64;
    let rest = other as u32 | lowest as u32;
    if distance >= 0 {
        whole
    } else {
        -whole - (rest != 0) as i64
    }
}
