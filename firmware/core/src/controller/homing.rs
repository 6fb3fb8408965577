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
mod verify;

use crate::axes::PhaseOffsets;
use crate::drift::{AxisSet, DriftMonitor};
use crate::supervisor::{Fault, FaultKind};
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
    /// Tilts that have been looked at, and the trims without them.
    proven: usize,
    base: PerAxis<Turns>,
    /// Turns of the master since the last step.
    waited: Turns,
    /// Drifts before the cranks were moved, as each had passed its flag and just then; and the trims.
    before: PerAxis<Turns>,
    before_now: PerAxis<Turns>,
    from: PerAxis<Turns>,
    /// Checks in which some crank deviated, and how far each was off in all of them; in run, corrections in a row that look like a
    /// swap.
    checks: u8,
    off: PerAxis<Turns>,
    home_offset: Turns,
}

/// Turns of the master in one step after which something is wrong that nothing else has a name for.
const MOST_WAITED: Turns = Turns::lit("8");

/// Checks after which a crank that deviates in each is believed to.
const CHECKS: u8 = 3;
/// Corrections after which it is believed in run: by the third, what a swap does may pass for a crank that runs away.
const CONFIRMED: u8 = 2;
/// One of the looks, 16 fraction bits.
const CHECK_SHARE: i64 = 65_536 / CHECKS as i64;

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
            proven: 0,
            base: NONE,
            waited: Turns::ZERO,
            before: NONE,
            before_now: NONE,
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
        self.proven = 0;
        self.waited = Turns::ZERO;
    }

    /// Whether the cranks are where they should be.
    pub(super) const fn is_done(&self) -> bool {
        matches!(self.step, Step::Done)
    }

    /// How far the cranks were found ahead of where they were believed, since power-up.
    pub(super) const fn home_offset(&self) -> Turns {
        self.home_offset
    }

    /// Plays one tick of the search, after one in which the master made `speed` turns.
    #[inline]
    pub(super) fn advance(
        &mut self,
        monitor: &mut DriftMonitor,
        offsets: &mut PhaseOffsets,
        speed: Turns,
    ) -> Option<Fault> {
        let step = self.step;
        if let Some((axis, by)) = monitor.take_moved()
            && let Some(fault) = self.moved(axis, by, monitor, offsets)
        {
            return Some(fault);
        }
        let fault = self.go(monitor, offsets);
        if self.step != step || offsets.is_moving() {
            self.waited = Turns::ZERO;
        } else if !self.is_done() {
            self.waited = self.waited.saturating_add(speed);
        }
        // Every index is detected, or missed, within a turn or two, and looked for no more than some times.
        if fault.is_none() && self.waited > MOST_WAITED {
            self.waited = Turns::ZERO;
            return Some(Fault::new(FaultKind::IndexTimeout));
        }
        fault
    }

    #[inline]
    fn go(&mut self, monitor: &mut DriftMonitor, offsets: &mut PhaseOffsets) -> Option<Fault> {
        match self.step {
            Step::Find if monitor.is_homed() => return self.found(monitor, offsets),
            Step::Level if !offsets.is_moving() => {
                monitor.start_check();
                self.step = Step::Verify;
            }
            Step::Verify if monitor.is_check_done() => return self.checked(monitor, offsets),
            Step::Return if !offsets.is_moving() => self.finish(monitor, offsets),
            _ => {}
        }
        None
    }

    fn finish(&mut self, monitor: &mut DriftMonitor, offsets: &PhaseOffsets) {
        monitor.settle();
        self.step = Step::Done;
        self.checks = 0;
        self.before = monitor.errors_at_flags();
        self.from = *offsets.now();
    }

    /// Every index has been detected.
    #[inline(never)]
    fn found(&mut self, monitor: &mut DriftMonitor, offsets: &mut PhaseOffsets) -> Option<Fault> {
        self.find_home_offset(monitor, offsets);
        let mut target = *offsets.now();
        if offsets.corrects() {
            let error = errors(monitor, offsets);
            target = offsets.against(&error, monitor.watched(), true);
        } else if self.proves() {
            // What a homing run that was cut short left of its pattern is taken back.
            target = [Turns::ZERO; MAX_AXES];
        }
        let differs = (0..MAX_AXES).any(|axis| {
            let by = target[axis].wrapping_sub(offsets.now()[axis]);
            by.wrapping_abs() > monitor.tolerance(axis)
        });
        if differs {
            return self.move_to(target, monitor, offsets);
        }
        self.go_on(monitor, offsets)
    }

    fn proves(&self) -> bool {
        is_pattern(&self.patterns[0])
    }

    /// The cranks are together: it is proved that each is its own, or all is done.
    fn go_on(&mut self, monitor: &mut DriftMonitor, offsets: &mut PhaseOffsets) -> Option<Fault> {
        if self.proven == 0 {
            // Where nothing is corrected, the little that a homing run that was cut short left goes with the tilts.
            self.base = if offsets.corrects() {
                *offsets.now()
            } else {
                [Turns::ZERO; MAX_AXES]
            };
        }
        let pattern = self
            .patterns
            .get(self.proven)
            .filter(|levels| is_pattern(*levels));
        let Some(&pattern) = pattern else {
            if self.proven == 0 {
                self.finish(monitor, offsets);
            } else {
                offsets.go_to(&self.base);
                self.step = Step::Return;
            }
            return None;
        };
        self.proven += 1;
        // Tilted the other way it proves as much: there may be room in the trims for that alone.
        let mut trims = self.tilted(&pattern, false);
        if !has_room(&trims, monitor, offsets) {
            trims = self.tilted(&pattern, true);
        }
        if !has_room(&trims, monitor, offsets) {
            let fault = Fault::new(FaultKind::HomingRangeExceeded);
            return Some(fault.on_axis(monitor.furthest(&errors(monitor, offsets))));
        }
        self.move_to(trims, monitor, offsets)
    }

    /// The trims without a tilt, and one on top, this way or the other.
    #[inline(never)]
    fn tilted(&self, pattern: &PerAxis<Turns>, over: bool) -> PerAxis<Turns> {
        let mut trims = self.base;
        for (trim, &level) in trims.iter_mut().zip(pattern) {
            let level = if over { level.wrapping_neg() } else { level };
            *trim = trim.wrapping_add(level);
        }
        trims
    }

    /// Moves the cranks to other trims, straight and together: the platform tilts no further than at one of the two ends.
    #[inline(never)]
    fn move_to(
        &mut self,
        trims: PerAxis<Turns>,
        monitor: &DriftMonitor,
        offsets: &mut PhaseOffsets,
    ) -> Option<Fault> {
        if let Some(axis) = offsets.beyond_limit(&trims) {
            let size = monitor.phase_error()[axis];
            let fault = Fault::new(FaultKind::HomingRangeExceeded);
            return Some(fault.on_axis(axis).with_size(size));
        }
        // Both tilts are looked at against the cranks without any: from one to the other two may be moved alike.
        if self.proven <= 1 {
            self.before = monitor.errors_at_flags();
            self.before_now = monitor.filtered_error();
            self.from = *offsets.now();
        }
        self.checks = 0;
        self.off = [Turns::ZERO; MAX_AXES];
        offsets.go_to(&trims);
        self.step = Step::Level;
        None
    }

    /// What all cranks are off by together is where the machine's zero is.
    fn find_home_offset(&mut self, monitor: &mut DriftMonitor, offsets: &PhaseOffsets) {
        if !self.has_home_offset {
            return;
        }
        // Drifts may lie around half a turn: their differences have a mean.
        let watched = monitor.watched();
        let first = watched.trailing_zeros() as usize;
        let base = monitor
            .phase_error()
            .get(first)
            .copied()
            .unwrap_or_default();
        let off = monitor
            .phase_error()
            .map(|phase_error| nearest(phase_error.wrapping_sub(base)));
        let mean = nearest(base.wrapping_add(offsets.mean(&off, watched)));
        if mean.abs() > self.lag {
            monitor.shift(mean);
            self.home_offset = nearest(self.home_offset.wrapping_add(mean));
        }
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

/// Whether trims are within their limits, and would leave the platform within its own.
fn has_room(trims: &PerAxis<Turns>, monitor: &DriftMonitor, offsets: &PhaseOffsets) -> bool {
    let mut after = errors(monitor, offsets);
    let moves = trims.iter().zip(offsets.now());
    for (after, (to, &from)) in after.iter_mut().zip(moves) {
        *after = nearest(after.wrapping_add(to.wrapping_sub(from)));
    }
    offsets.beyond_limit(trims).is_none() && monitor.allows(&after)
}

/// What each crank is off from where the master has it.
pub(super) fn errors(monitor: &DriftMonitor, offsets: &PhaseOffsets) -> PerAxis<Turns> {
    core::array::from_fn(|axis| {
        nearest(monitor.phase_error()[axis].wrapping_add(offsets.now()[axis]))
    })
}

/// Whether it tilts anything.
fn is_pattern(levels: &[Turns]) -> bool {
    levels.iter().any(|&level| level != 0)
}
