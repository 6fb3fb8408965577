//! Index sensor of one axis: which of its pulses are those of the flag, and when a pulse is missing.
//!
//! A pulse is *in place* if it shows the offset of the pulse before, to within the gate. Any other pulse is an *outlier*: noise, or a crank
//! that has moved. The next pulse decides which. A pulse in place shows that the outlier was an extra pulse. No pulse in place, or the
//! outlier again a turn later, shows that the crank has moved. So an extra pulse does not count as a phase error, unless the flag's own
//! pulse is missing. A crank that has moved is detected within a turn and the gate.
//!
//! The first pulse of all may be noise, so it is no more than a *guess*. The offset is *confirmed* by two pulses a turn apart, in the same
//! place or as near as a rotor swings, without an outlier between them. Before that, no pulse near a guess shows that the guess was noise,
//! if an outlier came meanwhile. The outlier is the next guess. Without an outlier the flag has made the pulse, and the crank has moved.
//!
//! The *offset* of a pulse is the angle of the flag minus the phase of the axis at that moment. Without an encoder that is the commanded
//! phase, and the offset is the phase error. With an encoder it is the measured phase, and the offset is the difference of crank and
//! encoder.

mod detection;

pub(in crate::drift) use detection::Detection;

use super::tick_phase::{IndexPulse, TickClock, TickPhase};
use crate::drift::axis_watch::Traits;
use crate::units::{ONE_TURN, Phase, Turns, nearest};

const ONE: Turns = Turns::from_bits(ONE_TURN);
const HALF: Turns = Turns::from_bits(ONE_TURN / 2);

/// Turns after the pulse before at which an extra pulse may be that of a runaway. At more than twice the commanded speed, a crank passes
/// its flag once between, and once in its place. Below ½ turn it would be slower. Above p = 0.618, with p² + p = 1, the next pulse still
/// shows the runaway in time. The range is wider by 0.02 and 0.04, for a master that accelerates.
const BETWEEN: core::ops::Range<Turns> = Turns::lit("0.48")..Turns::lit("0.66");

/// Binary logarithm of the number of index pulses over which the difference of crank and encoder is averaged.
const FILTER_SHIFT: u32 = 4;

/// A pulse out of place.
#[derive(Clone, Copy, Debug)]
struct Outlier {
    offset: Turns,
    at: Phase,
}

/// Distance from an extra pulse to the pulse in its place, and the offset of the extra one from that.
#[derive(Clone, Copy, Debug)]
struct Spacing {
    turns: Turns,
    by: Turns,
}

/// State of the pulse that comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Due {
    /// It is expected.
    Expected,
    /// It did not come in its place.
    Late,
    /// It is so late that the crank may be beyond its limit.
    Overdue,
}

/// Watches one sensor.
#[derive(Clone, Debug)]
pub(in crate::drift) struct IndexWatch {
    /// Offset of the last pulse that counted.
    pub(in crate::drift) offset: Turns,
    /// Number of pulses of which `offset` is the mean, with an encoder; 0 before the first.
    meant: u8,
    /// True once a turn has confirmed the offset.
    is_confirmed: bool,
    /// Phase at that pulse; before the first pulse, the phase at which the search began.
    detected_at: Phase,
    outlier: Option<Outlier>,
    spacing: Option<Spacing>,
    due: Due,
    /// Missing pulses in a row that were tolerated.
    pub(in crate::drift) missed: u8,
    /// Turns since `detected_at` at which a missing pulse has a consequence.
    alert: Turns,
}

impl IndexWatch {
    /// Watch that has no pulse yet. The first is expected within a turn from `phase`, and is overdue later than that. A pulse within a
    /// tolerance of `phase` does not count, and its next one may be late by another tolerance, which is within the gate.
    pub(in crate::drift) fn new(traits: &Traits, phase: Phase) -> Self {
        Self {
            offset: Turns::ZERO,
            meant: 0,
            is_confirmed: false,
            detected_at: phase,
            outlier: None,
            spacing: None,
            due: Due::Expected,
            missed: 0,
            alert: ONE.wrapping_add(traits.overdue(true)),
        }
    }

