//! Finding out where the cranks stand, and bringing them together.
//!
//! After power-up phases are unknown, and the cranks are joined by the platform: none may be turned alone. So all turn at homing speed together
//! until every index has been detected, within a turn and what may be overdue. What all are off by in common is taken for the
//! machine's own zero, the *home offset*; what they are off from each other is trimmed away, all at once and within the limits,
//! and looked at for a turn more. A crank that exceeds the range for that is refused.
//!
//! To *prove the wiring* the platform is then tilted, about one axis and about the other: any two cranks are moved differently once.
//! A crank that follows its own lines keeps its phase error, as that is relative to its command; where the lines of two are swapped,
//! each shows the command of the other. A plane bends nothing, however stiff the rods. Then all is taken back.
//!
//! A crank *deviates* that did not follow its command in three checks, turn after turn: a rotor swings in its field when it is
//! moved slowly, and one look alone may catch it so.

mod checks;
mod steps;
mod verify;

use crate::axes::PhaseOffsets;
use crate::drift::{AxisSet, DriftMonitor};
use crate::units::{MAX_AXES, PerAxis, Turns, nearest};
use checks::{Deviation, Moves, When};

/// How far homing has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Step {
    /// Not requested.
    #[default]
    Off,
    /// Not every index has been detected.
    Find,
    /// The cranks are moved.
    Level,
    /// They are looked at once more.
    Verify,
    /// What proved the wiring is taken back.
    Return,
    /// They are where they should be.
    Done,
}

/// Brings the cranks together.
#[derive(Clone, Debug)]
pub(super) struct Homing {
    step: Step,
    /// The two tilts; zero if the wiring is not to be proved.
    patterns: [PerAxis<Turns>; 2],
    /// Whether there is a common zero: all cranks turn once with the master.
    has_home_offset: bool,
    count: usize,
    /// A mean up to this is lag, and no other zero.
    lag: Turns,
    /// What readings may be off by.
    tolerance: PerAxis<Turns>,
    /// The cranks were brought together a second time, as they did not follow the first time.
    has_levelled_again: bool,
    /// Tilts that have been looked at, and the trims without them.
    proven: usize,
    base: PerAxis<Turns>,
    /// Turns of the master since the last step.
    waited: Turns,
    /// Phase errors of a turn before the cranks were moved; and the trims.
    before: PerAxis<Turns>,
    from: PerAxis<Turns>,
    /// Checks in which some crank deviated, and how far each was off in all of them; in run, corrections in a row that look like a
    /// swap.
    checks: u8,
    off: PerAxis<Turns>,
    home_offset: Turns,
}

impl Homing {
    /// For no axes.
    pub(super) const fn new() -> Self {
        const NONE: PerAxis<Turns> = [Turns::ZERO; MAX_AXES];
        Self {
            step: Step::Off,
            patterns: [NONE; 2],
            has_home_offset: false,
            count: 0,
            lag: Turns::ZERO,
            tolerance: NONE,
            has_levelled_again: false,
            proven: 0,
            base: NONE,
            waited: Turns::ZERO,
            before: NONE,
            from: NONE,
            checks: 0,
            off: NONE,
            home_offset: Turns::ZERO,
        }
    }

    /// Begins anew, with the tilts that prove the wiring, or none.
    #[cold]
    pub(super) const fn configure(
        &mut self,
        patterns: [PerAxis<Turns>; 2],
        has_home_offset: bool,
        count: usize,
        lag: Turns,
        tolerance: PerAxis<Turns>,
    ) {
        *self = Self::new();
        self.patterns = patterns;
        self.has_home_offset = has_home_offset;
        self.count = count;
        self.lag = lag;
        self.tolerance = tolerance;
    }

    /// Begins.
    pub(super) const fn begin(&mut self) {
        self.step = Step::Find;
        self.has_levelled_again = false;
        self.proven = 0;
        self.waited = Turns::ZERO;
    }

    /// True if the places of the cranks have been found, whether or not they could be brought together.
    pub(super) const fn has_found(&self) -> bool {
        !matches!(self.step, Step::Off | Step::Find)
    }

    /// Forgets that the places of the cranks have been found.
    pub(super) const fn forget(&mut self) {
        self.step = Step::Off;
    }

    /// Whether the cranks are where they should be.
    pub(super) const fn is_done(&self) -> bool {
        matches!(self.step, Step::Done)
    }

    /// How far the cranks were found ahead of where they were believed, since power-up.
    pub(super) const fn home_offset(&self) -> Turns {
        self.home_offset
    }

    /// What the cranks did since they were moved to trims, by their phase errors now.
    const fn moves<'a>(
        &'a self,
        when: When,
        phase_error: &'a PerAxis<Turns>,
        to: &'a PerAxis<Turns>,
    ) -> Moves<'a> {
        Moves {
            when,
            before: &self.before,
            phase_error,
            from: &self.from,
            to,
            tolerance: &self.tolerance,
            count: self.count,
        }
    }

    /// Of a set of cranks that are on their way to where commanded, the one that deviates most.
    fn in_transit(
        &self,
        set: AxisSet,
        monitor: &DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Option<Deviation> {
        let phase_error = monitor.filtered_error();
        self.moves(When::InTransit, &phase_error, &offsets.target())
            .deviation(set)
    }
}

/// What each crank is off from where the master has it.
pub(super) fn errors(monitor: &DriftMonitor, offsets: &PhaseOffsets) -> PerAxis<Turns> {
    core::array::from_fn(|axis| {
        nearest(monitor.phase_error()[axis].wrapping_add(offsets.now()[axis]))
    })
}
