//! `[[fault]]` and `[noise]`: what goes wrong, and what sensors and loads are like when nothing does.

use serde::{Deserialize, Serialize};

/// Something that goes wrong at a time. Which of the numbers a kind takes, [`FaultName`] says; others are refused.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct FaultAt {
    /// When, s.
    pub at_s: f64,
    /// What.
    pub kind: FaultName,
    /// On which axis, of kinds that befall one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<usize>,
    /// The other axis of a swap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with: Option<usize>,
    /// Which lines are swapped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<Lines>,
    /// Electrical cycles lost: negative are gained.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycles: Option<i64>,
    /// How fast a crank slips on its shaft, degrees/s: positive behind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_deg_per_s: Option<f64>,
    /// How fast a crank turns that has run away, rev/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_hz: Option<f64>,
    /// How many: index pulses that stay away, or come between, one a turn; ticks that are missed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// Encoder counts by which a reading is off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counts: Option<i64>,
    /// Torque that a crank is loaded with, N·m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_nm: Option<f64>,
    /// For how long, s; without it, for good.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
}

impl FaultAt {
    /// A fault of a kind at a time, s, with none of the other numbers.
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

/// What can go wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultName {
    /// A stepper falls back by whole electrical `cycles` (default 1).
    LostSteps,
    /// A crank slips on its motor's shaft, at `rate_deg_per_s`, `for_s`.
    Slip,
    /// A crank stands, and nothing moves it, `for_s`.
    Stuck,
    /// A drive turns at `speed_hz`, whatever its command is, `for_s`.
    Runaway,
    /// `count` index pulses stay away; without it, all.
    IndexMissing,
    /// `count` index pulses (default 1) come where no flag is, one a turn.
    IndexExtra,
    /// Two axes' `lines`, `axis` and `with`, are swapped; from power-up, whatever `at_s`.
    SwappedWiring,
    /// A motor turns the other way than commanded; from power-up, whatever `at_s`.
    Reversed,
    /// An encoder's reading is off by `counts`, `for_s`.
    EncoderGlitch,
    /// A drive's alarm is on, `for_s`. Its motor goes on.
    DriveAlarm,
    /// The loop misses `count` deadlines (default 3).
    Overrun,
    /// The step hardware underruns within a tick.
    StepFifoUnderrun,
    /// The enable input is off, `for_s`.
    EnableLoss,
    /// The stop input is on, `for_s`.
    StopInput,
    /// A crank is loaded with `torque_nm` more, `for_s`; where torque moves cranks.
    LoadStep,
}

impl FaultName {
    /// What a scene calls it.
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
    /// What goes to the drive.
    Drive,
    /// What comes from index sensor and encoder.
    Sensors,
}

/// Noise, normally distributed: standard deviations. One seed, the same noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// From which all is drawn.
    pub seed: u64,
    /// Of an index edge's place, degrees of the crank.
    pub index_deg: f64,
    /// Of an index edge's time, µs.
    pub index_us: f64,
    /// Of an encoder's reading, counts.
    pub encoder_counts: f64,
    /// Of each crank's load, a new one each tick, N·m; where torque moves cranks.
    pub load_nm: f64,
}

impl Noise {
    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        *self
            == Self {
                seed: self.seed,
                ..Self::default()
            }
    }
}
