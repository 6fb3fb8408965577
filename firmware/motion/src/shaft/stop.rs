//! Stop exactly at a chosen phase, at the first passage that the limits allow.
//!
//! The shaft eases ([`super::easing`]) until it must brake. The *slack* is the distance from the end of the fastest
//! brake that begins now to the phase. A brake that begins a tick later goes further by some D. As long as the slack is
//! at least D, the shaft eases for another tick. Then the two brakes, the one that begins now and the one that begins a
//! tick later, are blended so that they cover the slack exactly ([`super::blend`]).
//!
//! The braking distance is not summed tick by tick: [`super::brake`] has it in closed form, modulo a turn. So the slack
//! is the one to the first passage that can be reached. It is not computed in every tick either. Slack divided by the
//! most that a tick may use of it gives the number of ticks for which it lasts.

use super::blend::{Blend, State};
use super::brake::quotient;
use super::easing::Easing;
use super::gain::Step;
use super::limits::{RampLimits, ShaftLimits};
use super::regulator::Near;
use crate::units::{ONE_TURN, Phase, Turns};

/// A stop in progress.
#[derive(Clone, Debug)]
pub(super) struct StopPlan {
    /// Phase to stop at, a fraction of a turn.
    at: Turns,
    easing: Easing,
    /// Ticks for which the slack is guaranteed to last.
    lasts: u32,
    /// Braking distance from here, if the last tick computed it.
    distance: Option<i64>,
    brake: Option<Blend>,
    /// Steps of the gain of parking near the acceleration.
    near: Near,
}

impl StopPlan {
    /// Stop from a state of the shaft, at the first possible passage through `at`.
    pub fn new(state: State, at: Turns, limits: &ShaftLimits) -> Self {
        Self {
            at,
            easing: Easing::new(state, limits),
            lasts: 0,
            distance: None,
            brake: None,
            near: Near::ZERO,
        }
    }

    /// Speed of the coming tick, from the phase and state of the shaft.
    #[inline(never)] // The shaft's tick has no free registers for it.
    pub fn advance(&mut self, phase: Phase, state: State, limits: &ShaftLimits) -> i64 {
        if let Some(brake) = &mut self.brake {
            return brake.advance(&limits.parking);
        }
        let distance = self.distance.take();
        if self.lasts == 0 && !self.easing.is_ready(state, limits) {
            return self.easing.step_unready(state, limits).speed;
        }
        let later = self.easing.step(state, limits, &mut self.near);
        if self.lasts > 0 {
            self.lasts -= 1;
            if self.lasts == 0 {
                self.distance = Some(later.braking_distance(&limits.parking));
            }
        } else if let Some(brake) = self.search(distance, phase, state, later, &limits.parking) {
            return self.brake.insert(brake).advance(&limits.parking);
        }
        later.speed
    }

    /// Brake to start now, if the slack does not last for a tick that leads to the state `later`.
    fn search(
        &mut self,
        distance: Option<i64>,
        phase: Phase,
        state: State,
        later: State,
        limits: &RampLimits,
    ) -> Option<Blend> {
        let distance = distance.unwrap_or_else(|| state.braking_distance(limits));
        let ahead = self.at.wrapping_sub(phase.within_turn()).to_bits();
        let slack = ahead.wrapping_sub(distance) & (ONE_TURN - 1);
        let lasts = quotient(slack, self.easing.longest_distance(state));
        if lasts > 1 {
            // This tick is one of them.
            self.lasts = lasts - 1;
            return None;
        }
        let later_distance = later.braking_distance(limits);
        let further = |next: State, own_distance: i64| {
            own_distance.wrapping_add(next.speed).wrapping_sub(distance)
        };
        let most = further(later, later_distance);
        if slack >= most {
            self.distance = Some(later_distance);
            return None;
        }
        let earlier = state.braked(limits, &mut { Step::ZERO });
        // A tick that speeds up delays standstill by up to five ticks, any other tick by up to two.
        if !self.easing.speeds_up(state) {
            return Some(Blend::new(earlier, later, slack, most));
        }
        // Rounded up, so that the speed suffices for the release.
        let half = (later.acceleration - earlier.acceleration + 1) / 2;
        let between = state.after(earlier.acceleration + half);
        let least = further(between, between.braking_distance(limits));
        Some(if slack < least {
            Blend::new(earlier, between, slack, least)
        } else {
            Blend::new(between, later, slack - least, most - least)
        })
    }

    /// True when the shaft is at rest.
    pub const fn is_done(&self) -> bool {
        match &self.brake {
            Some(brake) => brake.is_done(),
            None => false,
        }
    }
}
