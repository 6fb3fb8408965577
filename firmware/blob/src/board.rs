//! What the board that blobs are for can run: an RP2040 at 125 MHz, with STEP and DIR outputs.
//!
//! Settings that a simulated machine runs on may be too much for it. That is said when the blob is made, and
//! refused by the image, before a deadline is missed.

use cophase_core::settings::{AxisSettings, CLOCK_HZ, DriveKind, Settings};

/// What the loop hands over must be there so long before it is due, µs.
pub const LEAST_LEAD_US: u32 = 20;

/// Cycles that a tick takes at most, one in which a round of all index pulses ends, whatever the axes: found by
/// `tests/emulator/run cost`, with all
/// interrupts and something to spare.
const TICK_CYCLES: u32 = 9000;
/// What each axis adds,
const AXIS_CYCLES: u32 = 1800;
/// and each piece of its step pulses that the planner takes at once.
const CHUNK_CYCLES: u32 = 90;
const CHUNK_EDGES: f64 = 64.0;

/// Why a board will not run settings that is sound in itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unfit {
    /// There is no fieldbus for setpoints.
    #[error(
        "axis {0} is a servo that takes setpoints over a fieldbus, which the board does not have; give drive = \"pulse-servo\" for a drive \
         that takes STEP and DIR"
    )]
    Servo(usize),
    /// There are no inputs for encoders.
    #[error(
        "axis {0} has an encoder, and the board has no pins left to count with; take `encoder` away, or run it on the host"
    )]
    Encoder(usize),
    /// The loop cannot do its work in a tick.
    #[error(
        "control.tick_hz: at {tick_hz} Hz a tick is too short for {axes} axes with so many steps; \
         give at most {most_hz} Hz"
    )]
    TickTooShort {
        /// As set.
        tick_hz: u32,
        /// How many axes there are.
        axes: usize,
        /// The highest rate that will do.
        most_hz: u32,
    },
}

/// Whether the board can run settings, whose numbers are taken to be sound otherwise.
///
/// # Errors
/// What it lacks for that.
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
        let ratio = f64::from(axis.ratio.0) / f64::from(axis.ratio.1);
        let steps_hz = settings.limits.speed_hz * ratio * f64::from(axis.steps_per_turn);
        // One piece more than fits: they do not begin with the tick.
        let chunks = 1.0 + 2.0 * steps_hz / f64::from(tick_hz) / CHUNK_EDGES;
        f64::from(AXIS_CYCLES) + f64::from(CHUNK_CYCLES) * chunks
    };
    let cycles: f64 = settings.axes.iter().map(axis_cycles).sum();
    let lead_cycles = LEAST_LEAD_US * (CLOCK_HZ / 1_000_000);
    f64::from(TICK_CYCLES + lead_cycles) + cycles <= f64::from(CLOCK_HZ / tick_hz)
}
