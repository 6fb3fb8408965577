//! `[[fault]]` and `[noise]`: faults that a run injects, and noise of sensors and loads.

use cophase_core::settings::SPEED_HZ;
use cophase_core::settings::key::{needed, optional, or};
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

use super::MAX_S;

/// Shortest loss of the enable input that the board does not take for noise, µs (`docs/wiring.md`).
pub const MIN_ENABLE_LOSS_US: u64 = 10;

keys! {
    /// Fault that is injected at a time. [`FaultName`] lists the values that each kind takes; others are refused.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct FaultAt {
        /// Time, s.
        at_s: f64 = needed("10").from(0.0, MAX_S),
        /// Kind of fault.
        kind: FaultName = needed("slip"),
        /// Axis, for kinds that affect one axis.
        axis: Option<usize> = optional("1"),
        /// Second axis of a swap.
        with: Option<usize> = optional("1"),
        /// Lines that are swapped.
        lines: Option<Lines> = optional("sensors"),
        /// Electrical cycles lost; negative if gained.
        cycles: Option<i64> = optional("1").from(-1e4, 1e4),
        /// Rate at which a crank slips on its shaft, degrees/s; positive if it falls behind.
        rate_deg_per_s: Option<f64> = optional("30").from(-36_000.0, 36_000.0),
        /// Speed of a crank that runs away, rev/s.
        speed_hz: Option<f64> = optional("2").from(-SPEED_HZ.high, SPEED_HZ.high),
        /// Number of missing or extra index pulses, one per turn, or of missed deadlines.
        count: Option<u32> = optional("3").from(1.0, 1e6),
        /// Error of an encoder's reading, counts.
        counts: Option<i64> = optional("50").from(-1e9, 1e9),
        /// Additional load torque of a crank, N·m.
        torque_nm: Option<f64> = optional("4").from(-1000.0, 1000.0),
        /// Duration, s; without it, the fault is permanent.
        for_s: Option<f64> = optional("0.1").from(1e-6, MAX_S),
    }
}

impl FaultAt {
    /// Creates a fault of a kind at a time, s, without other values.
    pub const fn new(at_s: f64, kind: FaultName) -> Self {
        Self {
            at_s,
            kind,
            axis: None,
            with: None,
            lines: None,
            cycles: None,
            rate_deg_per_s: None,
            speed_hz: None,
            count: None,
            counts: None,
            torque_nm: None,
            for_s: None,
        }
    }
}

words! {
    /// Kind of fault.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
    pub enum FaultName {
        /// A stepper falls back by whole electrical `cycles` (default 1).
        LostSteps = "lost-steps",
        /// A crank slips on its motor's shaft at `rate_deg_per_s`, for `for_s`.
        Slip = "slip",
        /// A crank is stuck for `for_s`.
        Stuck = "stuck",
        /// A drive turns at `speed_hz` for `for_s`, and ignores its command.
        Runaway = "runaway",
        /// `count` index pulses are missing; without it, all are.
        IndexMissing = "index-missing",
        /// `count` extra index pulses (default 1) come away from the flag, one per turn.
        IndexExtra = "index-extra",
        /// The `lines` of two axes, `axis` and `with`, are swapped from power-up on, whatever `at_s` is.
        SwappedWiring = "swapped-wiring",
        /// A motor turns in the opposite direction from power-up on, whatever `at_s` is.
        Reversed = "reversed",
        /// An encoder's reading has an error of `counts` for `for_s`.
        EncoderGlitch = "encoder-glitch",
        /// A drive's alarm is on for `for_s`. Its motor continues.
        DriveAlarm = "drive-alarm",
        /// The loop misses `count` deadlines (default 3).
        Overrun = "overrun",
        /// The step hardware underruns within a tick.
        StepFifoUnderrun = "step-fifo-underrun",
        /// The enable input is off for `for_s`.
        EnableLoss = "enable-loss",
        /// The stop input is on for `for_s`.
        StopInput = "stop-input",
        /// A crank has an additional load of `torque_nm` for `for_s`, on model levels where torque moves the cranks.
        LoadStep = "load-step",
    }
}

words! {
    /// Lines of an axis.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Lines {
        /// Lines to the drive.
        Drive = "drive",
        /// Lines from index sensor and encoder.
        Sensors = "sensors",
    }
}

keys! {
    /// Standard deviations of normally distributed noise. The same seed gives the same noise.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Noise left out if Noise::is_none, {
        /// Seed of all random numbers.
        seed: u64 = or(0.0),
        /// Noise of the crank phase of an index edge, degrees.
        index_deg: f64 = or(0.0).from(0.0, 5.0),
        /// Noise of the time of an index edge, µs.
        index_us: f64 = or(0.0).from(0.0, 50.0),
        /// Noise of an encoder's reading, counts.
        encoder_counts: f64 = or(0.0).from(0.0, 1000.0),
        /// Noise of each crank's load, drawn in each tick, N·m, on model levels where torque moves the cranks.
        load_nm: f64 = or(0.0).from(0.0, 1000.0),
    }
}

impl Noise {
    /// Returns true if there is no noise.
    pub fn is_none(&self) -> bool {
        *self
            == Self {
                seed: self.seed,
                ..Self::default()
            }
    }
}
