//! `[[fault]]` and `[noise]`: faults that a run injects, and noise of sensors and loads.

use serde::{Deserialize, Serialize};

/// Shortest loss of the enable input that the board does not take for noise, µs (`docs/wiring.md`).
pub const MIN_ENABLE_LOSS_US: u64 = 10;

/// Fault that is injected at a time. [`FaultName`] lists the values that each kind takes; others are refused.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct FaultAt {
    /// Time, s.
    pub at_s: f64,
    /// Kind of fault.
    pub kind: FaultName,
    /// Axis, for kinds that affect one axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<usize>,
    /// Second axis of a swap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with: Option<usize>,
    /// Lines that are swapped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<Lines>,
    /// Electrical cycles lost; negative if gained.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycles: Option<i64>,
    /// Rate at which a crank slips on its shaft, degrees/s; positive if it falls behind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_deg_per_s: Option<f64>,
    /// Speed of a crank that runs away, rev/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_hz: Option<f64>,
    /// Number of missing or extra index pulses, one per turn, or of missed deadlines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// Error of an encoder's reading, counts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counts: Option<i64>,
    /// Additional load torque of a crank, N·m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_nm: Option<f64>,
    /// Duration, s; without it, the fault is permanent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
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

/// Kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultName {
    /// A stepper falls back by whole electrical `cycles` (default 1).
    LostSteps,
    /// A crank slips on its motor's shaft at `rate_deg_per_s`, for `for_s`.
    Slip,
    /// A crank is stuck for `for_s`.
    Stuck,
    /// A drive turns at `speed_hz` for `for_s`, and ignores its command.
    Runaway,
    /// `count` index pulses are missing; without it, all are.
    IndexMissing,
    /// `count` extra index pulses (default 1) come away from the flag, one per turn.
    IndexExtra,
    /// The `lines` of two axes, `axis` and `with`, are swapped from power-up on, whatever `at_s` is.
    SwappedWiring,
    /// A motor turns in the opposite direction from power-up on, whatever `at_s` is.
    Reversed,
    /// An encoder's reading has an error of `counts` for `for_s`.
    EncoderGlitch,
    /// A drive's alarm is on for `for_s`. Its motor continues.
    DriveAlarm,
    /// The loop misses `count` deadlines (default 3).
    Overrun,
    /// The step hardware underruns within a tick.
    StepFifoUnderrun,
    /// The enable input is off for `for_s`.
    EnableLoss,
    /// The stop input is on for `for_s`.
    StopInput,
    /// A crank has an additional load of `torque_nm` for `for_s`, on model levels where torque moves the cranks.
    LoadStep,
}

impl FaultName {
    /// Returns its name in scenes.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LostSteps => "lost-steps",
            Self::Slip => "slip",
            Self::Stuck => "stuck",
            Self::Runaway => "runaway",
            Self::IndexMissing => "index-missing",
            Self::IndexExtra => "index-extra",
            Self::SwappedWiring => "swapped-wiring",
            Self::Reversed => "reversed",
            Self::EncoderGlitch => "encoder-glitch",
            Self::DriveAlarm => "drive-alarm",
            Self::Overrun => "overrun",
            Self::StepFifoUnderrun => "step-fifo-underrun",
            Self::EnableLoss => "enable-loss",
            Self::StopInput => "stop-input",
            Self::LoadStep => "load-step",
        }
    }
}

/// Lines of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lines {
    /// Lines to the drive.
    Drive,
    /// Lines from index sensor and encoder.
    Sensors,
}

/// Standard deviations of normally distributed noise. The same seed gives the same noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Noise of the crank phase of an index edge, degrees.
    pub index_deg: f64,
    /// Noise of the time of an index edge, µs.
    pub index_us: f64,
    /// Noise of an encoder's reading, counts.
    pub encoder_counts: f64,
    /// Noise of each crank's load, drawn in each tick, N·m, on model levels where torque moves the cranks.
    pub load_nm: f64,
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
