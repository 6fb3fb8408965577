//! Motion in integer arithmetic: a jerk-limited master shaft, and a planner that turns its phase into step pulses.
//!
//! The crate is useful alone, on any `no_std` target. It needs no divider, no floating-point unit and no allocator, and
//! the same input gives the same bits everywhere.
//!
//! - [`units`]: phase, speed, acceleration and jerk as fixed-point turns and ticks.
//! - [`functions`]: products, quotients, roots, sine and cosine, with their error bounds.
//! - [`shaft`]: the master shaft. It follows a speed within limits on speed, acceleration and jerk, crosses forbidden
//!   bands, and stops as fast as possible or at a chosen phase.
//! - [`pulse`]: the step planner. It turns the phase covered in a tick into runs of (edges, period) that hardware plays.
//! - [`settings`]: limits and timing in Hz and nanoseconds, checked once.
//!
//! ```
//! use cophase_motion::pulse::{Planner, PulseTiming, Runs, StepRates, StepsPerTurn};
//! use cophase_motion::settings::{LimitSettings, PulseSettings};
//! use cophase_motion::shaft::{Demand, Shaft, ShaftLimits, Target};
//! use cophase_motion::units::Turns;
//!
//! const CLOCK_HZ: u32 = 125_000_000;
//! const TICK_HZ: u32 = 2000;
//! let limits = LimitSettings {
//!     speed_hz: 10.0,
//!     acceleration_hz_per_s: 50.0,
//!     jerk_hz_per_s2: 1000.0,
//!     stop_acceleration_hz_per_s: 100.0,
//!     stop_jerk_hz_per_s2: 2000.0,
//!     homing_speed_hz: 0.5,
//!     bands: heapless::Vec::new(),
//! };
//! limits.check(f64::from(TICK_HZ))?;
//! let lines = PulseSettings { width_ns: 400.0, dir_setup_ns: 500.0, dir_hold_ns: 500.0 };
//! lines.check()?;
//!
//! let mut shaft = Shaft::new(ShaftLimits::from_settings(&limits, TICK_HZ));
//! let timing = PulseTiming::new(&lines, CLOCK_HZ, TICK_HZ)?;
//! let mut planner = Planner::new(timing, StepsPerTurn::whole(3200));
//! let (mut rates, mut runs) = (StepRates::new(timing.tick()), Runs::new());
//! let five_turns_a_second = Target::steady(Turns::from_num(5.0 / f64::from(TICK_HZ)));
//! let mut steps = 0;
//! for _ in 0..TICK_HZ {
//!     let motion = shaft.advance(Demand::Follow(five_turns_a_second));
//!     steps += planner.plan(motion.speed, 0, &mut rates, &mut runs);
//!     // `runs` fill exactly one tick: pass them to the hardware.
//! }
//! assert!(steps > 3200 * 4);
//! # Ok::<(), cophase_motion::settings::SettingsError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod functions;
pub mod pulse;
pub mod settings;
pub mod shaft;
pub mod units;
