//! From the core's numbers to those of people. `fixed`'s own conversions are exact for every type and
//! slow; these are for few types, and for every tick.

use cophase_core::units::{Amax, ONE_TURN, Torque, Turns};

/// Turns as a float; exact below 32 turns.
pub fn turns(turns: Turns) -> f64 {
    turns.to_bits() as f64 / ONE_TURN as f64
}

/// Amplitude, m/s², rounded to 53 bits.
pub fn mps2(amax: Amax) -> f64 {
    amax.to_bits() as f64 / (1_u64 << Amax::FRAC_NBITS) as f64
}

/// Torque, N·m; exact.
pub fn nm(torque: Torque) -> f64 {
    f64::from(torque.to_bits()) / f64::from(1 << Torque::FRAC_NBITS)
}

/// Degrees.
pub fn degrees(angle: Turns) -> f64 {
    turns(angle) * 360.0
}

/// A speed in turns a tick, as rev/s.
pub fn speed_hz(speed: Turns, tick_hz: u32) -> f64 {
    turns(speed) * f64::from(tick_hz)
}
