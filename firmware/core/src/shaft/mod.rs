//! The master shaft: the only thing in the machine that is planned in time.
//!
//! Its phase is an integer, and every axis is derived from it. It follows the speed that the
//! program asks for as closely as its limits on speed, acceleration and jerk allow; crosses
//! forbidden bands without dwelling in them; and stops as fast as it can, or at a chosen phase. For a
//! stop as fast as it can, which a fault asks for, acceleration and jerk have limits of their own.
//!
//! Words: the *speed* is turns a tick and holds over a whole tick; the *acceleration* is the
//! difference of two speeds, the *jerk* of two accelerations. These are differences of integers, so
//! that "within the limits" is exact and can be checked on the phases alone.
//!
//! What it does not do: know why it should turn (the supervisor does), or what an axis makes of it.

mod bands;
mod blend;
mod brake;
mod easing;
mod gain;
mod limits;
mod regulator;
mod stop;

pub use bands::Band;
use limits::RampLimits;
pub use limits::ShaftLimits;

use crate::units::{Phase, Turns};
use bands::{Corridor, Passage};
use blend::State;
use regulator::Aim;
use stop::StopPlan;

/// What the shaft is to do in the coming tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Turn at a speed.
    Follow(Target),
    /// Come to rest: at the next possible passage through a phase (a fraction of a turn); or, with none, as fast as
    /// the limits of a fault's stop allow. That one, once asked for, goes on until the shaft stands.
    Stop(Option<Turns>),
    /// Be at rest this very tick. For when the drives have been cut off: nothing moves any more.
    Halt,
}

/// A speed to follow, turns a tick, none negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The speed asked for at the end of the tick before.
    pub now: Turns,
    /// The speed asked for at the end of the coming tick.
    pub next: Turns,
    /// The speed towards which the program is going; it is not overshot.
    pub end: Turns,
}

impl Target {
    /// One speed, for as long as it is asked for.
    pub const fn steady(speed: Turns) -> Self {
        Self {
            now: speed,
            next: speed,
            end: speed,
        }
    }
}

/// What the shaft did in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Turns in this tick: the speed, too.
    pub speed: Turns,
    /// Change of speed against the tick before.
    pub acceleration: Turns,
    /// The shaft stands, and has come to where it was to stop.
    pub at_rest: bool,
    /// The speed differs from what was asked by over 1/256 of it, for want of acceleration.
    pub lagging: bool,
    /// The speed asked for lies in a forbidden band: the nearer edge is kept instead.
    pub held_at_band: bool,
    /// The shaft is inside a forbidden band, on its way through.
    pub crossing_band: bool,
}

/// The master shaft.
#[derive(Clone, Debug)]
pub struct Shaft {
    limits: ShaftLimits,
    phase: Phase,
    speed: i64,
    acceleration: i64,
    mode: Mode,
    passage: Passage,
    /// Speeds around the last that lie in no band: as long as the speed and what is asked of it stay there, bands need not be looked at.
    gap: Corridor,
}

#[derive(Clone, Debug)]
enum Mode {
    Rest,
    Follow,
    /// Stopping by the shortest way, wherever that ends, within the limits for a fault's stop.
    StopFast,
    /// Stopping at a phase.
    StopAt(StopPlan),
}

impl Shaft {
    /// A shaft at rest at phase 0.
    pub const fn new(limits: ShaftLimits) -> Self {
        Self {
            limits,
            phase: Phase::ZERO,
            speed: 0,
            acceleration: 0,
            mode: Mode::Rest,
            passage: Passage::new(),
            gap: Corridor::NONE,
        }
    }

    /// Where the shaft is.
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// What it keeps within.
    pub const fn limits(&self) -> &ShaftLimits {
        &self.limits
    }