    pub(in crate::drift) const fn is_known(&self) -> bool {
        self.meant > 0
    }

    /// True if a turn has confirmed where the first pulses were.
    pub(in crate::drift) const fn is_confirmed(&self) -> bool {
        self.is_confirmed
    }

    /// True if a crank at this phase, with the offset that the last pulse showed, may swing over an end of its flag.
    pub(in crate::drift) fn is_at_flag(&self, traits: &Traits, phase: Phase) -> bool {
        let Traits { index, flag, .. } = *traits;
        let swing = traits.swing();
        let crank = phase.advanced(self.offset);
        self.is_known()
            && [index, index.wrapping_add(flag)]
                .iter()
                .any(|&end| nearest(Phase::from_turns(end).since(crank)).abs() <= swing)
    }

    /// True if the pulse did not come in its place.
    pub(in crate::drift) fn is_late(&self) -> bool {
        self.due != Due::Expected
    }

    /// Turns from the end of a tick until a missing pulse has a consequence. It becomes negative no later than [`Self::has_timed_out`]
    /// becomes true, as that counts only part of the tick.
    pub(in crate::drift) const fn margin(&self, phase: &TickPhase) -> Turns {
        let end = phase.start.advanced(phase.turns);
        self.alert.saturating_sub(end.since(self.detected_at))
    }

    /// Delay of the next pulse at the end of a tick, turns; 0 if it is not due.
    pub(in crate::drift) fn lateness(&self, phase: &TickPhase) -> Turns {
        let end = phase.start.advanced(phase.turns);
        end.since(self.detected_at)
            .wrapping_sub(ONE)
            .max(Turns::ZERO)
    }

    /// True if it is certain that no pulse came up to `alert`.
    pub(in crate::drift) fn has_timed_out(
        &self,
        traits: &Traits,
        phase: &TickPhase,
        commanded: Turns,
    ) -> bool {
        let sure = (commanded.to_bits() >> 16).wrapping_mul(i64::from(traits.covered));
        let since = phase.start.since(self.detected_at);
        since.wrapping_add(Turns::from_bits(sure)) > self.alert
    }

    /// Processes a tick without a pulse. The delay of the line is converted by the `commanded` turns, as measured turns would multiply the
    /// noise of an encoder.
    #[inline(never)] // It is rare, and a loop over all axes needs the registers.
    pub(in crate::drift) fn check_timeout(
        &mut self,
        traits: &Traits,
        phase: &TickPhase,
        commanded: Turns,
        is_homing: bool,
    ) -> Detection {
        if !self.has_timed_out(traits, phase, commanded) {
            return Detection::Nothing;
        }
        match self.time_out(traits, is_homing) {
            // The pulse may become late and overdue in the same tick. Without an encoder, the latter counts.
            Detection::Undetected
                if !traits.has_encoder && self.has_timed_out(traits, phase, commanded) =>
            {
                self.time_out(traits, is_homing)
            }
            detection => detection,
        }
    }

    /// Processes a pulse from the tick that `phase` describes, or from the tick before it, in which the axis made `before` turns, if known.
    #[inline(never)] // It is rare, and a loop over all axes needs the registers.
    pub(in crate::drift) fn detect(
        &mut self,
        traits: &Traits,
        pulse: IndexPulse,
        phase: &TickPhase,
        commanded: Turns,
        before: Option<Turns>,
        clock: TickClock,
    ) -> Detection {
        let cycle = pulse.cycle.unsigned_abs();
        let (tick, cycle) = if pulse.cycle >= 0 {
            (*phase, cycle)
        } else if let Some(before) = before {
            let tick = TickPhase::ending_at(phase.start, before);
            (tick, clock.cycles.saturating_sub(cycle))
        } else {
            self.detected_at = phase.start; // The pulse shows that the sensor works, but its place is not known.
            return Detection::Nothing;
        };
        let late = (commanded.to_bits() >> 16).wrapping_mul(i64::from(traits.delay));
        let at = tick
            .at(cycle.min(clock.cycles), clock)
            .advanced(Turns::from_bits(late.wrapping_neg()));
        let is_where_left = || at.since(self.detected_at).abs() <= traits.tolerance;
        if !self.is_known() && (commanded == 0 || is_where_left()) {
            // A crank that swings or trembles where it was left may meet its flag at either end.
            return Detection::Nothing;
        }
        let begin = traits.index;
        let end = begin.wrapping_add(traits.flag);
        // Going backward, a crank meets the flag's other end first.
        let (first, other) = if commanded < 0 {
            (end, begin)
        } else {
            (begin, end)
        };
        let offset_from = |end: Turns| nearest(Phase::from_turns(end).since(at));
        let offset = offset_from(first);
        // At so low a speed, a crank that has just passed its flag may swing back over the other end.
        let may_swing = commanded.abs() <= traits.slow && at.since(self.detected_at).abs() < HALF;
        if may_swing
            && !self.is_in_place(traits, offset)
            && self.is_in_place(traits, offset_from(other))
        {
            return Detection::Nothing;
        }
        self.judge(traits, offset, at)
    }

