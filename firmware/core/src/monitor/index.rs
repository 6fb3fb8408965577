//! Index sensor of one axis: what its pulses, and pulses that stay away, show of the crank.
//!
//! The crank passed its flag last at one place. That is the first hypothesis of where the crank is: its *place*. A pulse that contradicts
//! it is the second one, the *rival*: it is noise, or the crank has moved. What comes next decides between the two:
//!
//! - A pulse within a gate of the place supports the place, so that the rival was an extra pulse.
//! - The place passes without a pulse: an extra pulse would not keep the flag's own pulse away. So the crank is where the rival showed it.
//! - The rival repeats half a turn later or more: the same.
//! - A pulse comes elsewhere again: the rival before it was an extra pulse, or the crank runs away, which names distinguish.
//!
//! The first pulse of all may be noise, too. So it is a *guess*, until two pulses a turn apart confirm it, in the same place or as near as a
//! rotor swings, without a rival between them. If a guess passes without a pulse near it, and a rival came meanwhile, the guess was noise,
//! or the crank gains. The rival is the flag's pulse in either case, unless another one came in that turn. Without a rival the flag has made
//! the pulse, and the crank has moved.
//!
//! The *place* is the angle of the flag minus the phase of the axis at a pulse. Without an encoder that is the commanded phase, and the
//! place is the phase error. With an encoder it is the measured phase, and the place is the difference of crank and encoder.

use super::angles::{Angle, angle, exceeds};
use super::config::AxisConfig;
use super::evaluate::Tick;
use crate::commanded::TickPhase;
use crate::units::{ONE_TURN, Phase, Turns, nearest};

const ONE: Turns = Turns::from_bits(ONE_TURN);
const HALF: Turns = Turns::from_bits(ONE_TURN / 2);
const ONE_AND_HALF: Turns = Turns::from_bits(ONE_TURN + ONE_TURN / 2);

/// Largest delay that an estimate contains. A pulse that is this late shows that its crank or its sensor has failed, whatever the limits
/// are.
pub(super) const MAX_LATE: Turns = Turns::from_bits(ONE_TURN / 4);

/// Binary logarithm of the number of index pulses over which the difference of crank and encoder is averaged.
const FILTER_SHIFT: u32 = 4;

/// Result of a pulse, or of its absence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Passage {
    /// Nothing new.
    Nothing,
    /// The first pulse since the start of the search.
    First,
    /// A pulse in its place.
    InPlace {
        /// The rival before it, which was an extra pulse: its distance from the place.
        extra: Option<Angle>,
        /// True if the pulse before it stayed away.
        was_missing: bool,
    },
    /// A pulse elsewhere, off by this, which is the rival now.
    Elsewhere { by: Angle },
    /// The same, and the rival before it was an extra pulse, off by this.
    Extra { by: Angle },
    /// No pulse came in the place of the first one, and one came elsewhere: the first was an extra pulse, off by this.
    Dismissed { by: Angle },
    /// The crank has moved.
    Moved {
        by: Angle,
        /// True if the place before was no more than a guess.
        from_guess: bool,
    },
    /// With an encoder: no pulse came where it would be if the encoder had lost counts.
    NotWhereCountsWereLost,
    /// With an encoder: a pulse is missing. The next is expected a turn later.
    Missing,
}

/// A pulse: the place that it shows, and the phase at which it came.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pulse {
    place: Angle,
    pub(super) at: Phase,
}

/// Watches one sensor.
#[derive(Clone, Debug)]
pub(super) struct Index {
    /// Place that the last passage showed.
    pub(super) place: Angle,
    /// Number of pulses of which the place is the mean, with an encoder; 0 before the first.
    averaged_pulses: u8,
    is_confirmed: bool,
    /// Missing pulses in a row, with an encoder.
    pub(super) missed: u8,
    /// Phase at that passage; before the first, the phase at which the search began.
    at: Phase,
    /// A pulse that contradicts the place.
    rival: Option<Pulse>,
}

impl Index {
    /// Watch that has no pulse yet. The first is due within a turn from `phase`. A pulse within a tolerance of `phase` does not count.
    pub(super) const fn new(phase: Phase) -> Self {
        Self {
            place: Angle::ZERO,
            averaged_pulses: 0,
            is_confirmed: false,
            missed: 0,
            at: phase,
            rival: None,
        }
    }

