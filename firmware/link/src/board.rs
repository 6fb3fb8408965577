//! Capabilities of the board: an RP2040 at 125 MHz, with STEP and DIR outputs.
//!
//! Settings of a simulated machine may exceed them. This is reported when the settings file is made. The firmware
//! refuses such settings too, before a deadline is missed.

use cophase_core::settings::{AxisSettings, CLOCK_HZ, DriveKind, Settings};

/// Time by which the loop must submit its output before it is due, µs.
pub const LEAST_LEAD_US: u32 = 10;

/// Greatest cycles of a tick without its axes, measured by `tests/emulator/run cost` (scene `alike`), with a margin for other
/// interrupts. In the longest tick the index pulses of all axes are confirmed at once while the shaft changes its acceleration.
const TICK_CYCLES: u32 = 10_700;
/// Cycles that each axis adds then.
const AXIS_CYCLES: u32 = 450;
/// Cycles that an axis adds which does not make the master's own turns: 614 were measured for a cam table, and less for a gear.
const FOLLOWER_CYCLES: u32 = 650;
/// Cycles that each chunk of an axis's step pulses adds; the planner processes a chunk at once.
const CHUNK_CYCLES: u32 = 80;
const CHUNK_EDGES: f64 = 64.0;

/// Reason why the board cannot run settings that are valid in themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unfit {
    /// The board has no fieldbus for setpoints.
    #[error(
        "axis {0} is a servo that takes setpoints over a fieldbus, which the board does not have; give drive = \"pulse-servo\" for a drive \
         that takes STEP and DIR"
    )]
    Servo(usize),
    /// The board has no inputs for encoders.
    #[error(
        "axis {0} has an encoder, and the board has no pins left to count with; remove `encoder`, or run it on the host"
    )]
    Encoder(usize),
    /// The loop cannot finish its work within a tick.
    #[error(
        "control.tick_hz: at {tick_hz} Hz a tick is too short for {axes} axes at this step rate; \
         give at most {most_hz} Hz"
    )]
    TickTooShort {
        /// Tick rate of the settings, Hz.
        tick_hz: u32,
        /// Number of axes.
        axes: usize,
        /// Highest tick rate that the board can run, Hz.
        most_hz: u32,
    },
}

/// Checks that the board can run settings. Their numbers must be valid otherwise.
///
/// # Errors
/// The first reason why the board cannot run them.
pub fn check(settings: &Settings) -> Result<(), Unfit> {
    let servo = |axis: &AxisSettings| axis.drive == DriveKind::Servo;
    if let Some(axis) = settings.axes.iter().position(servo) {
        return Err(Unfit::Servo(axis));
    }
    if let Some(axis) = settings.axes.iter().position(|axis| axis.encoder) {
        return Err(Unfit::Encoder(axis));
    }
    if has_time(settings, settings.tick_hz) {
        return Ok(());
    }
    // A tick is a whole number of microseconds (`control.tick_hz`).
    let rates = (1..settings.tick_hz).rev();
    let most_hz = rates
        .filter(|hz| 1_000_000 % hz == 0)
        .find(|&hz| has_time(settings, hz));
    Err(Unfit::TickTooShort {
        tick_hz: settings.tick_hz,
        axes: settings.axes.len(),
        most_hz: most_hz.unwrap_or(1),
    })
}

fn has_time(settings: &Settings, tick_hz: u32) -> bool {
    let axis_cycles = |axis: &AxisSettings| {
        let ratio = axis.follower.most_ratio(settings);
        let steps_hz = settings.limits.speed_hz * ratio * f64::from(axis.steps_per_turn);
        // One chunk more, as chunks do not begin with the tick.
        let chunks = 1.0 + 2.0 * steps_hz / f64::from(tick_hz) / CHUNK_EDGES;
        let is_direct = axis.follower.constant_ratio() == Some(1.0);
        let follower = if is_direct { 0 } else { FOLLOWER_CYCLES };
        f64::from(AXIS_CYCLES + follower) + f64::from(CHUNK_CYCLES) * chunks
    };
    let cycles: f64 = settings.axes.iter().map(axis_cycles).sum();
    let lead_cycles = LEAST_LEAD_US * (CLOCK_HZ / 1_000_000);
    f64::from(TICK_CYCLES + lead_cycles) + cycles <= f64::from(CLOCK_HZ / tick_hz)
}
