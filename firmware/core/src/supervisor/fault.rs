//! What can go wrong, and what was seen when it did.

use crate::units::{Phase, Turns};

/// What went wrong. All of these stop the machine; what is merely reported is in
/// [`crate::signals::Limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FaultKind {
    /// The platform tilts further than it may.
    #[error("platform tilt past its limit")]
    Tilt,
    /// The cranks bend the platform further than they may.
    #[error("platform warp past its limit")]
    Warp,
    /// All cranks together lag, or lead, further than they may.
    #[error("common lag past its limit")]
    CommonLag,
    /// An index pulse stayed away for more than a turn.
    #[error("index pulse missing")]
    IndexMissing,
    /// A drive reports an alarm.
    #[error("drive alarm")]
    DriveAlarm,
    /// The enable input was taken away while the machine moved.
    #[error("enable input lost while moving")]
    EnableLost,
    /// The loop missed so many deadlines in a row that the drives saw a standstill.
    #[error("control loop overrun")]
    Overrun,
    /// The step hardware of an axis ran out of pulses within a tick: that axis is behind the others.
    #[error("step pulses ran dry")]
    RanDry,
    /// The controller restarted by itself, out of a state in which the machine may have been moving.
    #[error("controller restarted")]
    Restarted,
}

/// A fault, and what was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What went wrong.
    pub kind: FaultKind,
    /// The axis that shows it most, where one does.
    pub axis: Option<usize>,
    /// Its drift, or whatever the kind measures, in turns of crank angle.
    pub size: Turns,
    /// Control ticks since power-up.
    pub tick: u64,
    /// The master's phase.
    pub phase: Phase,
}

impl Fault {
    /// A fault of a kind; what is not known yet is zero.
    pub const fn new(kind: FaultKind) -> Self {
        Self {
            kind,
            axis: None,
            size: Turns::ZERO,
            tick: 0,
            phase: Phase::ZERO,
        }
    }

    /// The same, seen on an axis.
    #[must_use]
    pub const fn on_axis(mut self, axis: usize) -> Self {
        self.axis = Some(axis);
        self
    }

    /// The same, of a size.
    #[must_use]
    pub const fn with_size(mut self, size: Turns) -> Self {
        self.size = size;
        self
    }

    /// The same, at a time and place.
    #[must_use]
    pub const fn at(mut self, tick: u64, phase: Phase) -> Self {
        self.tick = tick;
        self.phase = phase;
        self
    }
}
