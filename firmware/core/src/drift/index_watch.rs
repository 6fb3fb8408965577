//! One axis's index sensor: which of its pulses are to be believed, and when one stays away.
//!
//! A pulse is *in place* if it shows about the same offset as the one before. Any other is a *suspect*: noise, or a crank that
//! has moved. Which of the two, the place tells where the next pulse was expected: a pulse there clears the suspect as an extra
//! one; silence there, or the same again a turn later, shows that the crank has moved. So an extra pulse never counts as
//! drift, and a crank that has moved is known to have within a turn and the width of a place.
//!
//! The *offset* that a pulse shows is the sensor's place minus the axis's phase at that moment: of an axis without an encoder
//! its commanded phase, so that the offset is its drift; of one with an encoder the measured, so that it is what crank and
//! encoder differ by.

use super::tick_phase::{IndexPulse, TickClock, TickPhase};
use crate::units::{ONE_TURN, Phase, Turns, nearest};

const ONE: Turns = Turns::from_bits(ONE_TURN);
const HALF: Turns = Turns::from_bits(ONE_TURN / 2);

/// A pulse that is missing in its place, and comes no later than this, is of a crank that fell back: noise comes anywhere.
const LATE: Turns = Turns::from_bits(-ONE_TURN / 8);

/// A crank that runs over twice as fast as it is told may pass its flag between, and once more in its place. It is between so far from
/// the pulse before, turns, at least; up to the other it is past a limit so early that what comes after that place tells too late.
/// Exactly it were ½ and 0.618, p² + p = 1, with p the place between; a master that speeds up meanwhile has it a little wider.
const BETWEEN: core::ops::Range<Turns> = Turns::lit("0.48")..Turns::lit("0.66");

/// Where a sensor stands, and what it may be off by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Phase at which its flag begins, going forward.
    pub index: Turns,
    /// The flag's length.
    pub flag: Turns,
    /// Ticks by which its line is late, 16 fraction bits.
    pub delay: u32,
    /// Of a tick that is over, the part in which no flag can have come that is not told of yet, 16 fraction bits: the line is late,
    /// and its filter waits. Below zero where that takes longer than a tick.
    pub told_of: i32,
    /// A pulse further than this from the last is out of place.
    pub gate: Turns,
    /// What two pulses of a crank that is where it was may be apart.
    pub tolerance: Turns,
    /// A pulse that is late by more does not come where it was.
    pub sure: Turns,
    /// A pulse that is late by more stands for a crank past its limit: while cranks are found out, and from then on.
    pub overdue: Turns,
    pub overdue_settled: Turns,
    /// Of what a pulse in place shows anew, 1/2^`calm` is believed: where an encoder has the crank anyway, the index need not
    /// bring its own noise in.
    pub calm: u32,
}

/// What a tick brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Heard {
    /// Nothing new.
    Nothing,
    /// The first pulse of all.
    First,
    /// A pulse in its place; and a suspect before it was none.
    InPlace {
        /// By how much that was off.
        extra: Option<Turns>,
        /// But the crank may have passed its flag in both places, being that fast.
        may_be_fast: bool,
    },
    /// After a suspect and a pulse in its place, another as far from that as that was from the suspect: the crank runs.
    Running {
        /// By how much it is off.
        by: Turns,
    },
    /// A suspect was none, and here is another.
    Extra {
        /// By how much the first was off.
        by: Turns,
    },
    /// The crank is elsewhere.
    Moved {
        /// By how much, forward.
        by: Turns,
    },
    /// Nothing came where the next pulse was expected.
    Unheard,
    /// A pulse stays away: told once, until one comes.
    Overdue,
}

/// A pulse out of place.
#[derive(Clone, Copy, Debug)]
struct Suspect {
    offset: Turns,
    at: Phase,
}

/// An extra pulse and one in its place: how far that came after it, and by how much the first was off.
#[derive(Clone, Copy, Debug)]
struct Beat {
    turns: Turns,
    by: Turns,
}

/// Watches one sensor.
#[derive(Clone, Debug)]
pub(super) struct IndexWatch {
    place: Place,
    /// The cranks are where they should be.
    is_settled: bool,
    /// What the last believed pulse showed.
    offset: Turns,
    known: bool,
    /// Pulses that this is the mean of, up to what `calm` asks for.
    meant: u8,
    /// Phase at that pulse; before the first, where the search began.
    heard_at: Phase,
    suspect: Option<Suspect>,
    beat: Option<Beat>,
    /// Nothing came where the next pulse was expected.
    unheard: bool,
    /// Nor where the last was, which was done without.
    missing: bool,
    /// Turns since then at which there is something to say.
    alert: Turns,
}

impl IndexWatch {
    pub(super) fn new(place: Place) -> Self {
        Self {
            place,
            is_settled: false,
            offset: Turns::ZERO,
            known: false,
            meant: 0,
            heard_at: Phase::ZERO,
            suspect: None,
            beat: None,
            unheard: false,
            missing: false,
            alert: Turns::ZERO,
        }
    }

