//! RP2040 at 125 MHz, with STEP and DIR outputs. `firmware/src/board` is its hardware.

use cophase_core::settings::{AxisSettings, DriveKind, Settings};

use super::{Board, Unfit};

/// Greatest cycles of a tick without its axes, measured by `tests/emulator/run cost` (scene `alike`), with a margin for other
/// interrupts. In the longest tick the index pulses of all axes are confirmed at once while the shaft changes its acceleration.
const TICK_CYCLES: u32 = 10_700;
/// Cycles that each axis adds in that tick.
const AXIS_CYCLES: u32 = 450;
/// Additional cycles of an axis whose turns differ from the master's. 614 were measured for a cam table (`tests/emulator/run --profile`),
/// and fewer for a gear.
const FOLLOWER_CYCLES: u32 = 650;
/// Additional cycles of an axis whose gear leaves a fraction of a half-step per crank turn: the division of a follower's gear, and less
/// than its follower.
const GEAR_CYCLES: u32 = FOLLOWER_CYCLES;
/// Cycles that each chunk of an axis's step pulses adds. The planner processes a chunk at once.
const CHUNK_CYCLES: u32 = 80;
const CHUNK_EDGES: f64 = 64.0;

/// Board with an RP2040, such as the Raspberry Pi Pico.
#[derive(Clone, Copy, Debug)]
pub struct Rp2040;

impl Board for Rp2040 {
    const NAME: &'static str = "RP2040";
    /// The step hardware runs at the core's clock: one cycle is 8 ns.
    const CLOCK_HZ: u32 = 125_000_000;
    const MOST_AXES: usize = 6;
    const LEAST_LEAD_US: u32 = 10;

    fn check_axis(number: usize, axis: &AxisSettings) -> Result<(), Unfit> {
        if axis.drive == DriveKind::Servo {
            return Err(Unfit::Servo(number));
        }
        if axis.encoder {
            return Err(Unfit::Encoder(number));
        }
        Ok(())
    }

    fn tick_cycles(settings: &Settings, tick_hz: u32) -> f64 {
        let axis_cycles = |axis: &AxisSettings| {
            let ratio = axis.follower.most_ratio(&settings.cams);
            let steps_per_turn = axis.steps_per_crank_turn();
            let steps_hz = settings.limits.speed_hz * ratio * steps_per_turn.to_f64();
            // One chunk more, as chunks do not begin with the tick.
            let chunks = 1.0 + 2.0 * steps_hz / f64::from(tick_hz) / CHUNK_EDGES;
            let is_direct = axis.follower.constant_ratio() == Some(1.0);
            let follower = if is_direct { 0 } else { FOLLOWER_CYCLES };
            let gear = if steps_per_turn.is_whole() {
                0
            } else {
                GEAR_CYCLES
            };
            f64::from(AXIS_CYCLES + follower + gear) + f64::from(CHUNK_CYCLES) * chunks
        };
        let cycles: f64 = settings.axes.iter().map(axis_cycles).sum();
        f64::from(TICK_CYCLES) + cycles
    }
}