    pub(super) const fn is_known(&self) -> bool {
        self.averaged_pulses > 0
    }

    /// True if a turn has confirmed where the first pulses were.
    pub(super) const fn is_confirmed(&self) -> bool {
        self.is_confirmed
    }

    /// Records that a turn has confirmed the place.
    pub(super) const fn confirm(&mut self) {
        self.is_confirmed = true;
    }

    /// True if a crank at this phase, at the place that the last pulse showed, may swing over an end of its flag, which begins at `index`.
    pub(super) fn is_at_flag(&self, config: &AxisConfig, index: Turns, phase: Phase) -> bool {
        let crank = angle(phase.since(Phase::ZERO)) + self.place;
        let is_near = |end: Turns| !exceeds(angle(end) - crank, config.swing());
        self.is_known() && (is_near(index) || is_near(index.wrapping_add(config.flag)))
    }

    /// Turns by which the next passage is later than a turn after the last one; negative if it is not due.
    pub(super) const fn late(&self, now: Phase) -> Turns {
        now.since(self.at).wrapping_sub(ONE)
    }

    /// Measures a pulse from the tick over which the axis has the phase `over`, or from the tick before it, in which it made `before` turns,
    /// if known. The delay of the line is converted by the `commanded` turns, as measured turns would multiply the noise of an encoder.
    /// Returns nothing if the pulse may be that of a swing, or its place is not known.
    #[inline(never)] // A loop over all axes needs the registers.
    pub(super) fn measure(
        &mut self,
        config: &AxisConfig,
        tick: &Tick<'_>,
        cycle: i32,
        over: &TickPhase,
        before: Option<Turns>,
        commanded: Turns,
    ) -> Option<Pulse> {
        let clock = tick.clock;
        let index = config.index.wrapping_add(tick.zero);
        let within = cycle.unsigned_abs();
        let mut at = if cycle >= 0 {
            over.at(within.min(clock.cycles), clock)
        } else if let Some(before) = before {
            let before = TickPhase::ending_at(over.start, before);
            before.at(clock.cycles.saturating_sub(within), clock)
        } else {
            self.at = over.start; // The pulse shows that the sensor works, but its place is not known.
            return None;
        };
        if config.delay != 0 {
            let late = (commanded.to_bits() >> 16).wrapping_mul(i64::from(config.delay));
            at = at.advanced(Turns::from_bits(late.wrapping_neg()));
        }
        let since = at.since(self.at);
        if !self.is_known() && (commanded == 0 || since.abs() <= config.tolerance) {
            // A crank that swings or trembles where it was left may meet its flag at either end.
            return None;
        }
        // Going backward, a crank meets the flag's other end first.
        let (mut first, mut other) = (index, index.wrapping_add(config.flag));
        if commanded < 0 {
            core::mem::swap(&mut first, &mut other);
        }
        let phase = angle(at.since(Phase::ZERO));
        let place = angle(first) - phase;
        // At so low a speed, a crank that has just passed its flag may swing back over the other end.
        let may_swing = commanded.abs() <= config.slow && since.abs() < HALF;
        let is_in_place = |place: Angle| !config.is_beyond_gate(place - self.place);
        let swings = may_swing && !is_in_place(place) && is_in_place(angle(other) - phase);
        (!swings).then_some(Pulse { place, at })
    }

    /// True if a pulse contradicts the place.
    pub(super) fn contradicts(&self, config: &AxisConfig, pulse: &Pulse) -> bool {
        self.is_known() && config.is_beyond_gate(pulse.place - self.place)
    }

    /// Decides between the place and its rival by a pulse.
    #[inline(never)] // as above
    pub(super) fn decide(&mut self, config: &AxisConfig, pulse: Pulse) -> Passage {
        let Pulse { place, at } = pulse;
        if !self.is_known() {
            self.averaged_pulses = 1;
            self.accept(place, at);
            return Passage::First;
        }
        let by = place - self.place;
        let since = at.since(self.at);
        if !config.is_beyond_gate(by) {
            if since < HALF {
                return Passage::Nothing; // the same passage
            }
            self.is_confirmed |= self.rival.is_none();
            let extra = self.rival.map(|rival| rival.place - place);
            let filtered = self.filter(config, by);
            self.accept(self.place + filtered, at);
            let was_missing = since > ONE_AND_HALF;
            return Passage::InPlace { extra, was_missing };
        }
        let has_passed = self.missed > 0 || since.wrapping_sub(ONE) > config.gate;
        let repeats = |before: Pulse| {
            !config.is_beyond_gate(place - before.place) && at.since(before.at) >= HALF
        };
        if has_passed || self.rival.is_some_and(repeats) {
            return self.moved(config, pulse);
        }
        match self.rival.replace(pulse) {
            Some(extra) => Passage::Extra {
                by: extra.place - self.place,
            },
            None => Passage::Elsewhere { by },
        }
    }

