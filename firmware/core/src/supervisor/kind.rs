//! Kinds of faults and events: one row each.
//!
//! The log, reports, and the byte format use the same names and numbers. A row also has the reactions to the kind, with the reason why the
//! drives hold or do not, and the rank of its name.
//!
//! The judge of the campaign (`host-sim/lab/src/campaign`) has tables of its own on purpose: what it shared with this one it could not judge.

use super::reaction::Reaction;
use Rank::{Cause, Motion, Other, Reversal, Symptom};
use Reaction::{Correct, Disable, Report, StopAndCut, StopAndHold};

/// Rank of a name: how much it states about a crank. The higher one of two names for a fault is the better one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rank {
    /// Something is wrong.
    Symptom,
    /// The crank moved.
    Motion,
    /// The cause is known: the drive, the crank or a sensor.
    Cause,
    /// It turns back. Such a crank seems to stand at first, and must not be driven on.
    Reversal,
    /// Nothing of a crank. This name neither replaces another, nor is replaced.
    Other,
}

/// Kind of a fault, with what follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Its name in reports and tables.
    pub name: &'static str,
    /// Reaction within limits.
    pub safe: Reaction,
    /// Reaction outside limits.
    pub unsafe_: Reaction,
    pub(crate) rank: Rank,
}

