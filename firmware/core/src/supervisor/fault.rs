//! Faults and events: their kinds and their data.
//!
//! One list has all kinds, those that stop the machine and those that are only reported. The log, reports and the byte
//! format use the same names.

use crate::units::{FRACTION_BITS, Phase, Turns};

/// Kind of a fault or event. [`mod@super::reaction`] has the reactions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum FaultKind {
    /// The platform tilts beyond its limit, and the cause is unknown.
    #[error("platform tilt beyond its limit")]
    Tilt = 0,
    /// The cranks warp the platform beyond its limit, and the cause is unknown.
    #[error("platform warp beyond its limit")]
    Warp = 1,
    /// All cranks together lag, or lead, beyond their limit.
    #[error("common lag beyond its limit")]
    CommonLag = 2,
    /// A stepper fell behind, or was driven ahead, by whole electrical cycles.
    #[error("lost steps")]
    LostSteps = 3,
    /// A crank moves away from the phase of its motor.
    #[error("slip")]
    Slip = 4,
    /// A crank stands still while its motor is commanded to turn; detected by its encoder.
    #[error("axis stuck")]
    Stuck = 5,
    /// An axis turns faster than commanded.
    #[error("axis runs away")]
    Runaway = 6,
    /// No index pulse comes any more from an axis without another sensor: it is stuck, or its sensor is dead.
    #[error("axis stuck, or its index sensor dead")]
    IndexTimeout = 7,
    /// An index pulse is missing, and the crank is at its commanded phase.
    #[error("index pulse missing")]
    IndexMissing = 8,
    /// An index pulse came at a phase without a flag.
    #[error("extra index pulse")]
    IndexExtra = 9,
    /// Lines of two axes are swapped: one axis is moved, and the other follows.
    #[error("wiring of two axes swapped")]
    SwappedWiring = 10,
    /// An axis turns opposite to its command; detected by its encoder.
    #[error("axis turns the wrong way")]
    Reversed = 11,
    /// An encoder reads a motion that its crank cannot have made.
    #[error("encoder glitch")]
    EncoderGlitch = 12,
    /// A drive reports an alarm.
    #[error("drive alarm")]
    DriveAlarm = 13,
    /// The loop missed several deadlines in a row, so that the drives stood still.
    #[error("control loop overrun")]
    Overrun = 14,
    /// The step FIFO of an axis ran empty within a tick, so that this axis lags the others.
    #[error("step FIFO underrun")]
    StepFifoUnderrun = 15,
    /// The enable input opened while the machine moved.
    #[error("enable input lost while moving")]
    EnableLost = 16,
    /// The stop input became active.
    #[error("stop input")]
    StopInput = 17,
    /// A crank is farther from the others than homing can correct.
    #[error("homing range exceeded")]
    HomingRangeExceeded = 18,
    /// The given program cannot be run.
    #[error("program rejected")]
    ProgramRejected = 19,
    /// The given settings cannot be run.
    #[error("settings rejected")]
    SettingsRejected = 20,
    /// The watchdog reset the controller, in a state in which the machine may have been moving.
    #[error("watchdog reset")]
    WatchdogReset = 21,
    /// All axes lag together where the master crosses a forbidden band: the resonance takes more torque than the motors have.
    #[error("captured at a resonance: all axes lag together at a forbidden band")]
    Capture = 22,
    /// The phase error of a crank walks in one direction, turn after turn.
    #[error("a phase error walks in one direction: the sensor shifts, or the crank on its shaft")]
    Drift = 23,
}

impl FaultKind {
    /// All kinds, each at the index of its number.
    pub const ALL: [Self; 24] = [
        Self::Tilt,
        Self::Warp,
        Self::CommonLag,
        Self::LostSteps,
        Self::Slip,
        Self::Stuck,
        Self::Runaway,
        Self::IndexTimeout,
        Self::IndexMissing,
        Self::IndexExtra,
        Self::SwappedWiring,
        Self::Reversed,
        Self::EncoderGlitch,
        Self::DriveAlarm,
        Self::Overrun,
        Self::StepFifoUnderrun,
        Self::EnableLost,
        Self::StopInput,
        Self::HomingRangeExceeded,
        Self::ProgramRejected,
        Self::SettingsRejected,
        Self::WatchdogReset,
        Self::Capture,
        Self::Drift,
    ];

    /// Name of the kind in reports and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tilt => "tilt",
            Self::Warp => "warp",
            Self::CommonLag => "common-lag",
            Self::LostSteps => "lost-steps",
            Self::Slip => "slip",
            Self::Stuck => "stuck",
            Self::Runaway => "runaway",
            Self::IndexTimeout => "index-timeout",
            Self::IndexMissing => "index-missing",
            Self::IndexExtra => "index-extra",
            Self::SwappedWiring => "swapped-wiring",
            Self::Reversed => "reversed",
            Self::EncoderGlitch => "encoder-glitch",
            Self::DriveAlarm => "drive-alarm",
            Self::Overrun => "overrun",
            Self::StepFifoUnderrun => "step-fifo-underrun",
            Self::EnableLost => "enable-loss",
            Self::StopInput => "stop-input",
            Self::HomingRangeExceeded => "homing-range-exceeded",
            Self::ProgramRejected => "program-rejected",
            Self::SettingsRejected => "settings-rejected",
            Self::WatchdogReset => "watchdog-reset",
            Self::Capture => "capture",
            Self::Drift => "drift",
        }
    }
}

/// Fault or event with its data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Axis that shows the fault most, if any.
    pub axis: Option<usize>,
    /// Phase error of the axis, or another size that the kind measures, in turns of crank angle.
    pub size: Turns,
    /// Control ticks since power-up.
    pub tick: u64,
    /// Phase of the master.
    pub phase: Phase,
}

