//! Master shaft: the only part of the machine that is planned in time.
//!
//! Its phase is an integer, and every axis derives from it. The shaft follows the requested speed as closely as its
//! limits on speed, acceleration and jerk allow, and crosses forbidden bands without dwelling in them. It stops at a
//! chosen phase, or as fast as possible after a fault. A fault stop has its own limits of acceleration and jerk.
//!
//! Terms: the *speed* is in turns a tick and is constant over a tick. The *acceleration* is the difference of two
//! speeds, the *jerk* the difference of two accelerations. These are differences of integers, so "within the limits" is
//! exact and can be checked on the phases alone.
//!
//! The supervisor decides why the shaft turns, and each axis decides how it follows; both are outside this module.

mod bands;
mod blend;
mod brake;
mod easing;
mod gain;
mod limits;
mod regulator;
mod stop;

pub use bands::Band;
pub use limits::ShaftLimits;

use crate::units::{Phase, Turns};
use bands::{Corridor, Passage};
use blend::State;
use regulator::{Aim, Near};
use stop::StopPlan;

/// Demand on the shaft for the coming tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Follow a speed.
    Follow(Target),
    /// Stop, at the next passage through a phase (a fraction of a turn) that can be reached.
    ///
    /// `None` is a fault stop, as fast as its own limits allow. Once demanded, a fault stop continues until the shaft is
    /// at rest.
    Stop(Option<Turns>),
    /// Set the shaft to rest in this tick. For drives that have been switched off (stop category 0).
    Halt,
}

/// Speed to follow, in turns a tick; no value may be negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Speed requested for the end of the tick before.
    pub now: Turns,
    /// Speed requested for the end of the coming tick.
    pub next: Turns,
    /// Final speed of the program's present ramp; the shaft does not overshoot it.
    pub end: Turns,
}

impl Target {
    /// Target of constant speed, in turns a tick.
    pub const fn steady(speed: Turns) -> Self {
        Self {
            now: speed,
            next: speed,
            end: speed,
        }
    }
}

/// Motion of the shaft in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Turns in this tick, which is also the speed in turns a tick.
    pub speed: Turns,
    /// Change of speed since the tick before, in turns a tick².
    pub acceleration: Turns,
    /// The shaft is at rest, and has reached the end of its stop.
    pub at_rest: bool,
    /// The speed differs from the requested one by over 1/256 of it, as the acceleration is limited.
    pub lagging: bool,
    /// The requested speed lies in a forbidden band, and the nearer edge replaces it.
    pub held_at_band: bool,
    /// The shaft is crossing a forbidden band.
    pub crossing_band: bool,
}

impl Motion {
    /// Motion of a shaft at rest.
    pub const AT_REST: Self = Self {
        speed: Turns::ZERO,
        acceleration: Turns::ZERO,
        at_rest: true,
        lagging: false,
        held_at_band: false,
        crossing_band: false,
    };
}

/// The master shaft: phase, speed, acceleration, and mode.
#[derive(Clone, Debug)]
#[repr(C)] // The fields that every tick needs come first: the board's instructions reach 128 bytes.
pub struct Shaft {
    phase: Phase,
    speed: i64,
    acceleration: i64,
    /// Speeds around the last that lie in no band. As long as the speed and the requested speed stay there, bands need not be checked.
    gap: Corridor,
    passage: Passage,
    /// Steps of the gain near the acceleration, for the limits of the present mode.
    near: Near,
    mode: Mode,
    limits: ShaftLimits,
}

#[derive(Clone, Debug)]
enum Mode {
    Rest,
    Follow,
    /// Stopping as fast as the limits of a fault stop allow, at any phase.
    StopFast,
    /// Stopping at a chosen phase.
    StopAt(StopPlan),
}

impl Shaft {
    /// Shaft at rest at phase 0.
    pub const fn new(limits: ShaftLimits) -> Self {
        Self {
            limits,
            phase: Phase::ZERO,
            speed: 0,
            acceleration: 0,
            mode: Mode::Rest,
            passage: Passage::new(),
            gap: Corridor::NONE,
            near: Near::ZERO,
        }
    }

    /// Phase of the shaft.
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// Limits of the shaft.
    pub const fn limits(&self) -> &ShaftLimits {
        &self.limits
    }