    /// Processes that no pulse came up to the phase `now`. If the encoder jumped at `jumped`, the place decides within a turn from there.
    #[inline(never)] // It is rare, and a loop over all axes needs the registers.
    pub(super) fn pass(
        &mut self,
        config: &AxisConfig,
        now: Phase,
        jumped: Option<Phase>,
    ) -> Passage {
        let late = self.late(now);
        // With an encoder, the noise of two of its readings is added.
        let sure = Turns::from_bits(config.tolerance.to_bits() << u32::from(config.has_encoder));
        let went = jumped.map(|at| at.since(self.at).clamp(Turns::ZERO, config.gate));
        if !self.is_known() || late <= went.unwrap_or(sure).min(sure) {
            return Passage::Nothing;
        }
        if let Some(rival) = self.rival {
            return self.moved(config, rival);
        }
        if went.is_some_and(|went| late > went) {
            return Passage::NotWhereCountsWereLost;
        }
        if !config.has_encoder || late <= config.overdue() {
            return Passage::Nothing;
        }
        self.at = self.at.advanced(ONE);
        self.missed = self.missed.saturating_add(1);
        Passage::Missing
    }

    /// Records that the crank has moved to the place of a pulse, or that a guess was noise, and this pulse is the next one.
    fn moved(&mut self, config: &AxisConfig, to: Pulse) -> Passage {
        let by = to.place - self.place;
        let other = self.rival.filter(|rival| rival.at != to.at);
        let from_guess = !self.is_confirmed;
        // A flag whose crank swings, or slips slowly, is about where it was. Noise seldom is.
        let is_near = !exceeds(by, config.swing());
        let was_noise = from_guess && self.rival.is_some() && !is_near;
        self.is_confirmed |= is_near && other.is_none();
        self.averaged_pulses = 1;
        self.accept(to.place, to.at);
        if was_noise {
            return Passage::Dismissed { by: -by };
        }
        Passage::Moved { by, from_guess }
    }

    /// Part of a deviation `by` that counts. It makes the place the mean of the first pulses, and later a filtered value.
    fn filter(&mut self, config: &AxisConfig, by: Angle) -> Angle {
        // A deviation beyond noise counts in full, so the place follows a drift to within a tolerance. Without an encoder, every one does.
        if !config.has_encoder || exceeds(by, config.tolerance) {
            self.averaged_pulses = 1;
            return by;
        }
        let part = u32::from(self.averaged_pulses)
            .checked_ilog2()
            .map_or(0, |n| n + 1);
        self.averaged_pulses = self.averaged_pulses.saturating_add(1);
        by >> part.min(FILTER_SHIFT)
    }

    const fn accept(&mut self, place: Angle, at: Phase) {
        self.place = place;
        self.at = at;
        self.rival = None;
        self.missed = 0;
    }

    /// Records that the crank has moved by `by`, as the encoder shows. Its next pulse is expected at that place. A crank that jumped ahead
    /// over its flag passes it a turn later.
    pub(super) fn move_place(&mut self, by: Turns, has_passed: bool) {
        self.place += angle(by);
        if has_passed {
            let by = nearest(by);
            let next = if by > 0 {
                ONE.wrapping_sub(by)
            } else {
                by.wrapping_neg()
            };
            self.at = self.at.advanced(next);
        }
    }

    /// Records a pulse in a tick whose phase is not known. It shows only that the sensor works.
    pub(super) const fn disregard(&mut self, phase: Phase) {
        self.at = phase;
    }

    /// Moves the zero of all phases, so that the flag is `by` further on.
    pub(super) fn shift(&mut self, by: Angle) {
        self.place += by;
        if let Some(rival) = &mut self.rival {
            rival.place += by;
        }
    }
}
