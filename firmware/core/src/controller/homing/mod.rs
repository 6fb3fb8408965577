//! Homing: finds the phase of every crank, and levels the cranks.
//!
//! After power-up, phases are unknown. The platform joins the cranks, so none may be turned alone. All turn together at homing speed until
//! every index has been detected, and a turn has confirmed its place (`docs/faults.md`). This takes up to two turns, plus the time by which a
//! pulse may be late. No crank is moved before that, as a place that is noise would tilt the platform.
//!
//! The phase error that all cranks have in common is the zero of the machine, the *home offset*. The differences between the cranks are
//! removed by trims, all at once and within the limits, and checked for one more turn. A crank that exceeds the homing range is refused.
//!
//! To *prove the wiring*, the platform is then tilted about one axis and about the other, so that any two cranks are moved differently
//! once. A crank that follows its own lines keeps its phase error, as that is relative to its command. Where the lines of two axes are
//! swapped, each shows the command of the other. A plane tilt bends no rod, however stiff the rods are. Then the tilt is taken back.
//!
//! A crank *deviates* if it did not follow its command in three checks, turn after turn. A rotor swings in its field when it moves slowly,
//! and a single check may catch the swing.

mod checks;
mod steps;
mod turn;
mod verify;

use core::hash::{Hash, Hasher};

use crate::monitor::{DriftMonitor, ErrorFilter};
use crate::phase_offset::PhaseOffsets;
use crate::units::{AxisSet, MAX_AXES, PerAxis, Turns, nearest};
use checks::{Deviation, Moves, When};
use turn::FullTurn;

/// Step that homing has reached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Step {
    /// Homing is not requested.
    #[default]
    Off,
    /// Not every index has been detected and confirmed yet.
    Find,
    /// The cranks are moved.
    Level,
    /// The cranks are checked after their move.
    Verify,
    /// The tilt that proved the wiring is taken back.
    Return,
    /// The cranks are at their commanded phases.
    Done,
}

/// Settings of homing.
#[derive(Clone, Debug)]
pub(super) struct HomingConfig {
    /// The two tilts that prove the wiring. Both are zero if it is not to be proved.
    pub patterns: [PerAxis<Turns>; 2],
    /// True if the cranks have a common zero, because all turn once per turn of the master.
    pub has_home_offset: bool,
    pub count: usize,
    /// Largest mean phase error that is lag. A larger one is a home offset.
    pub lag: Turns,
    /// Largest error of a reading, for each axis.
    pub tolerance: PerAxis<Turns>,
}

impl HomingConfig {
    /// Settings without axes.
    pub(super) const NONE: Self = Self {
        patterns: [[Turns::ZERO; MAX_AXES]; 2],
        has_home_offset: false,
        count: 0,
        lag: Turns::ZERO,
        tolerance: [Turns::ZERO; MAX_AXES],
    };

    /// Hashes the settings of one axis. Returns false for the axis after the last.
    #[inline(always)]
    pub(super) fn hash_axis(&self, axis: usize, hasher: &mut impl Hasher) -> bool {
        let [one, other] = &self.patterns;
        match (one.get(axis), other.get(axis), self.tolerance.get(axis)) {
            (Some(one), Some(other), Some(tolerance)) => {
                (one, other, tolerance).hash(hasher);
                true
            }
            _ => false,
        }
    }

    /// Hashes the settings of all axes.
    #[inline(always)]
    pub(super) fn hash_common(&self, hasher: &mut impl Hasher) {
        let Self {
            patterns: _,
            has_home_offset,
            count,
            lag,
            tolerance: _,
        } = self;
        (has_home_offset, count, lag).hash(hasher);
    }
}

/// State of homing, which levels the cranks.
#[derive(Clone, Debug)]
pub(super) struct Homing {
    config: HomingConfig,
    step: Step,
    /// True if the cranks were levelled a second time, because they did not follow the first time.
    has_levelled_again: bool,
    /// Number of tilts that were commanded, and the trims without a tilt.
    proven: usize,
    base: PerAxis<Turns>,
    turn: FullTurn,
    /// Turns of the master since the last step, or since an offset last moved.
    waited: Turns,
    /// Phase errors and trims before the cranks were moved.
    before: PerAxis<Turns>,
    from: PerAxis<Turns>,
    /// Number of checks in which a crank deviated, and the sum of the deviations of each crank in them. In run, the number of corrections
    /// in a row that look like a swap.
    checks: u8,
    off: PerAxis<Turns>,
    home_offset: Turns,
}

impl Homing {
    /// Creates a homing that is not requested.
    pub(super) const fn new(config: HomingConfig) -> Self {
        const NONE: PerAxis<Turns> = [Turns::ZERO; MAX_AXES];
        Self {
            config,
            step: Step::Off,
            has_levelled_again: false,
            proven: 0,
            base: NONE,
            turn: FullTurn::NEW,
            waited: Turns::ZERO,
            before: NONE,
            from: NONE,
            checks: 0,
            off: NONE,
            home_offset: Turns::ZERO,
        }
    }

    /// Settings of homing.
    pub(super) const fn config(&self) -> &HomingConfig {
        &self.config
    }

    /// Begins with the search for the indices.
    pub(super) const fn begin(&mut self) {
        self.step = Step::Find;
        self.has_levelled_again = false;
        self.proven = 0;
        self.turn = FullTurn::NEW;
        self.waited = Turns::ZERO;
    }

    /// Adds the measurements of a tick in which the master made `speed` turns.
    pub(super) fn measure(&mut self, monitor: &DriftMonitor, speed: Turns) {
        self.turn.add(monitor, speed);
    }

    /// True if the phases of the cranks have been found, even if the cranks could not be levelled.
    pub(super) const fn has_found(&self) -> bool {
        !matches!(self.step, Step::Off | Step::Find)
    }

    /// Discards the phases that were found.
    pub(super) const fn forget(&mut self) {
        self.step = Step::Off;
    }

    /// True if homing is over: the cranks are at their commanded phases.
    pub(super) const fn is_done(&self) -> bool {
        matches!(self.step, Step::Done)
    }

    /// Returns the home offset: crank phase minus master phase, as found since power-up.
    pub(super) const fn home_offset(&self) -> Turns {
        self.home_offset
    }

    /// Returns the moves of the cranks since they were sent to trims, with their present phase errors.
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
            tolerance: &self.config.tolerance,
            count: self.config.count,
        }
    }

    /// Returns the crank of a set that deviates most, for cranks that are still moving to their targets.
    fn in_transit(
        &self,
        set: AxisSet,
        monitor: &DriftMonitor,
        offsets: &PhaseOffsets,
    ) -> Option<Deviation> {
        let phase_error = monitor.errors(ErrorFilter::LowPass);
        self.moves(When::InTransit, &phase_error, &offsets.target())
            .deviation(set)
    }
}

/// Returns the phase error of each crank without its offset: actual phase minus the phase that the master gives it.
pub(super) fn errors(monitor: &DriftMonitor, offsets: &PhaseOffsets) -> PerAxis<Turns> {
    core::array::from_fn(|axis| {
        nearest(monitor.phase_error()[axis].wrapping_add(offsets.now()[axis]))
    })
}
