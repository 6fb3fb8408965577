//! Angle and widths of an index sensor, and the results of its watch.

use crate::units::Turns;

/// Angle of an index sensor, and the widths by which its pulses are classified.
#[derive(Clone, Copy, Debug)]
pub(in crate::drift) struct Place {
    /// Phase at which its flag begins, going forward.
    pub index: Turns,
    /// The flag's length.
    pub flag: Turns,
    /// Ticks by which its line is late, 16 fraction bits.
    pub delay: u32,
    /// Part of a tick whose pulses have been reported by its end, 16 fraction bits. It is less than one because of the delay of the line
    /// and its filter, and negative if they take longer than a tick.
    pub covered: i32,
    /// Commanded turns per tick up to which a swinging rotor may go back.
    pub slow: Turns,
    /// A pulse further than this from the last is out of place.
    pub gate: Turns,
    /// Largest difference of two pulses of a crank that has not moved.
    pub tolerance: Turns,
    /// Phase error with which this crank alone exceeds a limit.
    pub alone: Turns,
    /// One electrical cycle exceeds a limit.
    pub is_cycle_too_far: bool,
    /// The axis has an encoder as well, so that the offset is the difference of crank and encoder.
    pub has_encoder: bool,
}

impl Place {
    /// Delay of a pulse beyond which the crank may exceed its limit.
    pub fn overdue(&self, is_homing: bool) -> Turns {
        // A pulse that is late by a gate may show a lost cycle. If that exceeds a limit, it may have done so for a turn.
        if self.is_cycle_too_far && !is_homing {
            self.gate
        } else {
            self.alone.max(self.gate)
        }
    }
}

/// Result of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::drift) enum Detection {
    /// Nothing new.
    Nothing,
    /// The first pulse since the start of the search.
    First,
    /// A pulse in its place, so that an outlier before it was an extra pulse.
    InPlace {
        /// True if the pulse was overdue.
        was_overdue: bool,
        /// Offset of the outlier from its place.
        extra: Option<Turns>,
        /// The crank may have made both pulses, if it is that fast.
        may_be_fast: bool,
    },
    /// Three pulses at even spacing, the second of them in place: the crank runs away.
    Running {
        /// Offset of the last pulse from its place.
        by: Turns,
    },
    /// A second outlier, so that the first was an extra pulse.
    Extra {
        /// Offset of the first from its place.
        by: Turns,
    },
    /// The crank has moved.
    Moved {
        /// Distance, positive forward.
        by: Turns,
    },
    /// No pulse came in place.
    Undetected,
    /// A pulse is overdue. This is reported once per missing pulse.
    Overdue {
        /// True if its time has been extended already.
        waited: bool,
    },
}
