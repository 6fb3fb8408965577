//! Widths that are derived from the settings of an axis: tolerance, gate, and slow speed.

use crate::settings::{AxisSettings, turns};
use crate::units::Turns;

/// Largest error of a reading of an axis: that of the settings, and two steps.
pub(super) fn tolerance(axis: &AxisSettings, reading: Turns) -> Turns {
    let step = turns(1.0 / f64::from(axis.steps_per_turn));
    reading.saturating_add(step).saturating_add(step)
}

/// An electrical cycle, turns; zero of an axis that has none.
pub(super) fn cycle(axis: &AxisSettings) -> Turns {
    turns(f64::from(axis.cycle_steps) / f64::from(axis.steps_per_turn))
}

/// Gate: half an electrical cycle less the error of a reading, but at least the largest difference of two readings.
pub(super) fn gate(tolerance: Turns, cycle: Turns) -> Turns {
    let widest = Turns::from_bits(tolerance.to_bits() * 4);
    if cycle <= 0 {
        return widest;
    }
    let (half, tolerance) = (cycle.to_bits() / 2, tolerance.to_bits());
    // If steps are so coarse that this is below the largest difference of two readings, the gate is half a cycle.
    let sure = half - tolerance;
    let most = if sure < 2 * tolerance { half } else { sure };
    widest.min(Turns::from_bits(most))
}

/// Greatest speed, in tolerances per second, of a rotor that swings by one tolerance at 16 Hz: 2π · 16. Motors with their loads swing at
/// this rate or above.
const SWING_PER_S: f64 = 100.0;

/// Commanded turns of a tick up to which a swinging rotor may go back.
pub(super) fn slow(tolerance: Turns, tick_hz: u32) -> Turns {
    turns(tolerance.to_num::<f64>() * SWING_PER_S / f64::from(tick_hz))
}

/// Largest distance, turns, of an axis's index pulse from the place that the pulse before gives, at which it is still in place.
/// `reading_error_deg` is that of the settings.
#[cold]
pub fn place_gate(axis: &AxisSettings, reading_error_deg: f64) -> Turns {
    gate(
        tolerance(axis, turns(reading_error_deg / 360.0)),
        cycle(axis),
    )
}
