//! Stop exactly at a chosen phase.
//!
//! The shaft eases ([`super::easing`]) until it must brake. The *slack* is the distance from the end of the fastest
//! brake that begins now to the phase. A brake that begins a tick later goes further by some D. As long as the slack is
//! at least D, the shaft eases for another tick. Then the two brakes, the one that begins now and the one that begins a
//! tick later, are blended so that they cover the slack exactly ([`super::blend`]).
//!
//! The braking distance is not summed tick by tick: [`super::brake`] has it in closed form, modulo a turn. So the slack
//! is the one to the first passage that can be reached. It is not computed in every tick either. Slack divided by the
//! most that a tick may use of it gives the number of ticks for which it lasts.
//!
//! The plan is one tick ahead of the shaft, so that no tick computes more than one braking distance. A brake begins
//! three ticks after the shaft is ready for it, or later. A passage for which that is too late is left out.

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
    stage: Stage,
    /// State to which the coming tick eases, once the shaft is ready.
    next: State,
    /// Steps of the gain of parking near the acceleration.
    near: Near,
}

/// Work of the coming tick, besides easing.
#[derive(Clone, Debug)]
enum Stage {
    /// The shaft may not brake within the limits for parking yet.
    Unready,
    /// There is none, up to the last of so many ticks. That one computes a braking distance.
    Easing(u32),
    /// Compares the slack, at the end of the tick, with what easing takes of it. The braking distance from there is known.
    Search(i64),
    /// Begins the brake.
    Due(Due),
    Brake(Blend),
}

/// Distances at the beginning of a brake.
#[derive(Clone, Copy, Debug)]
struct Due {
    /// Distance of the brake that begins now.
    distance: i64,
    slack: i64,
    /// Distance by which a brake that begins a tick later goes further.
    further: i64,
}

impl StopPlan {
    /// Stop from a state of the shaft, at the first passage through `at` that the plan can reach.
    pub fn new(state: State, at: Turns, limits: &ShaftLimits) -> Self {
        Self {
            at,
            easing: Easing::new(state, limits),
            stage: Stage::Unready,
            next: state,
            near: Near::ZERO,
        }
    }

    /// Speed of the coming tick, from the phase and state of the shaft.
    #[inline(never)] // The shaft's tick has no free registers for it.
    pub fn advance(&mut self, phase: Phase, state: State, limits: &ShaftLimits) -> i64 {
        match &mut self.stage {
            Stage::Brake(brake) => return brake.advance(&limits.parking),
            Stage::Due(due) => {
                let mut brake = due.brake(&self.easing, state, self.next, &limits.parking);
                let speed = brake.advance(&limits.parking);
                self.stage = Stage::Brake(brake);
                return speed;
            }
            Stage::Unready if !self.easing.is_ready(state, limits) => {
                return self.easing.step_unready(state, limits).speed;
            }
            Stage::Unready => {
                self.next = self.easing.step(state, limits, &mut self.near);
                self.stage = Stage::Easing(2);
            }
            Stage::Easing(_) | Stage::Search(_) => {}
        }
        let next = self.next;
        let later = self.easing.step(next, limits, &mut self.near);
        self.next = later;
        match &mut self.stage {
            Stage::Easing(ticks) if *ticks > 1 => *ticks -= 1,
            Stage::Search(distance) => {
                let distance = *distance;
                let passage = self.at.wrapping_sub(phase.within_turn()).to_bits();
                let slack = passage.wrapping_sub(next.speed).wrapping_sub(distance);
                self.stage = self.search(slack & (ONE_TURN - 1), distance, next, later, limits);
            }
            _ => self.stage = Stage::Search(later.braking_distance(&limits.parking)),
        }
        next.speed
    }

    /// Stage after a tick that ends in the state `next`, with the slack and the braking distance there. Easing leads from
    /// there to `later`.
    fn search(
        &self,
        slack: i64,
        distance: i64,
        next: State,
        later: State,
        limits: &ShaftLimits,
    ) -> Stage {
        let lasts = quotient(slack, self.easing.longest_distance(next));
        if lasts > 1 {
            return Stage::Easing(lasts - 1);
        }
        let later_distance = later.braking_distance(&limits.parking);
        let further = further(later, later_distance, distance);
        if slack >= further {
            Stage::Search(later_distance)
        } else {
            Stage::Due(Due {
                distance,
                slack,
                further,
            })
        }
    }

    /// True when the shaft is at rest.
    pub const fn is_done(&self) -> bool {
        match &self.stage {
            Stage::Brake(brake) => brake.is_done(),
            _ => false,
        }
    }
}

/// Distance by which a brake goes further than one of the length `distance`, if it begins in the state `next`, a tick later.
const fn further(next: State, own_distance: i64, distance: i64) -> i64 {
    own_distance.wrapping_add(next.speed).wrapping_sub(distance)
}

impl Due {
    /// Brake from `state`, with a share of the one that begins a tick later, in the state `later`.
    fn brake(self, easing: &Easing, state: State, later: State, limits: &RampLimits) -> Blend {
        let earlier = state.braked(limits, &mut { Step::ZERO });
        // A tick that speeds up delays standstill by up to five ticks, any other tick by up to two.
        if !easing.speeds_up(state) {
            return Blend::new(earlier, later, self.slack, self.further);
        }
        // Rounded up, so that the speed suffices for the release.
        let half = (later.acceleration - earlier.acceleration + 1) / 2;
        let between = state.after(earlier.acceleration + half);
        let min = further(between, between.braking_distance(limits), self.distance);
        if self.slack < min {
            Blend::new(earlier, between, self.slack, min)
        } else {
            Blend::new(between, later, self.slack - min, self.further - min)
        }
    }
}
