//! From the core's numbers to those of people. `fixed`'s own conversions are exact for every type and
//! slow; these are for [`Turns`] only, and for every tick.

use cophase_core::units::{ONE_TURN, Turns};

/// Turns as a float; exact below 32 turns.
pub fn turns(turns: Turns) -> f64 {
    turns.to_bits() as f64 / ONE_TURN as f64
}

/// Degrees.
pub fn degrees(angle: Turns) -> f64 {
    turns(angle) * 360.0
}

/// A speed in turns a tick, as rev/s.
pub fn speed_hz(speed: Turns, tick_hz: u32) -> f64 {
    turns(speed) * f64::from(tick_hz)
}
