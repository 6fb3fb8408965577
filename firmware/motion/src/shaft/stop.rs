//! A stop at a chosen phase, hit to the count, and no later than there is need.
//!
//! The shaft eases ([`super::easing`]) until it must brake. What the phase is beyond the way of the fastest brake
//! that begins now is the *slack*; braking a tick later goes further by some D. As long as the slack is at least D,
//! the shaft eases for another tick. Then the two brakes, the one that begins now and the one that begins a tick
//! later, are blended so that the slack is made up exactly ([`super::blend`]).
//!
//! The way of a brake is not summed up ahead: [`super::brake`] has it in closed form, modulo a turn, so that the
//! slack is that to the first passage that can be reached. It is not even asked in every tick: slack lasts for as
//! many ticks as it has of the most that a tick may take of it.

use super::blend::{Blend, State};
use super::brake::quotient;
use super::easing::Easing;
use super::limits::{RampLimits, ShaftLimits};
use crate::units::{ONE_TURN, Phase, Turns};

/// A stop that is under way.
#[derive(Clone, Debug)]
pub(super) struct StopPlan {
    /// The phase to stop at, a fraction of a turn.
    at: Turns,
    easing: Easing,
    /// Ticks for which the slack lasts for certain.
    lasts: u32,
    /// The way of a brake from here, if it was found a tick ago.
    way: Option<i64>,
    brake: Option<Blend>,
}

impl StopPlan {
    /// From how the shaft moves, a stop at the first possible passage through `at`.
    pub fn new(state: State, at: Turns, limits: &ShaftLimits) -> Self {
        Self {
            at,
            easing: Easing::new(state, limits),
            lasts: 0,
            way: None,
            brake: None,
        }
    }

    /// The speed of the coming tick, from where the shaft is and how it moves.
    pub fn advance(&mut self, phase: Phase, state: State, limits: &ShaftLimits) -> i64 {
        if let Some(brake) = &mut self.brake {
            return brake.advance(&limits.parking);
        }
        let way = self.way.take();
        if self.lasts == 0 && !self.easing.is_ready(state, limits) {
            return self.easing.step_unready(state, limits).speed;
        }
        let later = self.easing.step(state, limits);
        if self.lasts > 0 {
            self.lasts -= 1;
            if self.lasts == 0 {
                self.way = Some(later.braking_way(&limits.parking));
            }
        } else if let Some(brake) = self.look(way, phase, state, later, &limits.parking) {
            return self.brake.insert(brake).advance(&limits.parking);
        }
        later.speed
    }

    /// How to brake, if the slack does not last for a tick after which the shaft moves as in `later`.
    fn look(
        &mut self,
        way: Option<i64>,
        phase: Phase,
        state: State,
        later: State,
        limits: &RampLimits,
    ) -> Option<Blend> {
        let way = way.unwrap_or_else(|| state.braking_way(limits));
        let ahead = self.at.wrapping_sub(phase.within_turn()).to_bits();
        let slack = ahead.wrapping_sub(way) & (ONE_TURN - 1);
        let lasts = quotient(slack, self.easing.most_way(state));
        if lasts > 1 {
            // Less this one.
            self.lasts = lasts - 1;
            return None;
        }
        let later_way = later.braking_way(limits);
        let further =
            |next: State, its_way: i64| its_way.wrapping_add(next.speed).wrapping_sub(way);
        let most = further(later, later_way);
        if slack >= most {
            self.way = Some(later_way);
            return None;
        }
        let earlier = state.braked(limits);
        // A tick of speeding up makes the stand later by up to five, any other by up to two.
        if !self.easing.speeds_up(state) {
            return Some(Blend::new(earlier, later, slack, most));
        }
        // Rounded up, so that there is speed enough for letting it go.
        let half = (later.acceleration - earlier.acceleration + 1) / 2;
        let between = state.after(earlier.acceleration + half);
        let least = further(between, between.braking_way(limits));
        Some(if slack < least {
            Blend::new(earlier, between, slack, least)
        } else {
            Blend::new(between, later, slack - least, most - least)
        })
    }

    /// Whether the shaft stands.
    pub const fn is_done(&self) -> bool {
        match &self.brake {
            Some(brake) => brake.is_done(),
            None => false,
        }
    }
}