/// Makes the kinds. A row is `Kind = number, "name", "text", reaction within limits, reaction outside limits, rank`.
macro_rules! kinds {
    ($($(#[doc = $doc:literal])+ $kind:ident = $number:literal, $name:literal, $text:literal, $safe:ident, $unsafe_:ident, $rank:ident;)+) => {
        /// Kind of a fault or event.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[repr(u8)]
        pub enum FaultKind {
            $($(#[doc = $doc])+ #[error($text)] $kind = $number,)+
        }

        impl FaultKind {
            /// All kinds, each at the index of its number.
            pub const ALL: [Self; [$($number),+].len()] = [$(Self::$kind),+];

            /// The row of the kind.
            const fn row(self) -> &'static Row {
                match self {
                    $(Self::$kind => &KINDS[$number],)+
                }
            }
        }

        /// All kinds, each at the index of its number.
        pub static KINDS: [Row; FaultKind::ALL.len()] = [$(Row {
            kind: FaultKind::$kind,
            name: $name,
            safe: $safe,
            unsafe_: $unsafe_,
            rank: $rank,
        }),+];
    };
}

kinds! {
    /// The platform tilts beyond its limit, and the cause is unknown.
    Tilt = 0, "tilt", "platform tilt beyond its limit",
        // The drives are sound. Without them the platform would tilt further.
        StopAndHold, StopAndHold, Symptom;
    /// The cranks warp the platform beyond its limit, and the cause is unknown.
    Warp = 1, "warp", "platform warp beyond its limit",
        StopAndHold, StopAndHold, Symptom;
    /// All cranks together lag, or lead, beyond their limit.
    CommonLag = 2, "common-lag", "common lag beyond its limit",
        // The load was too much for a moving motor; a motor at rest has its greatest torque.
        StopAndHold, StopAndHold, Symptom;
    /// A stepper fell behind, or was driven ahead, by whole electrical cycles.
    LostSteps = 3, "lost-steps", "lost steps",
        // The motor is in step again, at another phase.
        Correct, StopAndHold, Motion;
    /// A crank moves away from the phase of its motor.
    Slip = 4, "slip", "slip",
        // The coupling slips under the torque of motion; at rest the drive still holds most of the load.
        Correct, StopAndHold, Motion;
    /// A crank stands still while its motor is commanded to turn; detected by its encoder.
    Stuck = 5, "stuck", "axis stuck",
        // A drive that holds would press a jammed crank with its full torque.
        StopAndCut, StopAndCut, Cause;
    /// An axis turns faster than commanded.
    Runaway = 6, "runaway", "axis runs away",
        // This axis moves by itself, and a stop does not reach it.
        Disable, Disable, Cause;
    /// No index pulse comes any more from an axis without another sensor: it is stuck, or its sensor is dead.
    IndexTimeout = 7, "index-timeout", "axis stuck, or its index sensor dead",
        // Most often a sensor is dead. If the crank is jammed, a stepper presses it no harder than it holds at rest, and a
        // servo drive raises its alarm, which cuts.
        StopAndHold, StopAndHold, Symptom;
    /// An index pulse is missing, and the crank is at its commanded phase.
    IndexMissing = 8, "index-missing", "index pulse missing",
        // The fault is one of a sensor, and the drives are sound.
        Report, StopAndHold, Cause;
    /// An index pulse came at a phase without a flag.
    IndexExtra = 9, "index-extra", "extra index pulse",
        // A crank that runs away may have made the pulse. If the drives held, it would turn against the others until its next pulses.
        Report, StopAndCut, Symptom;
    /// Lines of two axes are swapped: one axis is moved, and the other follows.
    SwappedWiring = 10, "swapped-wiring", "wiring of two axes swapped",
        // At rest no axis moves, so it does not matter which line belongs to which axis.
        StopAndHold, StopAndHold, Other;
    /// An axis turns opposite to its command; detected by its encoder.
    Reversed = 11, "reversed", "axis turns the wrong way",
        // This axis turns against the others as long as it is driven.
        Disable, Disable, Reversal;
    /// An encoder reads a motion that its crank cannot have made.
    EncoderGlitch = 12, "encoder-glitch", "encoder glitch",
        // The fault is one of a sensor. A drive that follows the wrong reading is detected as a runaway.
        Report, StopAndHold, Other;
    /// A drive reports an alarm.
    DriveAlarm = 13, "drive-alarm", "drive alarm",
        // The state of a drive with an alarm is unknown: it may hold, push or be off.
        StopAndCut, StopAndCut, Other;
    /// The loop missed several deadlines in a row, so that the drives stood still.
    Overrun = 14, "overrun", "control loop overrun",
        // The loop meets its deadlines again, as otherwise it could not stop the machine. If it hangs, the watchdog cuts.
        StopAndHold, StopAndHold, Other;
    /// The step FIFO of an axis ran empty within a tick, so that this axis lags the others.
    StepFifoUnderrun = 15, "step-fifo-underrun", "step FIFO underrun",
        // Steps were not made, but the drives are sound.
        StopAndHold, StopAndHold, Other;
    /// The enable input opened while the machine moved.
    EnableLost = 16, "enable-loss", "enable input lost while moving",
        // The operator, or the circuit behind the input, wants the drives off.
        Disable, Disable, Other;
    /// The stop input became active.
    StopInput = 17, "stop-input", "stop input",
        // This is no fault: it parks the machine, as the stop command does, and the drives hold (stop category 2).
        Report, Report, Other;
    /// A crank is farther from the others than homing can correct.
    HomingRangeExceeded = 18, "homing-range-exceeded", "homing range exceeded",
        // A crank is at another phase than the others, and its drive holds it there.
        StopAndHold, StopAndHold, Other;
    /// The given program cannot be run.
    ProgramRejected = 19, "program-rejected", "program rejected",
        // Nothing turns yet: rejected input is not used, and the previous one remains.
        Report, Report, Other;
    /// The given settings cannot be run.
    SettingsRejected = 20, "settings-rejected", "settings rejected",
        Report, Report, Other;
    /// The watchdog reset the controller, in a state in which the machine may have been moving.
    WatchdogReset = 21, "watchdog-reset", "watchdog reset",
        // The drives have been off since the reset, and the phases of the cranks are unknown.
        Disable, Disable, Other;
    /// All axes lag together where the master crosses a forbidden band: the resonance takes more torque than the motors have.
    Capture = 22, "capture", "captured at a resonance: all axes lag together at a forbidden band",
        // The load was too much for moving motors at the resonance; at rest there is no resonance.
        StopAndHold, StopAndHold, Symptom;
    /// The phase error of a crank walks in one direction, turn after turn.
    Drift = 23, "drift", "a phase error walks in one direction: the sensor shifts, or the crank on its shaft",
        // It is slow. If it goes on, the limits stop the machine.
        Report, Report, Other;
}

impl FaultKind {
    /// Name of the kind in reports and tables.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Reaction to the kind.
    pub const fn reaction(self, within_limits: bool) -> Reaction {
        let row = self.row();
        if within_limits { row.safe } else { row.unsafe_ }
    }

    /// True if this is a better name than `old` for a fault of the same axis in the same stop.
    pub(crate) fn is_better_than(self, old: Self) -> bool {
        if self == Self::IndexMissing {
            return old == Self::IndexTimeout;
        }
        let (new_rank, old_rank) = (self.row().rank, old.row().rank);
        // Of lost steps and slip, the later name is the better one.
        let is_later = new_rank == Motion && old_rank == Motion && self != old;
        new_rank < Other && (new_rank > old_rank || is_later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a fault that is sent as its number is decoded as another kind.
    #[test]
    fn fault_kinds_are_listed_by_number_with_unique_names() {
        for (number, kind) in FaultKind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, number);
            let namesakes = FaultKind::ALL.iter().filter(|k| k.name() == kind.name());
            assert_eq!(namesakes.count(), 1, "{}", kind.name());
        }
    }

    #[test]
    fn no_reaction_is_milder_outside_limits() {
        for row in KINDS {
            assert!(row.unsafe_ >= row.safe, "{}", row.name);
        }
    }

    /// If this fails for a crank that turns back, it is still called stuck, and its drive stays on. If it fails for one that swings ahead
    /// as it is released, it is called a runaway, and a stop ends as a coast.
    #[test]
    fn what_turns_back_is_no_longer_stuck_and_what_swings_ahead_is() {
        assert!(FaultKind::Reversed.is_better_than(FaultKind::Stuck));
        assert!(FaultKind::Reversed.is_better_than(FaultKind::Tilt));
        assert!(!FaultKind::Stuck.is_better_than(FaultKind::Reversed));
        assert!(!FaultKind::Runaway.is_better_than(FaultKind::Stuck));
        assert!(!FaultKind::Reversed.is_better_than(FaultKind::SwappedWiring));
    }
}
