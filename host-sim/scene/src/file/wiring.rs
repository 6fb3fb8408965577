//! Levels of a board's lines, and the loss of its host. Simulated machines have neither.

use std::fmt;

use cophase_core::settings::{
    ActiveLevel, HostLossReaction, HostLossSettings, InputWiring, WiringSettings,
};
use serde::{Deserialize, Serialize};

/// Level of each line in the state that its name states.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Wiring {
    /// STEP outputs: a step pulse.
    pub step: Level,
    /// DRIVE ENABLE output: drives on.
    pub drive_enable: Level,
    /// INDEX inputs: a crank passes its sensor.
    pub index: Level,
    /// ALARM inputs: an alarm.
    pub alarm: Level,
    /// ENABLE input: drives may be on.
    pub enable: Level,
    /// STOP input: the machine must stop.
    pub stop: Level,
    /// START input: the button is pressed.
    pub start: Level,
    /// Inputs whose pull resistor on the board is off.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub no_pull: Vec<InputName>,
}

/// Level of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// Low.
    Low,
    /// High.
    High,
}

/// Kind of input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputName {
    /// Index sensors.
    Index,
    /// Alarm outputs of the drives.
    Alarm,
    /// Enable input.
    Enable,
    /// Stop input.
    Stop,
    /// Start button.
    Start,
}

impl From<ActiveLevel> for Level {
    fn from(level: ActiveLevel) -> Self {
        match level {
            ActiveLevel::Low => Self::Low,
            ActiveLevel::High => Self::High,
        }
    }
}

impl From<Level> for ActiveLevel {
    fn from(level: Level) -> Self {
        match level {
            Level::Low => Self::Low,
            Level::High => Self::High,
        }
    }
}

impl Default for Wiring {
    fn default() -> Self {
        const DEFAULT: WiringSettings = WiringSettings::DEFAULT;
        Self {
            step: DEFAULT.step.into(),
            drive_enable: DEFAULT.drive_enable.into(),
            index: DEFAULT.index.active.into(),
            alarm: DEFAULT.alarm.active.into(),
            enable: DEFAULT.enable.active.into(),
            stop: DEFAULT.stop.active.into(),
            start: DEFAULT.start.active.into(),
            no_pull: Vec::new(),
        }
    }
}

impl Wiring {
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the settings of the core.
    pub fn settings(&self) -> WiringSettings {
        let input = |name: InputName, level: Level| InputWiring {
            active: level.into(),
            has_pull: !self.no_pull.contains(&name),
        };
        WiringSettings {
            step: self.step.into(),
            drive_enable: self.drive_enable.into(),
            index: input(InputName::Index, self.index),
            alarm: input(InputName::Alarm, self.alarm),
            enable: input(InputName::Enable, self.enable),
            stop: input(InputName::Stop, self.stop),
            start: input(InputName::Start, self.start),
        }
    }
}

/// Lines that differ from the default, and their levels.
impl fmt::Display for Wiring {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let usual = Self::default();
        let lines = [
            ("step", self.step, usual.step),
            ("drive_enable", self.drive_enable, usual.drive_enable),
            ("index", self.index, usual.index),
            ("alarm", self.alarm, usual.alarm),
            ("enable", self.enable, usual.enable),
            ("stop", self.stop, usual.stop),
            ("start", self.start, usual.start),
        ];
        let other = lines.iter().filter(|(_, level, usual)| level != usual);
        let mut parts: Vec<String> = other
            .map(|(name, level, _)| match level {
                Level::Low => format!("{name} is active low"),
                Level::High => format!("{name} is active high"),
            })
            .collect();
        if !self.no_pull.is_empty() {
            parts.push(format!(
                "{} kinds of inputs have no pull",
                self.no_pull.len()
            ));
        }
        f.write_str(&parts.join(", "))
    }
}

/// Loss of the host that started the machine.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Link {
    /// Time without a frame of the host after which it is lost, s; 0: the machine goes on without it.
    pub timeout_s: f64,
    /// Action when it is lost.
    pub reaction: LossReaction,
}

/// Action when the host is lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LossReaction {
    /// Stop at the parking phase.
    #[default]
    Stop,
    /// Stop as fast as the limits allow.
    StopNow,
}

impl Link {
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the settings of the core.
    pub const fn settings(&self) -> HostLossSettings {
        HostLossSettings {
            timeout_s: self.timeout_s,
            reaction: match self.reaction {
                LossReaction::Stop => HostLossReaction::Stop,
                LossReaction::StopNow => HostLossReaction::StopNow,
            },
        }
    }
}
