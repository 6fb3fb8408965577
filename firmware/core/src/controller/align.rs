//! Finding out where the cranks stand, and bringing them together.
//!
//! After power-up phases are unknown, and the cranks are joined by the platform: none may be turned alone. So all creep together
//! until every index has been heard, within a turn and what may be overdue. What all are off by in common is taken for the
//! machine's own zero, the *datum*; what they are off from each other is trimmed away, all at once and within the limits,
//! and looked at for a turn more. A crank that is too far out for that is refused.
//!
//! To *prove the wiring* the platform is then tilted, about one axis and about the other: any two cranks are moved differently once.
//! A crank that follows its own lines keeps its drift, as that is against what it is told; where the lines of two are swapped,
//! each shows what the other was told. A plane bends nothing, however stiff the rods. Then all is taken back.
//!
//! A crank *strays* that did not do what it was told in three looks, turn after turn: a rotor swings in its field when it is
//! moved slowly, and one look alone may catch it so.

mod looks;

use crate::axes::Correction;
use crate::drift::{AxisSet, DriftMonitor};
use crate::supervisor::{Fault, FaultKind};
use crate::units::{MAX_AXES, PerAxis, Turns, nearest};
use looks::{Moves, Stray, When};

/// How far align has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Step {
    /// Not asked for.
    #[default]
    Off,
    /// Not every index has been heard.
    Find,
    /// The cranks are moved.
    Move,
    /// They are looked at once more.
    Look,
    /// What proved the wiring is taken back.
    Return,
    /// They are where they should be.
    Done,
}

/// Brings the cranks together.
#[derive(Clone, Debug)]
pub(super) struct Align {
    step: Step,
    /// The two tilts; zero if the wiring is not to be proved.
    patterns: [PerAxis<Turns>; 2],
    /// Whether there is a common zero: all cranks turn once with the master.
    has_datum: bool,
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
    /// Looks in which some crank strayed, and by how much each was off in all of them; in run, corrections in a row that look like a swap.
    looks: u8,
    off: PerAxis<Turns>,
    datum: Turns,
}

/// Turns of the master in one step after which something is wrong that nothing else has a name for.
const MOST_WAITED: Turns = Turns::lit("8");

/// Looks after which a crank that strays in each is believed to.
const LOOKS: u8 = 3;
/// Corrections after which it is believed in run: by the third, what a swap does may pass for a crank that runs away.
const TWICE: u8 = 2;
/// One of the looks, 16 fraction bits.
const PART_OF_LOOKS: i64 = 65_536 / LOOKS as i64;

impl Align {
    /// For no axes.
    pub(super) const fn new() -> Self {
        const NONE: PerAxis<Turns> = [Turns::ZERO; MAX_AXES];
        Self {
            step: Step::Off,
            patterns: [NONE; 2],
            has_datum: false,
            count: 0,
            lag: Turns::ZERO,
            tolerance: NONE,
            proven: 0,
            base: NONE,
            waited: Turns::ZERO,
            before: NONE,
            before_now: NONE,
            from: NONE,
            looks: 0,
            off: NONE,
            datum: Turns::ZERO,
        }
    }

