//! Where a sensor stands, and what a tick brought.

use crate::units::Turns;

/// Where a sensor stands, and what it may be off by.
#[derive(Clone, Copy, Debug)]
pub(in crate::drift) struct Place {
    /// Phase at which its flag begins, going forward.
    pub index: Turns,
    /// The flag's length.
    pub flag: Turns,
    /// Ticks by which its line is late, 16 fraction bits.
    pub delay: u32,
    /// Of a tick that is over, the part in which no flag can have come that is not reported yet, 16 fraction bits: the line is late,
    /// and its filter waits. Below zero where that takes longer than a tick.
    pub covered: i32,
    /// Turns commanded in a tick in which a swinging rotor may go back all the same, at most.
    pub slow: Turns,
    /// A pulse further than this from the last is out of place.
    pub gate: Turns,
    /// What two pulses of a crank that is where it was may be apart.
    pub tolerance: Turns,
    /// A pulse that is late by more does not come where it was.
    pub sure: Turns,
    /// A pulse that is late by more stands for a crank beyond its limit: during homing, and from then on.
    pub overdue: Turns,
    pub overdue_settled: Turns,
    /// Of what a pulse in place shows anew, 1/2^`filtered` is believed: where an encoder has the crank anyway, the index need not
    /// bring its own noise in.
    pub filter_shift: u32,
}

/// What a tick brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::drift) enum Detection {
    /// Nothing new.
    Nothing,
    /// The first pulse of all.
    First,
    /// A pulse in its place; and an outlier before it was none.
    InPlace {
        /// It was overdue.
        was_overdue: bool,
        /// By how much that was off.
        extra: Option<Turns>,
        /// But the crank may have passed its flag in both places, being that fast.
        may_be_fast: bool,
    },
    /// After an outlier and a pulse in its place, another as far from that as that was from the outlier: the crank runs.
    Running {
        /// By how much it is off.
        by: Turns,
    },
    /// An outlier was none, and here is another.
    Extra {
        /// By how much the first was off.
        by: Turns,
    },
    /// The crank is elsewhere.
    Moved {
        /// By how much, forward.
        by: Turns,
    },
    /// Nothing came where the next pulse was expected.
    Undetected,
    /// A pulse stays away: reported once, until one comes.
    Overdue {
        /// It was waited for.
        waited: bool,
    },
}
