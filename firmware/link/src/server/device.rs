//! The controller as the server of the link needs it.

use cophase_core::settings::HostLossSettings;
use cophase_core::supervisor::Command;

use crate::message::{Event, File, Identity, Inputs, Output, Text};
use crate::sample::Sample;

/// Controller behind a link.
///
/// Commands and samples pass through queues, so that no function waits for the loop, except [`Self::load_program`] for a
/// few ticks.
pub trait Device {
    /// Identity of the controller.
    fn identity(&self) -> Identity;

    /// Number of axes.
    fn axes(&self) -> usize;

    /// Control ticks a second.
    fn tick_hz(&self) -> u32;

    /// Milliseconds since power-up, wrapping.
    fn now_ms(&self) -> u32;

    /// Bytes of a file as it runs now.
    fn file(&self, file: File) -> &[u8];

    /// Gives the loop a command for its next ticks. Returns false if the loop has not taken the earlier commands yet. Other commands leave
    /// room for a stop.
    fn command(&mut self, command: Command) -> bool;

    /// Sets the ticks between two samples.
    fn set_sampling(&mut self, every: u16);

    /// Next sample of the loop, if there is one.
    fn next_sample(&mut self) -> Option<Sample>;

    /// Next event of the loop and its tick, if there is one.
    fn next_event(&mut self) -> Option<(u32, Event)>;

    /// Replaces the program of a machine that is idle or parked.
    ///
    /// # Errors
    /// The key that is wrong, and why. The old program stays.
    fn load_program(&mut self, program: &[u8]) -> Result<(), Text>;

    /// Checks a settings file, and stores it for the next restart. The drives are off.
    ///
    /// # Errors
    /// Reason why it was not stored. The old settings remain.
    fn store_settings(&mut self, settings_file: &[u8]) -> Result<(), SettingsRefusal>;

    /// Restarts the controller, once the reply had time to leave; with only one axis of the settings, if one is given.
    ///
    /// # Errors
    /// The axis does not exist.
    fn restart(&mut self, only_axis: Option<u8>) -> Result<(), Text>;

    /// Reaction to the loss of the host.
    fn host_loss(&self) -> HostLossSettings;

    /// Inputs, as they are now.
    fn inputs(&self) -> Inputs;

    /// Holds an output active or not, and releases the one that is held. The drives are off.
    ///
    /// # Errors
    /// The output does not exist.
    fn hold_output(&mut self, output: Option<(Output, bool)>) -> Result<(), Text>;
}

/// Reason why settings were not stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SettingsRefusal {
    /// They are wrong, or the board cannot run them.
    Rejected(Text),
    /// The flash could not be written.
    NotStored(Text),
}