    /// True if an offset is that of the last pulse, to within the gate.
    fn is_in_place(&self, traits: &Traits, offset: Turns) -> bool {
        nearest(offset.wrapping_sub(self.offset)).abs() <= traits.gate
    }

    fn judge(&mut self, traits: &Traits, offset: Turns, at: Phase) -> Detection {
        if !self.is_known() {
            self.meant = 1;
            self.believe(traits, offset, at);
            return Detection::First;
        }
        let by = nearest(offset.wrapping_sub(self.offset));
        if by.abs() <= traits.gate {
            if at.since(self.detected_at) < HALF {
                return Detection::Nothing; // the same passage
            }
            self.is_confirmed |= self.outlier.is_none();
            let detection = self.in_place(offset, at);
            let filtered = self.filter(traits, by);
            self.believe(traits, nearest(self.offset.wrapping_add(filtered)), at);
            return detection;
        }
        let again = self.outlier.is_some_and(|outlier| {
            let apart = nearest(offset.wrapping_sub(outlier.offset));
            apart.abs() <= traits.gate && at.since(outlier.at) >= HALF
        });
        // No pulse came in place, and one came elsewhere: the crank has moved to the place of that pulse.
        if self.is_late() || self.missed > 0 || again {
            return self.moved(traits, Outlier { offset, at });
        }
        // The exact place of the next pulse decides what this one was. With an encoder, the noise of two of its readings is added.
        let sure = traits.tolerance.to_bits() << u32::from(traits.has_encoder);
        self.alert = self.alert.min(ONE.wrapping_add(Turns::from_bits(sure)));
        let goes_on = self.spacing.take().is_some_and(|spacing| {
            let late = at.since(self.detected_at).wrapping_sub(spacing.turns).abs();
            // Noise that comes once per turn comes at the same place.
            let is_elsewhere = nearest(by.wrapping_sub(spacing.by)).abs() > traits.gate;
            is_elsewhere && late <= spacing.turns / 4
        });
        match self.outlier.replace(Outlier { offset, at }) {
            Some(extra) => Detection::Extra {
                by: nearest(extra.offset.wrapping_sub(self.offset)),
            },
            None if goes_on => Detection::Running { by },
            None => Detection::Nothing,
        }
    }

    /// Processes a pulse in its place, which showed `offset`.
    fn in_place(&mut self, offset: Turns, at: Phase) -> Detection {
        let outlier = self.outlier.take();
        let extra = outlier.map(|outlier| nearest(outlier.offset.wrapping_sub(offset)));
        let after = outlier.map(|outlier| outlier.at.since(self.detected_at));
        let runs = outlier.filter(|_| after >= Some(BETWEEN.start)).zip(extra);
        self.spacing = runs.map(|(outlier, by)| Spacing {
            turns: at.since(outlier.at),
            by,
        });
        Detection::InPlace {
            was_overdue: self.due == Due::Overdue,
            extra,
            may_be_fast: after.is_some_and(|after| BETWEEN.contains(&after)),
        }
    }