    /// Forgets what was heard; the first pulse is expected within a turn and what may be overdue from `phase` on.
    pub(super) fn reset(&mut self, phase: Phase) {
        self.is_settled = false;
        self.offset = Turns::ZERO;
        self.known = false;
        self.suspect = None;
        self.beat = None;
        self.unheard = false;
        self.missing = false;
        self.heard_at = phase;
        self.alert = ONE.wrapping_add(self.place.overdue);
    }

    /// The cranks are where they should be.
    pub(super) const fn settle(&mut self) {
        self.is_settled = true;
    }

    pub(super) const fn is_settled(&self) -> bool {
        self.is_settled
    }

    const fn overdue(&self) -> Turns {
        if self.is_settled {
            self.place.overdue_settled
        } else {
            self.place.overdue
        }
    }

    pub(super) const fn offset(&self) -> Turns {
        self.offset
    }

    pub(super) const fn is_known(&self) -> bool {
        self.known
    }

    /// Whether the expected pulse has not come.
    pub(super) const fn is_unheard(&self) -> bool {
        self.unheard
    }

    /// How much further an axis may go, from the end of a tick on, before there is something to say of it if no pulse comes. The end
    /// is further than what is sure of the tick.
    pub(super) const fn margin(&self, phase: &TickPhase) -> Turns {
        let end = phase.start.advanced(phase.turns);
        self.alert.saturating_sub(end.since(self.heard_at))
    }

    /// Whether it is sure that no flag came where there would be something to say of it.
    fn is_silent(&self, phase: &TickPhase, commanded: Turns) -> bool {
        let sure = (commanded.to_bits() >> 16).wrapping_mul(i64::from(self.place.told_of));
        let since = phase.start.since(self.heard_at);
        since.wrapping_add(Turns::from_bits(sure)) > self.alert
    }

    /// Takes in a tick without a pulse, in which the axis was told to make `commanded` turns: a motor's noise would be
    /// multiplied by the line's delay.
    pub(super) fn look(&mut self, phase: &TickPhase, commanded: Turns) -> Heard {
        if !self.is_silent(phase, commanded) {
            return Heard::Nothing;
        }
        match self.silence() {
            // In the same tick it may be so late that it is overdue; where nothing else watches, that is what matters.
            Heard::Unheard if self.place.calm == 0 && self.is_silent(phase, commanded) => {
                self.silence()
            }
            heard => heard,
        }
    }

    /// Takes in a pulse that came in the tick over which the axis had that phase, or in the one before, in which it made `before`
    /// turns, if that is known.
    #[inline(never)] // seldom, and what it needs of registers a loop over all axes would lack
    pub(super) fn hear(
        &mut self,
        pulse: IndexPulse,
        phase: &TickPhase,
        commanded: Turns,
        before: Option<Turns>,
        clock: TickClock,
    ) -> Heard {
        if commanded == 0 && !self.known {
            // A crank that swings where it was left may meet its flag at either end.
            return Heard::Nothing;
        }
        let back = pulse.cycle.min(0).unsigned_abs();
        let tick = if back == 0 {
            *phase
        } else if let Some(before) = before {
            TickPhase {
                start: phase.start.advanced(before.wrapping_neg()),
                turns: before,
            }
        } else {
            self.heard_at = phase.start; // it is alive, and more is not known
            return Heard::Nothing;
        };
        let cycle = if back == 0 {
            pulse.cycle.unsigned_abs()
        } else {
            clock.cycles.saturating_sub(back)
        };
        let late = (commanded.to_bits() >> 16).wrapping_mul(i64::from(self.place.delay));
        let at = tick
            .at(cycle.min(clock.cycles), clock)
            .advanced(Turns::from_bits(late.wrapping_neg()));
        // Going backward, a crank meets the flag's other end first.
        let end = if commanded < 0 {
            self.place.index.wrapping_add(self.place.flag)
        } else {
            self.place.index
        };
        self.judge(nearest(Phase::from_turns(end).since(at)), at)
    }

