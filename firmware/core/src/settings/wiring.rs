//! Wiring: the active level of each line.
//!
//! The loop does not read these settings. A board applies them where its lines enter and leave the chip.

/// Level of a line while it is active, that is, while its name applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub enum ActiveLevel {
    /// Low.
    Low,
    /// High.
    High,
}

/// Input of a board.
///
/// A board's own pull resistor holds an open input at the level that stops the machine or does nothing. So the active level determines the
/// direction of the pull, and a setting can only switch it off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct InputWiring {
    /// Active level.
    pub active: ActiveLevel,
    /// True if the board's own resistor pulls the line.
    pub has_pull: bool,
}

/// Active levels of all lines but DIR, which [`reversed`](super::AxisSettings::reversed) inverts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct WiringSettings {
    /// STEP outputs: level of a step pulse.
    pub step: ActiveLevel,
    /// DRIVE ENABLE output: level at which the drives are on.
    pub drive_enable: ActiveLevel,
    /// INDEX inputs: level while a crank passes its sensor. Open: not active.
    pub index: InputWiring,
    /// ALARM inputs: level of an alarm. Open: active.
    pub alarm: InputWiring,
    /// ENABLE input: level at which the drives may be on. Open: not active.
    pub enable: InputWiring,
    /// STOP input: level at which the machine must stop. Open: active.
    pub stop: InputWiring,
    /// START input: level while the button is pressed. Open: not active.
    pub start: InputWiring,
}

impl WiringSettings {
    /// Wiring of a machine whose settings state none.
    pub const DEFAULT: Self = {
        const fn pulled(active: ActiveLevel) -> InputWiring {
            InputWiring {
                active,
                has_pull: true,
            }
        }
        Self {
            step: ActiveLevel::High,
            drive_enable: ActiveLevel::High,
            index: pulled(ActiveLevel::High),
            alarm: pulled(ActiveLevel::High),
            enable: pulled(ActiveLevel::Low),
            stop: pulled(ActiveLevel::High),
            start: pulled(ActiveLevel::Low),
        }
    };
}

impl Default for WiringSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}
