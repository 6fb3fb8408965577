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
    #[inline]
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
        self.find_datum(monitor, correction);
        let proves = self.pattern.iter().any(|&level| level != 0);
        let error = errors(monitor, correction);
        let target = correction.against(&error, monitor.watched(), true);
        let differs = (0..N).any(|axis| {
            let by = target[axis].wrapping_sub(correction.now()[axis]);
            by.wrapping_abs() > monitor.tolerance(axis)
        });
        let corrects = correction.is_on() && differs;
        if !(proves || corrects) {
            self.finish(monitor);
            return None;
        }
        self.target = if correction.is_on() {
            target
        } else {
            *correction.now()
        };
        if let Some(axis) = correction.past_limit(&self.target) {
            let size = monitor.drift()[axis];
            let fault = Fault::new(FaultKind::TooFarOut);
            return Some(fault.on_axis(axis).with_size(size));
        }
        self.before = *monitor.drift();
        self.from = *correction.now();
        let mut moved = self.target;
        for (moved, &level) in moved.iter_mut().zip(&self.pattern) {
            *moved = moved.wrapping_add(level);
        }
        // A pattern on top of what is corrected may pass a trim's limit; the platform's own it does not, for long.
        correction.go_to(moved);
        self.step = Step::Move;
        None
    }

    /// What all cranks are off by together is where the machine's zero is.
    fn find_datum(&mut self, monitor: &mut DriftMonitor<N>, correction: &Correction<N>) {
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

    /// The cranks have been moved, and each heard once more.
    #[cold]
    fn looked(
        &mut self,
        monitor: &mut DriftMonitor<N>,
        correction: &mut Correction<N>,
    ) -> Option<Fault> {
        let mut looks = [Look::default(); N];
        for (axis, look) in looks.iter_mut().enumerate() {
            let off = monitor.drift()[axis].wrapping_sub(self.before[axis]);
            *look = Look {
                off: nearest(off),
                moved: correction.now()[axis].wrapping_sub(self.from[axis]),
                tolerance: monitor.tolerance(axis),
            };
        }
        if let Some(fault) = stray(&looks, monitor.watched()) {
            return Some(fault);
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

/// What a crank was found to have done when it was moved.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    /// Away from what it was told.
    off: Turns,
    /// What it was told.
    moved: Turns,
    tolerance: Turns,
}

/// A crank that did not do what it was told, and what may be the reason.
#[inline(never)] // one for every number of axes
fn stray(looks: &[Look], watched: u8) -> Option<Fault> {
    let strays = |look: &Look| {
        let allowed = Turns::from_bits(look.tolerance.to_bits() * APART / 2);
        look.off.abs() > allowed
    };
    let (axis, look) = looks
        .iter()
        .enumerate()
        .find(|&(axis, look)| watched & 1 << axis != 0 && strays(look))?;
    // As far off as some other crank was moved further?
    let follows = |other: usize, by: Turns| {
        let between = by.wrapping_sub(look.moved);
        other != axis && nearest(look.off.wrapping_sub(between)).abs() <= look.tolerance
    };
    let mut others = looks.iter().enumerate();
    let kind = if others.any(|(other, at)| follows(other, at.moved)) {
        FaultKind::SwappedWiring
    } else {
        FaultKind::Slip
    };
    Some(Fault::new(kind).on_axis(axis).with_size(look.off))
}

/// What each crank is off from where the master has it.
pub(super) fn errors<const N: usize>(
    monitor: &DriftMonitor<N>,
    correction: &Correction<N>,
) -> [Turns; N] {
    core::array::from_fn(|axis| nearest(monitor.drift()[axis].wrapping_add(correction.now()[axis])))
}
