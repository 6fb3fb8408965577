//! Reactions to faults: one table.
//!
//! The machine is *within limits* as long as all measured cranks are within their limits, and a plausible sensor still
//! measures the crank with the fault. Outside limits the reaction is always a stop.

use super::FaultKind;

/// Reaction to a fault or event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reaction {
    /// Report the event; the machine continues.
    Report,
    /// Report the event, and correct it by trims where the settings allow that.
    Correct,
    /// Stop all axes together, as fast as the motors' torque allows; then switch the drives off until a reset (stop
    /// category 1).
    Stop,
    /// Switch the drives off in the same tick, until a reset (stop category 0). A stop would stop only some axes, or there
    /// is no machine to stop.
    Disable,
}

/// Row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Reaction within limits.
    pub safe: Reaction,
    /// Reaction outside limits.
    pub unsafe_: Reaction,
}

const fn row(kind: FaultKind, safe: Reaction, unsafe_: Reaction) -> Row {
    Row {
        kind,
        safe,
        unsafe_,
    }
}

/// Table of reactions; each kind is at the index of its number.
pub const REACTIONS: [Row; FaultKind::ALL.len()] = {
    use FaultKind as Kind;
    use Reaction::{Correct, Disable, Report, Stop};
    [
        row(Kind::Tilt, Stop, Stop),
        row(Kind::Warp, Stop, Stop),
        row(Kind::CommonLag, Stop, Stop),
        row(Kind::LostSteps, Correct, Stop),
        row(Kind::Slip, Correct, Stop),
        row(Kind::Stuck, Stop, Stop),
        row(Kind::Runaway, Disable, Disable),
        row(Kind::IndexTimeout, Stop, Stop),
        row(Kind::IndexMissing, Report, Stop),
        row(Kind::IndexExtra, Report, Stop),
        row(Kind::SwappedWiring, Stop, Stop),
        row(Kind::Reversed, Disable, Disable),
        row(Kind::EncoderGlitch, Report, Stop),
        row(Kind::DriveAlarm, Stop, Stop),
        row(Kind::Overrun, Stop, Stop),
        row(Kind::StepFifoUnderrun, Stop, Stop),
        row(Kind::EnableLost, Disable, Disable),
        // This is no fault: it parks the machine, as the stop command does, and the drives hold (stop category 2).
        row(Kind::StopInput, Report, Report),
        row(Kind::HomingRangeExceeded, Stop, Stop),
        // Nothing turns yet: rejected input is not used, and the previous one remains.
        row(Kind::ProgramRejected, Report, Report),
        row(Kind::SettingsRejected, Report, Report),
        row(Kind::WatchdogReset, Disable, Disable),
        row(Kind::Capture, Stop, Stop),
    ]
};

/// Reaction to a kind of fault.
pub const fn reaction(kind: FaultKind, within_limits: bool) -> Reaction {
    let place = kind as usize;
    if place >= REACTIONS.len() {
        return Reaction::Disable; // There is no such kind, but the compiler does not always know.
    }
    let row = REACTIONS[place];
    if within_limits { row.safe } else { row.unsafe_ }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If a row were misplaced, a fault would get the reaction to another.
    #[test]
    fn every_kind_has_its_row_and_is_no_milder_outside_limits() {
        for (row, kind) in REACTIONS.iter().zip(FaultKind::ALL) {
            assert_eq!(row.kind, kind);
            assert!(row.unsafe_ >= row.safe, "{kind:?}");
        }
    }
}