    /// Plays one tick.
    #[inline(never)]
    pub fn advance(&mut self, demand: Demand) -> Motion {
        self.heed(demand);
        let mut motion = Motion::default();
        let state = self.state();
        let speed = match &mut self.mode {
            Mode::Rest => 0,
            Mode::Follow => match demand {
                Demand::Follow(target) => self.follow(target, &mut motion),
                _ => 0,
            },
            Mode::StopFast => {
                let top = self.limits.speed;
                self.regulate(&self.limits.fault, Aim::steady(0), 0, top)
            }
            Mode::StopAt(plan) => plan.advance(self.phase, state, &self.limits),
        };
        motion.speed = Turns::from_bits(speed);
        motion.acceleration = Turns::from_bits(speed - self.speed);
        self.acceleration = speed - self.speed;
        self.speed = speed;
        self.phase = self.phase.advanced(motion.speed);
        if self.gap.holds(speed) {
            self.passage.observe_outside(speed);
        } else {
            self.passage.observe(&self.limits.bands, speed);
            self.gap = Corridor::gap(&self.limits, speed);
        }
        motion.crossing_band = self.passage.is_inside();
        let arrived = match &self.mode {
            Mode::Rest => true,
            Mode::StopFast => speed == 0 && self.acceleration == 0,
            Mode::StopAt(plan) => plan.is_done(),
            Mode::Follow => false,
        };
        if arrived {
            // The acceleration of this last tick stays: it counts for the jerk of the next.
            self.mode = Mode::Rest;
        }
        motion.at_rest = arrived;
        motion
    }

    /// Changes what the shaft is doing, where the demand has changed.
    fn heed(&mut self, demand: Demand) {
        match (demand, &self.mode) {
            (Demand::Halt, _) => {
                self.speed = 0;
                self.acceleration = 0;
                self.mode = Mode::Rest;
            }
            // A fault's stop may brake harder than the usual limits could let go before standstill: it goes on to its end.
            (Demand::Follow(_), Mode::Follow | Mode::StopFast) => {}
            (Demand::Follow(_), _) => self.mode = Mode::Follow,
            (Demand::Stop(_), Mode::Rest | Mode::StopFast) => {}
            (Demand::Stop(None), _) => self.mode = Mode::StopFast,
            (Demand::Stop(Some(at)), Mode::Follow) => {
                self.mode = Mode::StopAt(StopPlan::new(self.state(), at, &self.limits));
            }
            (Demand::Stop(Some(_)), Mode::StopAt(_)) => {}
        }
    }

    const fn state(&self) -> State {
        State {
            speed: self.speed,
            acceleration: self.acceleration,
        }
    }

    #[inline(never)]
    fn follow(&self, target: Target, motion: &mut Motion) -> i64 {
        let asked = (target.now.to_bits(), target.next.to_bits());
        let end = target.end.to_bits();
        let (corridor, aim, end) = if self.gap.holds(self.speed) && self.gap.holds(asked.1) {
            if self.acceleration == 0 && asked == (self.speed, self.speed) {
                return self.speed; // the speed is kept
            }
            let aim = Aim {
                now: self.gap.clamp(asked.0),
                next: asked.1,
            };
            (self.gap, aim, self.gap.clamp(end))
        } else {
            let corridor = Corridor::new(&self.limits, self.speed, self.passage, asked.1);
            let bands = &self.limits.bands;
            let next = bands::outside(bands, asked.1);
            motion.held_at_band = next != asked.1;
            let aim = Aim {
                now: corridor.clamp(bands::outside(bands, asked.0)),
                next: corridor.clamp(next),
            };
            (corridor, aim, corridor.clamp(bands::outside(bands, end)))
        };
        // Where the two differ by what the corridor cut off, the rest is a jump, not a rate.
        let aim = if (aim.now, aim.next) == asked {
            aim
        } else {
            Aim::steady(aim.next)
        };
        let (floor, ceiling) = if end >= aim.next {
            (corridor.floor, corridor.ceiling.min(end))
        } else {
            (corridor.floor.max(end), corridor.ceiling)
        };
        let speed = self.regulate(&self.limits.usual, aim, floor, ceiling);
        motion.lagging = speed.abs_diff(aim.next) > aim.next.unsigned_abs() >> 8;
        speed
    }

    /// The next speed on the way to `aim`, between `floor` and `ceiling` where that can still be.
    fn regulate(&self, limits: &RampLimits, aim: Aim, floor: i64, ceiling: i64) -> i64 {
        let acceleration =
            regulator::acceleration(limits, self.speed, self.acceleration, aim, floor, ceiling);
        self.speed + acceleration
    }
}

#[cfg(test)]
mod tests;
