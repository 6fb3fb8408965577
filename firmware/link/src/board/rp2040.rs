//! RP2040 at 125 MHz, with STEP and DIR outputs. `firmware/src/board` is its hardware.
//!
//! **Bound on the longest tick.** A tick is a sum of parts. The code bounds how often each part comes in a tick; the greatest cost of each
//! was measured, in all ticks of a search (`tests/emulator/run deadlines`). The bound adds them as if all came at their greatest in one
//! tick. `docs/firmware.md` has the table.

use cophase_core::settings::{AxisSettings, Settings};

use super::{Board, Unfit};

/// Cycles of a tick without its axes: interrupt and loop, inputs, states and events, the plan of a stop, report, hand-over.
const TICK_CYCLES: u32 = 14_600;
/// Cycles that each axis adds to these: the edges of its index line, its pulse confirmed, evaluated and reported, hand-over.
const AXIS_CYCLES: u32 = 1_980;
/// Cycles of a step plan without its chunks.
const PLAN_CYCLES: u32 = 700;
/// Cycles that each chunk of a plan's edges adds. The planner processes a chunk at once.
const CHUNK_CYCLES: u32 = 80;
const CHUNK_EDGES: f64 = 64.0;
/// Cycles that a gear adds to a plan, if it leaves a fraction of a half-step per crank turn.
const FRACTION_CYCLES: u32 = 220;
/// Cycles of a follower other than the master's own turns, for each plan.
const FOLLOWER_CYCLES: u32 = 620;
/// Cycles of the interrupt that preempts the loop when an axis's channel is done with its words.
const CHANNEL_CYCLES: u32 = 170;
/// Cycles by which the loop's interrupt may begin after the deadline, as link, log and sampler block interrupts (`tests/emulator/run link`).
const LATE_CYCLES: u32 = 1_500;
/// Cycles of the witnesses of single faults (`tests/emulator/run single-faults`: at most 150), and of lending the telemetry to the sampler.
const WITNESS_CYCLES: u32 = 200;

/// Cycles of work on phase offsets, of which the state allows one kind in a tick: in all, for each axis, and for each axis with a fraction
/// of a half-step per crank turn, whose distances take a division.
struct Offsets {
    all: u32,
    axis: u32,
    fraction: u32,
}

const HOMING: Offsets = Offsets {
    all: 2_000,
    axis: 190,
    fraction: 0,
};
const CORRECTION: Offsets = Offsets {
    all: 1_350,
    axis: 250,
    fraction: 1_250,
};
/// Homing that proves the wiring.
const PROOF: Offsets = Offsets {
    all: 4_700,
    axis: 1_150,
    fraction: 1_080,
};

impl Offsets {
    fn cycles(&self, settings: &Settings) -> u32 {
        let has_fraction = |axis: &&AxisSettings| !axis.steps_per_crank_turn().is_whole();
        let axes = settings.axes.len() as u32;
        let fractions = settings.axes.iter().filter(has_fraction).count() as u32;
        self.all + self.axis * axes + self.fraction * fractions
    }
}

/// Board with an RP2040, such as the Raspberry Pi Pico.
#[derive(Clone, Copy, Debug)]
pub struct Rp2040;

impl Board for Rp2040 {
    const NAME: &'static str = "RP2040";
    /// The step hardware runs at the core's clock: one cycle is 8 ns.
    const CLOCK_HZ: u32 = 125_000_000;
    const MAX_AXES: usize = 6;
    const MIN_LEAD_US: u32 = 10;

    fn check_axis(number: usize, axis: &AxisSettings) -> Result<(), Unfit> {
        if !axis.drive.takes_pulses() {
            return Err(Unfit::Servo(number));
        }
        if axis.encoder {
            return Err(Unfit::Encoder(number));
        }
        Ok(())
    }

    fn tick_cycles(settings: &Settings, tick_hz: u32) -> f64 {
        let axes = settings.axes.len() as u32;
        let correction = &settings.correction;
        let kinds = [
            (true, HOMING),
            (correction.gain > 0.0, CORRECTION),
            (correction.prove_wiring, PROOF),
        ];
        let possible = kinds.iter().filter(|(is_possible, _)| *is_possible);
        let offsets = possible.map(|(_, kind)| kind.cycles(settings)).max();
        let fixed = TICK_CYCLES
            + LATE_CYCLES
            + WITNESS_CYCLES
            + axes * (AXIS_CYCLES + CHANNEL_CYCLES)
            + offsets.unwrap_or(0);
        let plans = settings.axes.iter();
        let plans = plans.map(|axis| plan_cycles(settings, axis, tick_hz));
        f64::from(fixed) + plans.sum::<f64>()
    }
}

/// Cycles of an axis's step plan. Axes with equal motion share one, but each may have its own in the end: an axis whose phase offset has
/// moved joins its group again only at the same place within a step.
fn plan_cycles(settings: &Settings, axis: &AxisSettings, tick_hz: u32) -> f64 {
    let steps_per_turn = axis.steps_per_crank_turn();
    let follower_hz = settings.limits.speed_hz * axis.follower.max_ratio(&settings.cams);
    // In its slot, a phase offset moves up to the number of axes times as fast as its rate.
    let offset_hz = axis.trim_rate_hz * settings.axes.len() as f64;
    let edges = 2.0 * (follower_hz + offset_hz) * steps_per_turn.to_f64() / f64::from(tick_hz);
    // One chunk more, for the edges that do not fill one.
    let chunks = 1.0 + edges / CHUNK_EDGES;
    let is_direct = axis.follower.constant_ratio() == Some(1.0);
    let follower = if is_direct { 0 } else { FOLLOWER_CYCLES };
    let fraction = if steps_per_turn.is_whole() {
        0
    } else {
        FRACTION_CYCLES
    };
    f64::from(PLAN_CYCLES + follower + fraction) + f64::from(CHUNK_CYCLES) * chunks
}
