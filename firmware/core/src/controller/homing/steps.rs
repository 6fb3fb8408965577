//! Steps of homing: find every index, bring the cranks together, tilt them, take that back.

use super::verify::Verdict;
use super::{Homing, Step, errors};
use crate::axes::PhaseOffsets;
use crate::drift::DriftMonitor;
use crate::supervisor::{Fault, FaultKind};
use crate::units::{MAX_AXES, PerAxis, Turns, nearest};

/// Turns of the master in one step after which something is wrong that nothing else has a name for.
const MOST_WAITED: Turns = Turns::lit("8");

impl Homing {
    /// Plays one tick of the search, after one in which the master made `speed` turns.
    #[inline]
    pub(in crate::controller) fn advance(
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
        // To evaluate pulses takes as long as a step of homing.
        let fault = if monitor.is_busy() {
            None
        } else {
            self.go(monitor, offsets)
        };
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
            Step::Find if monitor.is_homed() && self.may_move(monitor, offsets) => {
                return self.found(monitor, offsets);
            }
            Step::Level if !offsets.is_moving() => {
                monitor.start_check();
                self.step = Step::Verify;
            }
            Step::Verify if monitor.is_check_done() => match self.checked(monitor, offsets) {
                Verdict::Followed => return self.go_on(monitor, offsets),
                Verdict::Unsure => monitor.start_check(),
                Verdict::Deviates { is_mutual, .. }
                    if !is_mutual && self.may_level_again(offsets) =>
                {
                    self.has_levelled_again = true;
                    return self.level(monitor, offsets);
                }
                Verdict::Deviates { fault, .. } => return Some(fault),
            },
            Step::Return if !offsets.is_moving() => self.finish(monitor, offsets),
            _ => {}
        }
        None
    }

    /// True once all is known that the cranks are compared with after they were moved.
    fn may_move(&self, monitor: &DriftMonitor, offsets: &PhaseOffsets) -> bool {
        monitor.is_turn_over() || !(self.proves() || offsets.corrects())
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
        self.level(monitor, offsets)
    }

    /// True if the cranks may be brought together once more. Cranks that are apart bend the rods, which pull soft drives away from their
    /// commands, and let go once the cranks are together.
    fn may_level_again(&self, offsets: &PhaseOffsets) -> bool {
        self.proven == 0 && !self.has_levelled_again && offsets.corrects()
    }

    /// Brings the cranks together.
    #[inline(never)]
    fn level(&mut self, monitor: &mut DriftMonitor, offsets: &mut PhaseOffsets) -> Option<Fault> {
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
        // Tilted the other way it proves as much. Where readings alone could be beyond a limit, there may be more room that way.
        let [trims, over] = [false, true].map(|over| self.tilted(&pattern, over));
        let choices = [(&trims, true), (&over, false), (&trims, false)];
        let chosen = choices
            .into_iter()
            .find(|&(trims, spare)| has_room(trims, spare, monitor, offsets));
        let Some((&trims, _)) = chosen else {
            let fault = Fault::new(FaultKind::HomingRangeExceeded);
            return Some(fault.on_axis(monitor.furthest(&errors(monitor, offsets))));
        };
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
            self.before = monitor.turn_errors();
            self.from = *offsets.now();
        }
        self.checks = 0;
        self.off = [Turns::ZERO; MAX_AXES];
        offsets.go_to(&trims);
        self.step = Step::Level;
        None
    }

    /// The error that all cranks have in common is the place of the machine's zero.
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
}

/// True if trims are within their limits, and leave the platform within its own; with `spare`, even if each reading errs as far as it may.
fn has_room(
    trims: &PerAxis<Turns>,
    spare: bool,
    monitor: &DriftMonitor,
    offsets: &PhaseOffsets,
) -> bool {
    let mut after = errors(monitor, offsets);
    let moves = trims.iter().zip(offsets.now());
    for (axis, (after, (to, &from))) in after.iter_mut().zip(moves).enumerate() {
        let by = to.wrapping_sub(from);
        let most = if spare {
            monitor.tolerance(axis)
        } else {
            Turns::ZERO
        };
        let error = if by < 0 { most.wrapping_neg() } else { most };
        *after = nearest(after.wrapping_add(by).wrapping_add(error));
    }
    offsets.beyond_limit(trims).is_none() && monitor.allows(&after)
}

/// Whether it tilts anything.
fn is_pattern(levels: &[Turns]) -> bool {
    levels.iter().any(|&level| level != 0)
}
