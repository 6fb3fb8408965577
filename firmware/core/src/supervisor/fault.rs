//! Faults and events: a [kind](FaultKind) with its data.

use super::FaultKind;
use crate::units::{FRACTION_BITS, Phase, Turns};

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
