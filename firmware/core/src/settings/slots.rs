//! Slots of the phase offsets: their length in ticks, and the motion of an axis in one of them.
//!
//! In its slot, an axis moves by whole steps to its phase offset, or not at all. One slot of each axis is a round.
//! [`crate::phase_offset`] moves the axes.

use super::{AxisSettings, Settings};

/// Steps that an axis moves in a tick of its slot, if it moves at its rate on average.
fn steps_per_tick(settings: &Settings, axis: &AxisSettings) -> f64 {
    let share = settings.axes.len() as f64 / f64::from(settings.tick_hz);
    axis.trim_rate_hz * axis.steps_per_crank_turn().to_f64() * share
}

/// Most steps of an axis in a slot of some ticks.
#[cold]
pub(crate) fn slot_steps(settings: &Settings, axis: &AxisSettings, slot_ticks: u32) -> u32 {
    let steps = libm::floor(steps_per_tick(settings, axis) * f64::from(slot_ticks));
    steps.max(1.0) as u32
}

/// Largest motion of any axis in a slot, turns. The settings must have been checked.
#[cold]
pub(crate) fn slot_turns(settings: &Settings) -> f64 {
    let ticks = slot_ticks(settings);
    let turns = |axis: &AxisSettings| {
        f64::from(slot_steps(settings, axis, ticks)) / axis.steps_per_crank_turn().to_f64()
    };
    settings.axes.iter().map(turns).fold(0.0, f64::max)
}

/// Shortest slot, in ticks, in which an axis uses at least four fifths of its rate with whole steps.
#[cold]
pub(crate) fn slot_ticks(settings: &Settings) -> u32 {
    let each = settings
        .axes
        .iter()
        .map(|axis| steps_per_tick(settings, axis));
    let steps_per_tick = each.fold(f64::INFINITY, f64::min);
    let is_used = |ticks: &u32| {
        let steps = steps_per_tick * f64::from(*ticks);
        libm::floor(steps) >= 0.8 * steps
    };
    let min = libm::ceil(1.0 / steps_per_tick).max(1.0) as u32;
    (min..u32::MAX).find(is_used).unwrap_or(min)
}
