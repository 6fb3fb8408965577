//! Reactions to faults: one table.
//!
//! The machine is *within limits* as long as all measured cranks are within their limits, and a plausible sensor still
//! measures the crank with the fault. Outside limits the reaction is always a stop.

use super::FaultKind;

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

/// Table of reactions; each kind is at the index of its number. A comment says why the drives hold, or do not.
pub static REACTIONS: [Row; FaultKind::ALL.len()] = {
    use FaultKind as Kind;
    use Reaction::{Correct, Disable, Report, StopAndCut, StopAndHold};
    [
        // The drives are sound. Without them the platform would tilt further.
        row(Kind::Tilt, StopAndHold, StopAndHold),
        row(Kind::Warp, StopAndHold, StopAndHold),
        // The load was too much for a moving motor; a motor at rest has its greatest torque.
        row(Kind::CommonLag, StopAndHold, StopAndHold),
        // The motor is in step again, at another phase.
        row(Kind::LostSteps, Correct, StopAndHold),
        // The coupling slips under the torque of motion; at rest the drive still holds most of the load.
        row(Kind::Slip, Correct, StopAndHold),
        // A drive that holds would press a jammed crank with its full torque.
        row(Kind::Stuck, StopAndCut, StopAndCut),
        // This axis moves by itself, and a stop does not reach it.
        row(Kind::Runaway, Disable, Disable),
        // Most often a sensor is dead. If the crank is jammed, a stepper presses it no harder than it holds at rest, and a
        // servo drive raises its alarm, which cuts.
        row(Kind::IndexTimeout, StopAndHold, StopAndHold),
        // The fault is one of a sensor, and the drives are sound.
        row(Kind::IndexMissing, Report, StopAndHold),
        // A crank that runs away may have made the pulse. If the drives held, it would turn against the others until its next pulses.
        row(Kind::IndexExtra, Report, StopAndCut),
        // At rest no axis moves, so it does not matter which line belongs to which axis.
        row(Kind::SwappedWiring, StopAndHold, StopAndHold),
        // This axis turns against the others as long as it is driven.
        row(Kind::Reversed, Disable, Disable),
        // The fault is one of a sensor. A drive that follows the wrong reading is detected as a runaway.
        row(Kind::EncoderGlitch, Report, StopAndHold),
        // The state of a drive with an alarm is unknown: it may hold, push or be off.
        row(Kind::DriveAlarm, StopAndCut, StopAndCut),
        // The loop meets its deadlines again, as otherwise it could not stop the machine. If it hangs, the watchdog cuts.
        row(Kind::Overrun, StopAndHold, StopAndHold),
        // Steps were not made, but the drives are sound.
        row(Kind::StepFifoUnderrun, StopAndHold, StopAndHold),
        // The operator, or the circuit behind the input, wants the drives off.
        row(Kind::EnableLost, Disable, Disable),
        // This is no fault: it parks the machine, as the stop command does, and the drives hold (stop category 2).
        row(Kind::StopInput, Report, Report),
        // A crank is at another phase than the others, and its drive holds it there.
        row(Kind::HomingRangeExceeded, StopAndHold, StopAndHold),
        // Nothing turns yet: rejected input is not used, and the previous one remains.
        row(Kind::ProgramRejected, Report, Report),
        row(Kind::SettingsRejected, Report, Report),
        // The drives have been off since the reset, and the phases of the cranks are unknown.
        row(Kind::WatchdogReset, Disable, Disable),
        // The load was too much for moving motors at the resonance; at rest there is no resonance.
        row(Kind::Capture, StopAndHold, StopAndHold),
        // It is slow. If it goes on, the limits stop the machine.
        row(Kind::Drift, Report, Report),
    ]
};

/// Reaction to a kind of fault.
pub const fn reaction(kind: FaultKind, within_limits: bool) -> Reaction {
    let place = kind as usize;
    if place >= REACTIONS.len() {
        return Reaction::Disable; // There is no such kind, but the compiler cannot always prove that.
    }
    let row = REACTIONS[place];
    if within_limits { row.safe } else { row.unsafe_ }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a row is misplaced, and a fault gets the reaction to another.
    #[test]
    fn reactions_are_in_fault_order_and_no_milder_outside_limits() {
        for (row, kind) in REACTIONS.iter().zip(FaultKind::ALL) {
            assert_eq!(row.kind, kind);
            assert!(row.unsafe_ >= row.safe, "{kind:?}");
        }
    }
}