    /// Begins anew, with the tilts that prove the wiring, or none.
    #[cold]
    pub(super) const fn configure(
        &mut self,
        patterns: [PerAxis<Turns>; 2],
        has_datum: bool,
        count: usize,
        lag: Turns,
        tolerance: PerAxis<Turns>,
    ) {
        *self = Self::new();
        self.patterns = patterns;
        self.has_datum = has_datum;
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
    pub(super) const fn datum(&self) -> Turns {
        self.datum
    }

    /// Plays one tick of the search, after one in which the master made `speed` turns.
    #[inline]
    pub(super) fn advance(
        &mut self,
        monitor: &mut DriftMonitor,
        correction: &mut Correction,
        speed: Turns,
    ) -> Option<Fault> {
        let step = self.step;
        if let Some((axis, by)) = monitor.take_moved()
            && let Some(fault) = self.moved(axis, by, monitor, correction)
        {
            return Some(fault);
        }
        let fault = self.go(monitor, correction);
        if self.step != step || correction.is_moving() {
            self.waited = Turns::ZERO;
        } else if !self.is_done() {
            self.waited = self.waited.saturating_add(speed);
        }
        // Every index is heard, or missed, within a turn or two, and looked for no more than some times.
        if fault.is_none() && self.waited > MOST_WAITED {
            self.waited = Turns::ZERO;
            return Some(Fault::new(FaultKind::Silent));
        }
        fault
    }

    #[inline]
    fn go(&mut self, monitor: &mut DriftMonitor, correction: &mut Correction) -> Option<Fault> {
        match self.step {
            Step::Find if monitor.is_aligned() => return self.found(monitor, correction),
            Step::Move if !correction.is_moving() => {
                monitor.look_again();
                self.step = Step::Look;
            }
            Step::Look if monitor.has_looked() => return self.looked(monitor, correction),
            Step::Return if !correction.is_moving() => self.finish(monitor, correction),
            _ => {}
        }
        None
    }

    fn finish(&mut self, monitor: &mut DriftMonitor, correction: &Correction) {
        monitor.settle();
        self.step = Step::Done;
        self.looks = 0;
        self.before = monitor.drift_at_flags();
        self.from = *correction.now();
    }

    /// Every index has been heard.
    #[inline(never)]
    fn found(&mut self, monitor: &mut DriftMonitor, correction: &mut Correction) -> Option<Fault> {
        self.find_datum(monitor, correction);
        let mut target = *correction.now();
        if correction.is_on() {
            let error = errors(monitor, correction);
            target = correction.against(&error, monitor.watched(), true);
        } else if self.proves() {
            // What an align that was cut short left of its pattern is taken back.
            target = [Turns::ZERO; MAX_AXES];
        }
        let differs = (0..MAX_AXES).any(|axis| {
            let by = target[axis].wrapping_sub(correction.now()[axis]);
            by.wrapping_abs() > monitor.tolerance(axis)
        });
        if differs {
            return self.move_to(target, monitor, correction);
        }
        self.go_on(monitor, correction)
    }

    fn proves(&self) -> bool {
        is_pattern(&self.patterns[0])
    }

    /// The cranks are together: it is proved that each is its own, or all is done.
    fn go_on(&mut self, monitor: &mut DriftMonitor, correction: &mut Correction) -> Option<Fault> {
        if self.proven == 0 {
            // Where nothing is corrected, the little that an align that was cut short left goes with the tilts.
            self.base = if correction.is_on() {
                *correction.now()
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
                self.finish(monitor, correction);
            } else {
                correction.go_to(self.base);
                self.step = Step::Return;
            }
            return None;
        };
        self.proven += 1;
        // Tilted the other way it proves as much: there may be room in the trims for that alone.
        let mut trims = self.tilted(&pattern, false);
        if !has_room(&trims, monitor, correction) {
            trims = self.tilted(&pattern, true);
        }
        if !has_room(&trims, monitor, correction) {
            let fault = Fault::new(FaultKind::TooFarOut);
            return Some(fault.on_axis(monitor.furthest(&errors(monitor, correction))));
        }
        self.move_to(trims, monitor, correction)
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
        correction: &mut Correction,
    ) -> Option<Fault> {
        if let Some(axis) = correction.past_limit(&trims) {
            let size = monitor.drift()[axis];
            let fault = Fault::new(FaultKind::TooFarOut);
            return Some(fault.on_axis(axis).with_size(size));
        }
        // Both tilts are looked at against the cranks without any: from one to the other two may be moved alike.
        if self.proven <= 1 {
            self.before = monitor.drift_at_flags();
            self.before_now = monitor.calm_drift();
            self.from = *correction.now();
        }
        self.looks = 0;
        self.off = [Turns::ZERO; MAX_AXES];
        correction.go_to(trims);
        self.step = Step::Move;
        None
    }

    /// What all cranks are off by together is where the machine's zero is.
    fn find_datum(&mut self, monitor: &mut DriftMonitor, correction: &Correction) {
        if !self.has_datum {
            return;
        }
        // Drifts may lie around half a turn: their differences have a mean.
        let watched = monitor.watched();
        let first = watched.trailing_zeros() as usize;
        let base = monitor.drift().get(first).copied().unwrap_or_default();
        let off = monitor
            .drift()
            .map(|drift| nearest(drift.wrapping_sub(base)));
        let mean = nearest(base.wrapping_add(correction.mean(&off, watched)));
        if mean.abs() > self.lag {
            monitor.shift(mean);
            self.datum = nearest(self.datum.wrapping_add(mean));
        }
    }

    /// What the cranks did since they were moved to trims, by their drifts now.
    const fn moves<'a>(
        &'a self,
        when: When,
        drift: &'a PerAxis<Turns>,
        to: &'a PerAxis<Turns>,
    ) -> Moves<'a> {
        Moves {
            when,
            before: &self.before,
            drift,
            from: &self.from,
            to,
            tolerance: &self.tolerance,
            count: self.count,
        }
    }

    /// Of a set of cranks that are on their way to where they were told to go, the one that strays most.
    fn on_the_way(
        &self,
        set: AxisSet,
        monitor: &DriftMonitor,
        correction: &Correction,
    ) -> Option<Stray> {
        let drift = monitor.calm_drift();
        self.moves(When::OnTheWay, &drift, correction.target())
            .stray(set)
    }

    /// Why cranks that were moved seem too far out, if it is that two are swapped.
    #[inline(never)]
    pub(super) fn explain(&self, monitor: &DriftMonitor, correction: &Correction) -> Option<Fault> {
        if !matches!(self.step, Step::Move | Step::Look) {
            return None;
        }
        // While they are on their way, each may show part of what the other was told.
        let stray = self.on_the_way(monitor.watched(), monitor, correction)?;
        let fault = Fault::new(FaultKind::SwappedWiring).on_axis(stray.axis);
        stray.is_swapped.then_some(fault.with_size(stray.off))
    }

    /// A crank was heard elsewhere than in the turn before, by so much: that is told at once, unless it is no further than a rotor
    /// swings, or another was told to go there, so that the looks have to tell.
    #[inline(never)]
    fn moved(
        &self,
        axis: usize,
        by: Turns,
        monitor: &DriftMonitor,
        correction: &Correction,
    ) -> Option<Fault> {
        if by.abs() <= monitor.swing(axis) {
            return None;
        }
        if self.step != Step::Find && self.on_the_way(1 << axis, monitor, correction)?.is_swapped {
            return None;
        }
        let kind = monitor.name_of(axis, by);
        Some(Fault::new(kind).on_axis(axis).with_size(by))
    }

    /// The cranks are about to be corrected once more, in run: whether they did what they were told the last time. One that shows
    /// in two corrections, one after the other, what another was told has its lines swapped with that one's, and the more is
    /// corrected the further they go.
    #[inline(never)]
    pub(super) fn corrected(
        &mut self,
        monitor: &DriftMonitor,
        correction: &Correction,
    ) -> Option<Fault> {
        let drift = monitor.drift_at_flags();
        let swapped = self
            .moves(When::Corrected, &drift, correction.now())
            .stray(monitor.watched())
            .filter(|stray| stray.is_swapped);
        self.before = drift;
        self.from = *correction.now();
        let Some(swapped) = swapped else {
            self.looks = 0;
            return None;
        };
        self.looks += 1;
        let fault = Fault::new(FaultKind::SwappedWiring).on_axis(swapped.axis);
        (self.looks >= TWICE).then_some(fault.with_size(swapped.off))
    }

    /// Where cranks are now that were moved, next to [`Self::before`]. What loads do to a crank differs by its angle, which is the same at
    /// its flag, and by how fast the machine goes, which it does not yet at the first: so the less of both counts.
    fn drift_since(&self, monitor: &DriftMonitor) -> PerAxis<Turns> {
        let mut drift = monitor.drift_at_flags();
        let now = monitor.calm_drift();
        for ((at_flag, &before), (&now, &before_now)) in drift
            .iter_mut()
            .zip(&self.before)
            .zip(now.iter().zip(&self.before_now))
        {
            let by_flag = nearest(at_flag.wrapping_sub(before));
            let by_now = nearest(now.wrapping_sub(before_now));
            let less = if (by_flag < 0) != (by_now < 0) {
                Turns::ZERO
            } else if by_now.abs() < by_flag.abs() {
                by_now
            } else {
                by_flag
            };
            *at_flag = before.wrapping_add(less);
        }
        drift
    }

    /// The cranks have been moved, and each heard once more.
    #[inline(never)]
    fn looked(&mut self, monitor: &mut DriftMonitor, correction: &mut Correction) -> Option<Fault> {
        monitor.refresh();
        let mut drift = self.drift_since(monitor);
        self.looks += 1;
        for (sum, (now, &before)) in self.off.iter_mut().zip(drift.iter().zip(&self.before)) {
            *sum = sum.wrapping_add(nearest(now.wrapping_sub(before)));
        }
        let moves = self.moves(When::Moved, &drift, correction.now());
        if moves.stray(monitor.watched()).is_none() {
            return self.go_on(monitor, correction);
        }
        if self.looks < LOOKS {
            monitor.look_again();
            return None;
        }
        for (mean, (off, &before)) in drift.iter_mut().zip(self.off.iter().zip(&self.before)) {
            let off = Turns::from_bits((off.to_bits() >> 16) * PART_OF_LOOKS);
            *mean = before.wrapping_add(off);
        }
        let moves = self.moves(When::Moved, &drift, correction.now());
        let Some(stray) = moves.stray(monitor.watched()) else {
            return self.go_on(monitor, correction);
        };
        let kind = if stray.is_swapped {
            FaultKind::SwappedWiring
        } else {
            monitor.name_of(stray.axis, stray.off)
        };
        Some(Fault::new(kind).on_axis(stray.axis).with_size(stray.off))
    }
}

/// Whether trims are within their limits, and would leave the platform within its own.
fn has_room(trims: &PerAxis<Turns>, monitor: &DriftMonitor, correction: &Correction) -> bool {
    let mut after = errors(monitor, correction);
    let moves = trims.iter().zip(correction.now());
    for (after, (to, &from)) in after.iter_mut().zip(moves) {
        *after = nearest(after.wrapping_add(to.wrapping_sub(from)));
    }
    correction.past_limit(trims).is_none() && monitor.allows(&after)
}

/// What each crank is off from where the master has it.
pub(super) fn errors(monitor: &DriftMonitor, correction: &Correction) -> PerAxis<Turns> {
    core::array::from_fn(|axis| nearest(monitor.drift()[axis].wrapping_add(correction.now()[axis])))
}

/// Whether it tilts anything.
fn is_pattern(levels: &[Turns]) -> bool {
    levels.iter().any(|&level| level != 0)
}
