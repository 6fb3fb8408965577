//! Selection of streamed channels, and the resulting columns of a recording.

use cophase_link::sample::{Channel, Channels};

/// Columns to which no controller has access, named without the number of the axis.
const UNKNOWN: [&str; 7] = [
    "actual_turns",
    "tilt_x_mrad",
    "tilt_y_mrad",
    "warp_deg",
    "z_m",
    "accel_mps2",
    "amax_actual_mps2",
];

/// Channels, and the columns that need them.
const COLUMNS: [(Channel, &[&str]); 6] = [
    (Channel::Amax, &["amax_requested_mps2"]),
    (Channel::Speed, &["amax_commanded_mps2", "omega_rad_s"]),
    (Channel::Phase, &["phase_turns", "command_turns"]),
    (Channel::Lead, &["command_turns"]),
    (Channel::Steps, &["steps"]),
    (Channel::PhaseError, &["phase_error_deg"]),
];

/// Channels without which edges cannot be derived.
const FOR_EDGES: Channels = Channel::State as Channels
    | Channel::Phase as Channels
    | Channel::Lead as Channels
    | Channel::Steps as Channels;

/// Streamed channels.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    /// Channels of each sample; the state must be one of them.
    pub channels: Channels,
    /// Ticks from one sample to the next.
    pub every: u16,
}

impl Stream {
    pub(super) const fn has(self, channel: Channel) -> bool {
        self.channels & channel as Channels != 0
    }

    /// True if edges can be derived from the channels.
    pub(super) const fn has_edges(self) -> bool {
        self.channels & FOR_EDGES == FOR_EDGES
    }

    /// Columns that stay empty, named without the number of the axis.
    pub(super) fn unknown_columns(self) -> Vec<&'static str> {
        let missing = COLUMNS.iter().filter(|(channel, _)| !self.has(*channel));
        let missing = missing.flat_map(|(_, names)| names.iter().copied());
        UNKNOWN.into_iter().chain(missing).collect()
    }
}
