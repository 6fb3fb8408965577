//! Levels of a board's lines, and the loss of its host. Simulated machines have neither.

use std::fmt;

use super::is_unset;
use cophase_core::settings::key::or_value;
use cophase_core::settings::{
    ActiveLevel, HostLossReaction, HostLossSettings, InputWiring, TIMEOUT_S, WiringSettings,
};
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

const DEFAULT: WiringSettings = WiringSettings::DEFAULT;

keys! {
    /// Level of each line in the state that its name states.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Wiring left out if is_unset, {
        /// STEP outputs: a step pulse.
        step: Level = or_value(Level::from_level(DEFAULT.step).name()),
        /// DRIVE ENABLE output: drives on.
        drive_enable: Level = or_value(Level::from_level(DEFAULT.drive_enable).name()),
        /// INDEX inputs: a crank passes its sensor.
        index: Level = or_value(Level::from_level(DEFAULT.index.active).name()),
        /// ALARM inputs: an alarm.
        alarm: Level = or_value(Level::from_level(DEFAULT.alarm.active).name()),
        /// ENABLE input: drives may be on.
        enable: Level = or_value(Level::from_level(DEFAULT.enable.active).name()),
        /// STOP input: the machine must stop.
        stop: Level = or_value(Level::from_level(DEFAULT.stop.active).name()),
        /// START input: the button is pressed.
        start: Level = or_value(Level::from_level(DEFAULT.start.active).name()),
        /// Inputs whose pull resistor on the board is off.
        no_pull: Vec<InputName> = or_value("[]"),
    }
}

words! {
    /// Level of a line.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Level {
        /// Low.
        Low = "low",
        /// High.
        High = "high",
    }
}

words! {
    /// Kind of input.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum InputName {
        /// Index sensors.
        Index = "index",
        /// Alarm outputs of the drives.
        Alarm = "alarm",
        /// Enable input.
        Enable = "enable",
        /// Stop input.
        Stop = "stop",
        /// Start button.
        Start = "start",
    }
}

impl Level {
    const fn from_level(level: ActiveLevel) -> Self {
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

impl Wiring {
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

keys! {
    /// Loss of the host that started the machine.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Link left out if is_unset, {
        /// Time without a frame of the host after which it is lost, s, at least 0.1; 0: the machine goes on without it.
        timeout_s: f64 = TIMEOUT_S,
        /// Action when it is lost.
        reaction: LossReaction = or_value("stop"),
    }
}

words! {
    /// Action when the host is lost.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum LossReaction {
        /// Stop at the parking phase.
        Stop = "stop",
        /// Stop as fast as the limits allow.
        StopNow = "stop-now",
    }
}

impl Link {
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
