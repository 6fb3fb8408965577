//! Results of the watch of an index sensor.

use crate::units::Turns;

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
    /// No pulse came in the place of the first one, and one came elsewhere: the first was an extra pulse, and this one is taken instead.
    Dismissed {
        /// Offset of the extra pulse from the other.
        by: Turns,
    },
    /// The crank has moved.
    Moved {
        /// Distance, positive forward.
        by: Turns,
        /// True if the place before was no more than a guess.
        from_guess: bool,
    },
    /// No pulse came in place.
    Undetected,
    /// A pulse is overdue. This is reported once per missing pulse.
    Overdue {
        /// True if its time has been extended already.
        waited: bool,
    },
}