    fn judge(&mut self, offset: Turns, at: Phase) -> Heard {
        if !self.known {
            self.known = true;
            self.meant = 1;
            self.believe(offset, at);
            return Heard::First;
        }
        let by = nearest(offset.wrapping_sub(self.offset));
        if by.abs() <= self.place.gate {
            if at.since(self.heard_at) < HALF {
                return Heard::Nothing; // the same passage
            }
            let before = self.heard_at;
            let calm = self.calmed(by);
            self.believe(nearest(self.offset.wrapping_add(calm)), at);
            return self.in_place(offset, at, before);
        }
        let again = self.suspect.is_some_and(|suspect| {
            let apart = nearest(offset.wrapping_sub(suspect.offset));
            apart.abs() <= self.place.gate && at.since(suspect.at) >= HALF
        });
        // None where the flag was, and one behind that: the flag is there now.
        let is_behind = self.missing && (LATE..Turns::ZERO).contains(&by);
        if self.unheard || is_behind || again {
            self.suspect = None;
            self.beat = None;
            self.meant = 1;
            self.believe(offset, at);
            return Heard::Moved { by };
        }
        self.decide_soon();
        let goes_on = self.beat.take().is_some_and(|beat| {
            let late = at.since(self.heard_at).wrapping_sub(beat.turns).abs();
            // Noise that comes once a turn does so at the same place.
            let is_elsewhere = nearest(by.wrapping_sub(beat.by)).abs() > self.place.gate;
            is_elsewhere && late <= beat.turns / 4
        });
        match self.suspect.replace(Suspect { offset, at }) {
            Some(extra) => Heard::Extra {
                by: nearest(extra.offset.wrapping_sub(self.offset)),
            },
            None if goes_on => Heard::Running { by },
            None => Heard::Nothing,
        }
    }

    /// A pulse in its place, which showed `offset`; the one before came at `before`.
    fn in_place(&mut self, offset: Turns, at: Phase, before: Phase) -> Heard {
        let Some(suspect) = self.suspect.take() else {
            self.beat = None;
            return Heard::InPlace {
                extra: None,
                may_be_fast: false,
            };
        };
        let by = nearest(suspect.offset.wrapping_sub(offset));
        let after = suspect.at.since(before);
        self.beat = (after >= BETWEEN.start).then_some(Beat {
            turns: at.since(suspect.at),
            by,
        });
        Heard::InPlace {
            extra: Some(by),
            may_be_fast: BETWEEN.contains(&after),
        }
    }

    /// What is believed of a pulse that shows `by` more than is known: of the first few their mean, then the part that `calm` is.
    fn calmed(&mut self, by: Turns) -> Turns {
        // What is more than noise is believed whole, so that a walk is never behind by more.
        if by.abs() > self.place.tolerance {
            self.meant = 1;
            return by;
        }
        let part = u32::from(self.meant).checked_ilog2().map_or(0, |n| n + 1);
        self.meant = self.meant.saturating_add(1);
        Turns::from_bits(by.to_bits() >> part.min(self.place.calm))
    }

    /// Nothing has come for so long that there is something to say.
    #[inline(never)]
    fn silence(&mut self) -> Heard {
        if self.known && !self.unheard {
            if let Some(suspect) = self.suspect.take() {
                let by = nearest(suspect.offset.wrapping_sub(self.offset));
                self.beat = None;
                self.meant = 1;
                self.believe(suspect.offset, suspect.at);
                return Heard::Moved { by };
            }
            self.unheard = true;
            self.alert = ONE.wrapping_add(self.overdue().max(self.place.gate));
            return Heard::Unheard;
        }
        self.unheard = true;
        self.alert = Turns::MAX;
        Heard::Overdue
    }

    fn believe(&mut self, offset: Turns, at: Phase) {
        self.offset = offset;
        self.heard_at = at;
        self.unheard = false;
        self.missing = false;
        self.alert = ONE.wrapping_add(self.place.gate);
    }

    /// A pulse came out of place: silence at the very place of the next decides.
    fn decide_soon(&mut self) {
        if !self.unheard {
            self.alert = self.alert.min(ONE.wrapping_add(self.place.sure));
        }
    }

    /// The crank may have moved at `phase`: silence at the place of the next pulse decides, and within a turn from then.
    pub(super) fn decide_within_a_turn_of(&mut self, phase: Phase) {
        if self.known && !self.unheard {
            let went = phase.since(self.heard_at).max(Turns::ZERO);
            self.alert = ONE.wrapping_add(went.min(self.place.gate));
        }
    }

    /// The crank has moved by so much, as something else tells: its pulse is to come where that has it.
    pub(super) fn believe_moved(&mut self, by: Turns) {
        self.offset = nearest(self.offset.wrapping_add(by));
        self.unheard = false;
        self.alert = ONE
            .wrapping_add(self.place.gate)
            .wrapping_sub(by.min(Turns::ZERO));
    }

    /// An overdue pulse is waited for until it is late by `turns`.
    pub(super) fn wait(&mut self, turns: Turns) {
        self.alert = ONE.wrapping_add(turns);
    }

    /// An overdue pulse is done without: the next is expected a turn later.
    pub(super) fn pass_over(&mut self) {
        self.heard_at = self.heard_at.advanced(ONE);
        self.unheard = false;
        self.missing = true;
        self.alert = ONE.wrapping_add(self.place.gate);
    }

    /// A pulse came in a tick of which nothing is known: the sensor is alive.
    pub(super) fn disregard(&mut self, phase: Phase) {
        self.heard_at = phase;
    }

    /// All phases are counted from elsewhere from now on: the sensor is found `by` further on.
    pub(super) fn shift(&mut self, by: Turns) {
        self.place.index = self.place.index.wrapping_add(by);
        self.offset = nearest(self.offset.wrapping_add(by));
    }
}