    /// Records that the crank has moved to the place that a pulse showed, or that a guess was noise, and this pulse is the next one.
    fn moved(&mut self, traits: &Traits, to: Outlier) -> Detection {
        let by = nearest(to.offset.wrapping_sub(self.offset));
        let other = self.outlier.filter(|outlier| outlier.at != to.at);
        let from_guess = !self.is_confirmed;
        // A flag whose crank swings, or slips slowly, is about where it was. Noise seldom is.
        let is_near = by.abs() <= traits.swing();
        let was_noise = from_guess && self.outlier.is_some() && !is_near;
        self.is_confirmed |= is_near && other.is_none();
        self.outlier = None;
        self.spacing = None;
        self.meant = 1;
        self.believe(traits, to.offset, to.at);
        if was_noise {
            return Detection::Dismissed {
                by: by.wrapping_neg(),
            };
        }
        Detection::Moved { by, from_guess }
    }

    /// Part of a deviation `by` that counts. It makes the offset the mean of the first pulses, and later a filtered value.
    fn filter(&mut self, traits: &Traits, by: Turns) -> Turns {
        // A deviation beyond noise counts in full, so the offset follows a drift to within a tolerance. Without an encoder, every one does.
        if !traits.has_encoder || by.abs() > traits.tolerance {
            self.meant = 1;
            return by;
        }
        let part = u32::from(self.meant).checked_ilog2().map_or(0, |n| n + 1);
        self.meant = self.meant.saturating_add(1);
        Turns::from_bits(by.to_bits() >> part.min(FILTER_SHIFT))
    }

    /// Processes a timeout: no pulse came up to `alert`.
    #[inline(never)]
    fn time_out(&mut self, traits: &Traits, is_homing: bool) -> Detection {
        let waited = self.due == Due::Overdue;
        if self.is_known() && !self.is_late() {
            if let Some(outlier) = self.outlier {
                return self.moved(traits, outlier);
            }
            self.due = Due::Late;
            self.alert = ONE.wrapping_add(traits.overdue(is_homing));
            return Detection::Undetected;
        }
        self.due = Due::Overdue;
        self.alert = Turns::MAX;
        Detection::Overdue { waited }
    }

    fn believe(&mut self, traits: &Traits, offset: Turns, at: Phase) {
        self.offset = offset;
        self.detected_at = at;
        self.due = Due::Expected;
        self.missed = 0;
        self.alert = ONE.wrapping_add(traits.gate);
    }

    /// Records that the crank may have moved at `phase`. The place of the next pulse decides within a turn from there.
    pub(in crate::drift) fn decide_within_a_turn_of(&mut self, traits: &Traits, phase: Phase) {
        if self.is_known() && !self.is_late() {
            let went = phase.since(self.detected_at).max(Turns::ZERO);
            self.alert = ONE.wrapping_add(went.min(traits.gate));
        }
    }

    /// Records that the crank has moved by `by`, as the encoder shows. Its next pulse is expected at that offset.
    pub(in crate::drift) fn believe_moved(&mut self, traits: &Traits, by: Turns) {
        self.offset = nearest(self.offset.wrapping_add(by));
        self.due = Due::Expected;
        self.alert = ONE
            .wrapping_add(traits.gate)
            .wrapping_sub(by.min(Turns::ZERO));
    }

    /// Extends the time for an overdue pulse, until it is late by `turns`.
    pub(in crate::drift) fn wait(&mut self, turns: Turns) {
        self.alert = ONE.wrapping_add(turns);
    }

    /// Tolerates a missing pulse. The next is expected a turn later.
    pub(in crate::drift) fn pass_over(&mut self, traits: &Traits) {
        self.detected_at = self.detected_at.advanced(ONE);
        self.due = Due::Expected;
        self.missed = self.missed.saturating_add(1);
        self.alert = ONE.wrapping_add(traits.gate);
    }

    /// Records a pulse in a tick whose phase is not known. It shows only that the sensor works.
    pub(in crate::drift) fn disregard(&mut self, phase: Phase) {
        self.detected_at = phase;
    }

    /// Moves the zero of all phases, so that the flag is `by` further on.
    pub(in crate::drift) fn shift(&mut self, by: Turns) {
        self.offset = nearest(self.offset.wrapping_add(by));
    }
}