    /// Advances by one tick and returns the motion.
    ///
    /// For every sequence of demands speed, acceleration and jerk stay within the limits, exactly, and the shaft never
    /// turns back. [`Demand::Halt`] is the exception. A stop at a phase ends exactly at that phase.
    #[inline(never)]
    pub fn advance(&mut self, demand: Demand) -> Motion {
        self.obey(demand);
        let mut motion = Motion::default();
        let state = self.state();
        let speed = match &mut self.mode {
            Mode::Rest => 0,
            Mode::Follow => match demand {
                Demand::Follow(target) => self.follow(target, &mut motion),
                _ => 0,
            },
            Mode::StopFast => self.stop_fast(),
            Mode::StopAt(plan) => plan.advance(self.phase, state, &self.limits),
        };
        motion.speed = Turns::from_bits(speed);
        motion.acceleration = Turns::from_bits(speed - self.speed);
        self.acceleration = speed - self.speed;
        self.speed = speed;
        self.phase = self.phase.advanced(motion.speed);
        if self.gap.contains(speed) {
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
            // The acceleration of this last tick is kept, as it counts for the jerk of the next.
            self.mode = Mode::Rest;
        }
        motion.at_rest = arrived;
        motion
    }

    /// Changes the mode when the demand has changed.
    #[inline(always)]
    fn obey(&mut self, demand: Demand) {
        if !matches!((demand, &self.mode), (Demand::Follow(_), Mode::Follow)) {
            self.change_mode(demand);
        }
    }

    #[inline(never)]
    fn change_mode(&mut self, demand: Demand) {
        match (demand, &self.mode) {
            (Demand::Halt, _) => {
                self.speed = 0;
                self.acceleration = 0;
                self.mode = Mode::Rest;
            }
            // A fault stop may brake harder than the usual limits could release before standstill, so it continues to
            // its end.
            (Demand::Follow(_), Mode::Follow | Mode::StopFast) => {}
            (Demand::Follow(_), _) => {
                self.mode = Mode::Follow;
                self.near = Near::ZERO;
            }
            (Demand::Stop(_), Mode::Rest | Mode::StopFast) => {}
            (Demand::Stop(None), _) => {
                self.mode = Mode::StopFast;
                self.near = Near::ZERO;
            }
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
    fn stop_fast(&mut self) -> i64 {
        let acceleration = regulator::acceleration(
            &self.limits.fault,
            self.speed,
            self.acceleration,
            Aim::steady(0),
            0,
            self.limits.speed,
            &mut self.near,
        );
        self.speed + acceleration
    }

    #[inline(never)]
    fn follow(&mut self, target: Target, motion: &mut Motion) -> i64 {
        let requested = (target.now.to_bits(), target.next.to_bits());
        let end = target.end.to_bits();
        // The gap contains the present speed, or nothing.
        debug_assert!(self.gap.contains(self.speed) || self.gap == Corridor::NONE);
        let (corridor, aim, end) = if self.gap.contains(requested.1) {
            if self.acceleration == 0 && requested == (self.speed, self.speed) {
                return self.speed; // the speed is kept
            }
            let aim = Aim {
                now: self.gap.clamp(requested.0),
                next: requested.1,
            };
            (self.gap, aim, self.gap.clamp(end))
        } else {
            let corridor = Corridor::new(&self.limits, self.speed, self.passage, requested.1);
            let bands = &self.limits.bands;
            let next = bands::outside(bands, requested.1);
            motion.held_at_band = next != requested.1;
            let aim = Aim {
                now: corridor.clamp(bands::outside(bands, requested.0)),
                next: corridor.clamp(next),
            };
            (corridor, aim, corridor.clamp(bands::outside(bands, end)))
        };
        // Where the corridor has changed the aim, the difference is a jump and not a rate.
        let aim = if (aim.now, aim.next) == requested {
            aim
        } else {
            Aim::steady(aim.next)
        };
        let (floor, ceiling) = if end >= aim.next {
            (corridor.floor, corridor.ceiling.min(end))
        } else {
            (corridor.floor.max(end), corridor.ceiling)
        };
        let acceleration = regulator::acceleration(
            &self.limits.usual,
            self.speed,
            self.acceleration,
            aim,
            floor,
            ceiling,
            &mut self.near,
        );
        let speed = self.speed + acceleration;
        motion.lagging = speed.abs_diff(aim.next) > aim.next.unsigned_abs() >> 8;
        speed
    }
}

#[cfg(test)]
mod tests;
