//! Finding out where the cranks stand, and bringing them together.
//!
//! After power-up phases are unknown, and the cranks are joined by the platform: none may be turned alone. So all creep together
//! until every index has been heard, within a turn and what may be overdue. What all are off by in common is taken for the
//! machine's own zero, the *datum*; what they are off from each other is trimmed away, all at once and within the limits,
//! and looked at for a turn more. A crank that is too far out for that is refused.
//!
//! To *prove the wiring* each crank is moved by an amount of its own besides. A crank that follows its own lines keeps its drift,
//! as that is against what it is told; where the lines of two are swapped, each shows what the other was told. Then all is
//! taken back.

use crate::axes::Correction;
use crate::drift::DriftMonitor;
use crate::supervisor::{Fault, FaultKind};
use crate::units::{Turns, nearest};

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

/// Brings `N` cranks together.
#[derive(Clone, Debug)]
pub(super) struct Align<const N: usize> {
    step: Step,
    /// What moves each crank by an amount of its own; zero if the wiring is not to be proved.
    pattern: [Turns; N],
    /// Whether there is a common zero: all cranks turn once with the master.
    has_datum: bool,
    /// A mean up to this is lag, and no other zero.
    lag: Turns,
    /// Drifts before the cranks were moved, where they were then, and where they are to be.
    before: [Turns; N],
    from: [Turns; N],
    target: [Turns; N],
    datum: Turns,
}

/// How many tolerances two levels of the pattern are apart.
const APART: i64 = 3;

/// The pattern that proves the wiring: levels `apart` from each other, the upper ones on even axes and the lower ones on odd, so that
/// the platform tilts and bends little; their sum is zero.
pub(super) fn pattern<const N: usize>(tolerance: Turns) -> [Turns; N] {
    let half = tolerance.to_bits() * APART / 2;
    let upper = N.div_ceil(2);
    core::array::from_fn(|axis| {
        let rank = if axis % 2 == 0 {
            axis / 2
        } else {
            upper + axis / 2
        };
        Turns::from_bits((N as i64 - 1 - 2 * rank as i64) * half)
    })
}

impl<const N: usize> Align<N> {
    /// With the pattern that proves the wiring, or none.
    pub(super) const fn new(pattern: [Turns; N], has_datum: bool, lag: Turns) -> Self {
        Self {
            step: Step::Off,
            pattern,
            has_datum,
            lag,
            before: [Turns::ZERO; N],
            from: [Turns::ZERO; N],
            target: [Turns::ZERO; N],
            datum: Turns::ZERO,
        }
    }

    /// Begins.
    pub(super) const fn begin(&mut self) {
        self.step = Step::Find;
    }

    /// Whether the cranks are where they should be.
    pub(super) const fn is_done(&self) -> bool {
        matches!(self.step, Step::Done)
    }

    /// How far the cranks were found ahead of where they were believed, since power-up.
    pub(super) const fn datum(&self) -> Turns {
        self.datum
    }

    /// Plays one tick of the search.
    pub(super) fn advance(
        &mut self,
        monitor: &mut DriftMonitor<N>,
        correction: &mut Correction<N>,
    ) -> Option<Fault> {
        match self.step {
            Step::Find if monitor.is_aligned() => return self.found(monitor, correction),
            Step::Move if !correction.is_moving() => {
                monitor.look_again();
                self.step = Step::Look;
            }
            Step::Look if monitor.has_looked() => return self.looked(monitor, correction),
            Step::Return if !correction.is_moving() => self.finish(monitor),
            _ => {}
        }
        None
    }

    fn finish(&mut self, monitor: &mut DriftMonitor<N>) {
        monitor.settle();
        self.step = Step::Done;
    }

    /// Every index has been heard.
    #[cold]
    fn found(
        &mut self,
        monitor: &mut DriftMonitor<N>,
        correction: &mut Correction<N>,
    ) -> Option<Fault> {
        self.find_datum(monitor);
        let proves = self.pattern.iter().any(|&level| level != 0);
        let error = errors(monitor, correction);
        let target = correction.against(&error, monitor.watched(), true);
        let differs = (0..N).any(|axis| {
            let by = target[axis].wrapping_sub(correction.now()[axis]);
            by.wrapping_abs() > monitor.tolerance(axis)
        });
        let corrects = correction.is_on() && differs;
        if !proves && !corrects {
            self.finish(monitor);
            return None;
        }
        // Where nothing is corrected, what an align that was cut short left of its pattern is taken back.
        self.target = if correction.is_on() {
            target
        } else {
            [Turns::ZERO; N]
        };
        let mut moved = self.target;
        for (moved, &level) in moved.iter_mut().zip(&self.pattern) {
            *moved = moved.wrapping_add(level);
        }
        let refused = correction.past_limit(&self.target);
        if let Some(axis) = refused.or_else(|| correction.past_limit(&moved)) {
            let size = monitor.drift()[axis];
            let fault = Fault::new(FaultKind::TooFarOut);
            return Some(fault.on_axis(axis).with_size(size));
        }
        self.before = *monitor.drift();
        self.from = *correction.now();
        // All go straight from where they are to the pattern: the platform tilts no further than at one of these ends, and both
        // are within its limits.
        correction.go_to(moved);
        self.step = Step::Move;
        None
    }

    /// What all cranks are off by together is where the machine's zero is.
    fn find_datum(&mut self, monitor: &mut DriftMonitor<N>) {
        if !self.has_datum {
            return;
        }
        let watched = monitor.watched();
        let axes = || (0..N).filter(move |&axis| watched & 1 << axis != 0);
        let Some(first) = axes().next() else { return };
        let base = monitor.drift()[first];
        let off = |axis: usize| nearest(monitor.drift()[axis].wrapping_sub(base)).to_bits();
        let sum: i64 = axes().map(off).sum();
        let mean = nearest(base.wrapping_add(Turns::from_bits(sum / axes().count() as i64)));
        if mean.abs() > self.lag {
            monitor.shift(mean);
            self.datum = nearest(self.datum.wrapping_add(mean));
        }
    }

    /// The cranks have been moved, and each heard once more.
    #[cold]
    fn looked(
        &mut self,
        monitor: &mut DriftMonitor<N>,
        correction: &mut Correction<N>,
    ) -> Option<Fault> {
        let moved = |axis: usize| correction.now()[axis].wrapping_sub(self.from[axis]);
        for axis in (0..N).filter(|&axis| monitor.watched() & 1 << axis != 0) {
            let off = nearest(monitor.drift()[axis].wrapping_sub(self.before[axis]));
            let tolerance = monitor.tolerance(axis);
            let allowed = Turns::from_bits(tolerance.to_bits() * APART / 2);
            if off.abs() <= allowed {
                continue;
            }
            // As far off as some other crank was moved further?
            let follows = |other: usize| {
                let between = moved(other).wrapping_sub(moved(axis));
                other != axis && nearest(off.wrapping_sub(between)).abs() <= tolerance
            };
            let kind = if (0..N).any(follows) {
                FaultKind::SwappedWiring
            } else {
                FaultKind::Slip
            };
            return Some(Fault::new(kind).on_axis(axis).with_size(off));
        }
        if self.pattern.iter().all(|&level| level == 0) {
            self.finish(monitor);
        } else {
            correction.go_to(self.target);
            self.step = Step::Return;
        }
        None
    }
}

/// What each crank is off from where the master has it.
pub(super) fn errors<const N: usize>(
    monitor: &DriftMonitor<N>,
    correction: &Correction<N>,
) -> [Turns; N] {
    core::array::from_fn(|axis| nearest(monitor.drift()[axis].wrapping_add(correction.now()[axis])))
}
