//! Until a stop at a phase brakes: the shaft lets its acceleration go, then coasts.
//!
//! It coasts at what is left of the speed then; but not inside a forbidden band, below which it goes instead, and not
//! below creeping, or the passage might never come.

use super::bands;
use super::blend::State;
use super::limits::{RampLimits, ShaftLimits};
use super::regulator::{self, Aim};

/// Easing towards a speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Easing {
    /// The speed to coast at.
    pub coasting: i64,
}

impl Easing {
    /// From how the shaft moves.
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
            coasting: outside.max(limits.creep).min(limits.speed),
        }
    }

    /// A tick on.
    pub fn step(self, state: State, limits: &ShaftLimits) -> State {
        self.step_within(&limits.parking, state, limits)
    }

    /// A tick on from where the shaft must not brake yet.
    pub fn step_unready(self, state: State, limits: &ShaftLimits) -> State {
        self.step_within(&limits.usual, state, limits)
    }

    fn step_within(self, ramp: &RampLimits, state: State, limits: &ShaftLimits) -> State {
        state.after(regulator::acceleration(
            ramp,
            state.speed,
            state.acceleration,
            Aim::steady(self.coasting),
            0,
            limits.speed,
        ))
    }

    /// Whether the shaft may brake, or ease, within the limits for parking.
    ///
    /// A little gentler than the usual ones, they may want more speed for letting a deceleration go than there is.
    /// And they would let an acceleration go more slowly: the speed would rise higher than it must.
    pub fn is_ready(self, state: State, limits: &ShaftLimits) -> bool {
        let State {
            speed,
            acceleration,
        } = state;
        let parking = &limits.parking;
        if acceleration <= parking.jerk {
            parking.can_brake(speed, acceleration)
        } else {
            speed + parking.let_go(acceleration) <= limits.creep
        }
    }

    /// The most by which a tick of this makes the way of a brake that follows it longer, now and later.
    ///
    /// Coasting, it is the speed. While a deceleration is let go, the stand comes two ticks later at most: a brake
    /// from v at a < 0 takes (a + 2p)/J, p² = J v + a²/2, and coming from there no tick is faster than v. While the
    /// shaft speeds up, to c, the way grows most at a stand with all the acceleration that is to be let go then, a² =
    /// 2 J c: by 8.3 c.
    pub const fn most_way(self, state: State) -> i64 {
        if self.speeds_up(state) {
            9 * self.coasting
        } else if state.speed == self.coasting && state.acceleration == 0 {
            state.speed
        } else {
            2 * state.speed
        }
    }

    /// Whether the shaft is below the speed to coast at.
    pub const fn speeds_up(self, state: State) -> bool {
        state.speed < self.coasting
    }
}