/// Length of an encoded fault, bytes.
pub const FAULT_BYTES: usize = 20;

/// Byte for no axis.
const NO_AXIS: u8 = 0xFF;

impl Fault {
    /// Creates a fault of a kind; all other data are zero or none.
    pub const fn new(kind: FaultKind) -> Self {
        Self {
            kind,
            axis: None,
            size: Turns::ZERO,
            tick: 0,
            phase: Phase::ZERO,
        }
    }

    /// Sets the axis.
    #[must_use]
    pub const fn on_axis(mut self, axis: usize) -> Self {
        self.axis = Some(axis);
        self
    }

    /// Sets the size.
    #[must_use]
    pub const fn with_size(mut self, size: Turns) -> Self {
        self.size = size;
        self
    }

    /// Sets time and phase.
    #[must_use]
    pub const fn at(mut self, tick: u64, phase: Phase) -> Self {
        self.tick = tick;
        self.phase = phase;
        self
    }

    /// Encodes the fault as bytes, little-endian: kind, axis (255: none), two zeros, then the size and the phase within
    /// the turn, in 2⁻³² turn, and the tick. A size is limited to ±½ turn.
    pub fn to_bytes(&self) -> [u8; FAULT_BYTES] {
        const CUT: u32 = FRACTION_BITS - 32;
        let size = (self.size.to_bits() >> CUT).clamp(i32::MIN.into(), i32::MAX.into()) as i32;
        let phase = (self.phase.within_turn().to_bits() >> CUT) as u32;
        let axis = self.axis.and_then(|axis| u8::try_from(axis).ok());
        let (size, phase, tick) = (
            size.to_le_bytes(),
            phase.to_le_bytes(),
            self.tick.to_le_bytes(),
        );
        core::array::from_fn(|i| match i {
            0 => self.kind as u8,
            1 => axis.unwrap_or(NO_AXIS),
            4..8 => size[i - 4],
            8..12 => phase[i - 8],
            12..20 => tick[i - 12],
            _ => 0,
        })
    }

    /// Decodes the bytes of [`Self::to_bytes`], with size and phase to 2⁻³² turn; none for an unknown kind.
    pub fn from_bytes(bytes: &[u8; FAULT_BYTES]) -> Option<Self> {
        const CUT: u32 = FRACTION_BITS - 32;
        let four = |from: usize| core::array::from_fn(|i| bytes[from + i]);
        let turns = |units: i64| Turns::from_bits(units << CUT);
        Some(Self {
            kind: *FaultKind::ALL.get(usize::from(bytes[0]))?,
            axis: (bytes[1] != NO_AXIS).then_some(usize::from(bytes[1])),
            size: turns(i32::from_le_bytes(four(4)).into()),
            tick: u64::from_le_bytes(core::array::from_fn(|i| bytes[12 + i])),
            phase: Phase::from_turns(turns(u32::from_le_bytes(four(8)).into())),
        })
    }
}

/// True if `new` is a better name than `old` for a fault of the same axis in the same stop.
pub(crate) fn is_better(new: FaultKind, old: FaultKind) -> bool {
    const fn rank(kind: FaultKind) -> u8 {
        match kind {
            FaultKind::Tilt
            | FaultKind::Warp
            | FaultKind::CommonLag
            | FaultKind::IndexTimeout
            | FaultKind::IndexExtra
            | FaultKind::Capture => 0,
            FaultKind::LostSteps | FaultKind::Slip => 1,
            FaultKind::IndexMissing | FaultKind::Stuck | FaultKind::Runaway => 2,
            // A crank that turns back seems to stand at first. It must not be driven on.
            FaultKind::Reversed => 3,
            _ => 4,
        }
    }
    if let FaultKind::IndexMissing = new {
        return matches!(old, FaultKind::IndexTimeout);
    }
    let (new_rank, old_rank) = (rank(new), rank(old));
    // Of lost steps and slip, the later name is the better one.
    let is_other_kind = new_rank == 1 && old_rank == 1 && new as u8 != old as u8;
    new_rank < 4 && (new_rank > old_rank || is_other_kind)
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

    /// If this fails, a field is cut or misplaced, and the log of a board differs from a report.
    #[test]
    fn a_fault_round_trips_through_its_bytes() {
        for axis in [None, Some(0), Some(5)] {
            let fault = Fault {
                kind: FaultKind::LostSteps,
                axis,
                size: Turns::from_num(-0.0625),
                tick: 0x0123_4567_89AB_CDEF,
                phase: Phase::from_turns(Turns::from_num(0.75)),
            };
            assert_eq!(Fault::from_bytes(&fault.to_bytes()), Some(fault));
        }
        let mut unknown = Fault::new(FaultKind::Tilt).to_bytes();
        unknown[0] = FaultKind::ALL.len() as u8;
        assert_eq!(Fault::from_bytes(&unknown), None);
    }

    /// If this fails for a crank that turns back, it is still called stuck, and its drive stays on. If it fails for one that swings ahead
    /// as it is released, it is called a runaway, and a stop ends as a coast.
    #[test]
    fn what_turns_back_is_no_longer_stuck_and_what_swings_ahead_is() {
        assert!(is_better(FaultKind::Reversed, FaultKind::Stuck));
        assert!(is_better(FaultKind::Reversed, FaultKind::Tilt));
        assert!(!is_better(FaultKind::Stuck, FaultKind::Reversed));
        assert!(!is_better(FaultKind::Runaway, FaultKind::Stuck));
        assert!(!is_better(FaultKind::Reversed, FaultKind::SwappedWiring));
    }
}
