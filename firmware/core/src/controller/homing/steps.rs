//! Steps of homing: find every index, level the cranks, tilt them, and take the tilt back.

use super::turn::FullTurn;
use super::verify::Verdict;
use super::{Homing, Step, errors};
use crate::monitor::{DriftMonitor, ErrorFilter};
use crate::phase_offset::PhaseOffsets;
use crate::supervisor::{Fault, FaultKind};
use crate::units::{MAX_AXES, PerAxis, Turns, nearest};

/// Largest number of turns of the master in one step. Beyond it, homing ends with an index timeout, as no other check has found a cause.
const MAX_WAITED: Turns = Turns::lit("8");

impl Homing {
    /// Plays one tick of homing. The master made `speed` turns in the tick before. Unless `has_time` is true, what can wait is left for
    /// another tick.
    #[inline]
    pub(in crate::controller) fn advance(
        &mut self,
        monitor: &mut DriftMonitor,
        offsets: &mut PhaseOffsets,
        speed: Turns,
        has_time: bool,
    ) -> Option<Fault> {
        let step = self.step;
        if let Some((axis, by)) = monitor.take_moved()
            && let Some(fault) = self.moved(axis, by, monitor, offsets)
        {
            return Some(fault);
        }
        let fault = if has_time {
            self.go(monitor, offsets)
        } else {
            None
        };
        if self.step != step || offsets.is_moving() {
            self.waited = Turns::ZERO;
        } else if !self.is_done() {
            self.waited = self.waited.saturating_add(speed);
        }
        // Each index is detected or reported as missing within one or two turns. The numbers of attempts and of extra pulses are limited.
        if fault.is_none() && self.waited > MAX_WAITED {
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
                self.turn = FullTurn::NEW;
                self.step = Step::Verify;
            }
            Step::Verify if self.turn.is_over(monitor) => match self.checked(monitor, offsets) {
                Verdict::Followed => return self.go_on(monitor, offsets),
                Verdict::Unsure => self.turn = FullTurn::NEW,
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

    /// True if all readings are available with which the cranks are compared after their move.
    fn may_move(&self, monitor: &DriftMonitor, offsets: &PhaseOffsets) -> bool {
        self.turn.is_averaged(monitor) || !(self.proves() || offsets.corrects())
    }

    fn finish(&mut self, monitor: &mut DriftMonitor, offsets: &PhaseOffsets) {
        monitor.settle();
        self.step = Step::Done;
        self.checks = 0;
        self.before = monitor.errors(ErrorFilter::AtIndex);
        self.from = *offsets.now();
    }

    /// Levels the cranks, after every index has been detected, and a turn has confirmed its place.
    #[inline(never)]
    fn found(&mut self, monitor: &mut DriftMonitor, offsets: &mut PhaseOffsets) -> Option<Fault> {
        self.find_home_offset(monitor, offsets);
        self.level(monitor, offsets)
    }

    /// True if the cranks may be levelled a second time. Cranks that are apart bend the rods, which pull soft drives away from their
    /// commands. Once the cranks are level, the rods no longer pull.
    fn may_level_again(&self, offsets: &PhaseOffsets) -> bool {
        self.proven == 0 && !self.has_levelled_again && offsets.corrects()
    }

    /// Levels the cranks.
    #[inline(never)]
    fn level(&mut self, monitor: &mut DriftMonitor, offsets: &mut PhaseOffsets) -> Option<Fault> {
        let mut target = *offsets.now();
        if offsets.corrects() {
            let error = errors(monitor, offsets);
            target = offsets.against(&error, monitor.watched(), true);
        } else if self.proves() {
            // Takes back the part of a tilt that an interrupted homing run left.
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
        is_pattern(&self.config.patterns[0])
    }

    /// Continues with levelled cranks: starts the next tilt that proves the wiring, or ends homing.
    fn go_on(&mut self, monitor: &mut DriftMonitor, offsets: &mut PhaseOffsets) -> Option<Fault> {
        if self.proven == 0 {
            // Without a correction, the small trims that an interrupted homing run left are taken back with the tilts.
            self.base = if offsets.corrects() {
                *offsets.now()
            } else {
                [Turns::ZERO; MAX_AXES]
            };
        }
        let pattern = self
            .config
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
        // The opposite tilt proves as much, and the trims may have room for that alone.
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

    /// Returns the trims without a tilt plus `pattern`, or minus it if `over`.
    #[inline(never)]
    fn tilted(&self, pattern: &PerAxis<Turns>, over: bool) -> PerAxis<Turns> {
        let mut trims = self.base;
        for (trim, &level) in trims.iter_mut().zip(pattern) {
            let level = if over { level.wrapping_neg() } else { level };
            *trim = trim.wrapping_add(level);
        }
        trims
    }

    /// Moves the cranks to other trims, linearly and at the same time. So the largest tilt of the platform is that at one of the two ends.
    #[inline(never)]
    fn move_to(
        &mut self,
        trims: PerAxis<Turns>,
        monitor: &DriftMonitor,
        offsets: &mut PhaseOffsets,
    ) -> Option<Fault> {
        if let Some(axis) = offsets.beyond_limit(&trims) {
            let size = monitor.phase_error().get(axis).copied();
            let fault = Fault::new(FaultKind::HomingRangeExceeded);
            return Some(fault.on_axis(axis).with_size(size.unwrap_or_default()));
        }
        // Both tilts are compared with the cranks before the first one. From one tilt to the other, two cranks may move alike.
        if self.proven <= 1 {
            self.before = self.turn.errors(monitor);
            self.from = *offsets.now();
        }
        self.checks = 0;
        self.off = [Turns::ZERO; MAX_AXES];
        offsets.go_to(&trims);
        self.step = Step::Level;
        None
    }

    /// Moves the zero of the machine by the phase error that all cranks have in common.
    fn find_home_offset(&mut self, monitor: &mut DriftMonitor, offsets: &PhaseOffsets) {
        if !self.config.has_home_offset {
            return;
        }
        // Phase errors may lie near half a turn, where they wrap. Their differences have a mean.
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
        if mean.abs() > self.config.lag {
            monitor.shift(mean);
            self.home_offset = nearest(self.home_offset.wrapping_add(mean));
        }
    }
}

/// True if the trims are within their limits and keep the platform within its own.
fn has_room(trims: &PerAxis<Turns>, monitor: &DriftMonitor, offsets: &PhaseOffsets) -> bool {
    let mut after = errors(monitor, offsets);
    let moves = trims.iter().zip(offsets.now());
    for (after, (to, &from)) in after.iter_mut().zip(moves) {
        *after = nearest(after.wrapping_add(to.wrapping_sub(from)));
    }
    offsets.beyond_limit(trims).is_none() && monitor.allows(&after)
}

/// True if a pattern tilts the platform.
fn is_pattern(levels: &[Turns]) -> bool {
    levels.iter().any(|&level| level != 0)
}
