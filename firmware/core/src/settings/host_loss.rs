//! Reaction to the loss of the host that started the machine.

use super::inside;
use super::key::{Key, or};
use crate::problem::SettingsError;

/// Shortest time after which a host counts as lost, s.
const MIN_S: f64 = 0.1;

/// `link.timeout_s`: 0, or at least 0.1.
pub const TIMEOUT_S: Key = or(0.0).from(0.0, 60.0);

/// Action when the host is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub enum HostLossReaction {
    /// Stop at the parking phase.
    Stop,
    /// Stop as fast as the limits allow.
    StopNow,
}

/// Reaction to the loss of the host that started the machine.
///
/// The loop does not read these settings: the server of the host link does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct HostLossSettings {
    /// Time without a frame of the host after which it is lost, seconds, 0.1 to 60; 0: the machine continues without it.
    pub timeout_s: f64,
    /// Action when the host is lost.
    pub reaction: HostLossReaction,
}

impl HostLossSettings {
    /// No reaction: the machine continues without a host.
    pub const NONE: Self = Self {
        timeout_s: 0.0,
        reaction: HostLossReaction::Stop,
    };

    #[cold]
    pub(super) fn check(&self) -> Result<(), SettingsError> {
        if self.timeout_s != 0.0 {
            inside("link.timeout_s", self.timeout_s, MIN_S, TIMEOUT_S.high)?;
        }
        Ok(())
    }
}
