//! Reactions to faults. Each [kind](super::FaultKind) has two in its row.
//!
//! The machine is *within limits* as long as all measured cranks are within their limits, and a plausible sensor still
//! measures the crank with the fault. Outside limits the reaction is always a stop.

/// Reaction to a fault or event, from the mildest to the most severe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reaction {
    /// Report the event; the machine continues.
    Report,
    /// Report the event, and correct it by phase offsets where the settings allow that.
    Correct,
    /// Stop all axes together, as fast as the motors' torque allows; then hold the cranks with the drives on until a reset
    /// (stop category 2). Where the settings name a brake, the drives go off as for [`Self::StopAndCut`].
    StopAndHold,
    /// Stop in the same way; then switch the drives off until a reset (stop category 1). Holding is impossible or dangerous.
    StopAndCut,
    /// Switch the drives off in the same tick, until a reset (stop category 0). A stop would stop only some axes, or there
    /// is no machine to stop.
    Disable,
}

impl Reaction {
    /// True if the machine does not continue.
    pub const fn stops(self) -> bool {
        matches!(self, Self::StopAndHold | Self::StopAndCut | Self::Disable)
    }

    /// True if the drives are off once the machine is at rest.
    pub const fn cuts(self) -> bool {
        matches!(self, Self::StopAndCut | Self::Disable)
    }
}
