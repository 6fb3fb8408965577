//! Easing: the part of a stop at a phase before the brake. The shaft releases its acceleration, then coasts.
//!
//! It coasts at the speed that remains then. Inside a forbidden band it goes to the lower edge instead. It never coasts
//! below the homing speed, as it might then never reach the phase.

use super::bands;
use super::blend::State;
use super::limits::{RampLimits, ShaftLimits};
use super::regulator::{self, Aim, Near};

/// Easing towards a speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Easing {
    /// The speed to coast at.
    pub coasting: i64,
}

impl Easing {
    /// Easing from a state of the shaft.
    pub fn new(state: State, limits: &ShaftLimits) -> Self {
        let State {
            speed,
            acceleration,
        } = state;
        let left = if acceleration < 0 {
            speed - limits.parking.let_go(-acceleration)
        } else {
            speed + limits.usual.let_go(acceleration)
        };
        let outside = bands::below_band(&limits.bands, left);
        Self {
            coasting: outside.max(limits.homing_speed).min(limits.speed),
        }
    }

    /// State after a tick, within the limits for parking.
    pub fn step(self, state: State, limits: &ShaftLimits, near: &mut Near) -> State {
        self.step_within(&limits.parking, state, limits, near)
    }

    /// State after a tick, within the usual limits, where the shaft must not brake yet.
    pub fn step_unready(self, state: State, limits: &ShaftLimits) -> State {
        self.step_within(&limits.usual, state, limits, &mut { Near::ZERO })
    }

    fn step_within(
        self,
        ramp: &RampLimits,
        state: State,
        limits: &ShaftLimits,
        near: &mut Near,
    ) -> State {
        state.after(regulator::acceleration(
            ramp,
            state.speed,
            state.acceleration,
            Aim::steady(self.coasting),
            0,
            limits.speed,
            near,
        ))
    }

    /// True if the shaft may brake, or ease, within the limits for parking.
    ///
    /// These are slightly gentler than the usual ones. To release a deceleration they may need more speed than the shaft
    /// has. They would also release an acceleration more slowly, so that the speed would rise higher than necessary.
    pub fn is_ready(self, state: State, limits: &ShaftLimits) -> bool {
        let State {
            speed,
            acceleration,
        } = state;
        let parking = &limits.parking;
        if acceleration <= parking.jerk {
            parking.can_brake(speed, acceleration)
        } else {
            speed + parking.let_go(acceleration) <= limits.homing_speed
        }
    }

    /// Greatest distance by which a tick of easing, now or later, lengthens the brake that follows it.
    ///
    /// - While coasting it is the speed.
    /// - While a deceleration is released, standstill comes at most two ticks later. A brake from v at a < 0 takes
    ///   (a + 2p)/J with p² = J v + a²/2, and from there on no tick is faster than v.
    /// - While the shaft speeds up to c, the distance grows most at standstill with the greatest acceleration that is
    ///   still to be released, a² = 2 J c: by 8.3 c.
    pub const fn longest_distance(self, state: State) -> i64 {
        if self.speeds_up(state) {
            9 * self.coasting
        } else if state.speed == self.coasting && state.acceleration == 0 {
            state.speed
        } else {
            2 * state.speed
        }
    }

    /// True if the shaft is below the speed to coast at.
    pub const fn speeds_up(self, state: State) -> bool {
        state.speed < self.coasting
    }
}
