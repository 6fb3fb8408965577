//! What is done about what goes wrong: one table.
//!
//! A fault is met in *safety* as long as all cranks that can be detected are within their limits, and the crank it befell is
//! still detected by some sensor that can be believed. Out of safety there is always a stop.

use super::FaultKind;

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reaction {
    /// It is reported, and the machine goes on.
    Report,
    /// It is reported, and trimmed away; where trims are not allowed to, told only.
    Correct,
    /// All axes stop together, as fast as the motors' torque allows; then the drives are off until a reset.
    Stop,
    /// The drives are off the same tick, until a reset: what is wrong would make a stop of some axes alone, or there is no
    /// machine to stop.
    Disable,
}

/// One line of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// What is wrong.
    pub kind: FaultKind,
    /// What is done within limits.
    pub safe: Reaction,
    /// What is done out of it.
    pub unsafe_: Reaction,
}

const fn row(kind: FaultKind, safe: Reaction, unsafe_: Reaction) -> Row {
    Row {
        kind,
        safe,
        unsafe_,
    }
}

/// The table; each kind at the place that it has as a number.
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
        // Not a fault: it parks the machine, as the stop command does, and the drives hold.
        row(Kind::StopInput, Report, Report),
        row(Kind::HomingRangeExceeded, Stop, Stop),
        // Nothing turns yet: what is rejected is not run, and what was there before goes on.
        row(Kind::ProgramRejected, Report, Report),
        row(Kind::SettingsRejected, Report, Report),
        row(Kind::WatchdogReset, Disable, Disable),
    ]
};

/// What is done about a kind.
pub const fn reaction(kind: FaultKind, within_limits: bool) -> Reaction {
    let place = kind as usize;
    if place >= REACTIONS.len() {
        return Reaction::Disable; // there is no such kind: a compiler is not always told
    }
    let row = REACTIONS[place];
    if within_limits { row.safe } else { row.unsafe_ }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Were a row at another's place, a fault would get another's reaction.
    #[test]
    fn every_kind_has_its_row_and_is_no_milder_outside_limits() {
        for (row, kind) in REACTIONS.iter().zip(FaultKind::ALL) {
            assert_eq!(row.kind, kind);
            assert!(row.unsafe_ >= row.safe, "{kind:?}");
        }
    }
}
