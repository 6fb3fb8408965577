//! All that watches one axis: its index sensor, its encoder, and what they tell of its crank together.

use super::encoder_watch::{EncoderWatch, Manner, Read};
use super::index_watch::{Heard, IndexWatch, Place};
use super::naming::Story;
use super::tick_phase::{IndexPulse, TickClock, TickPhase};
use crate::settings::{AxisSettings, turns};
use crate::supervisor::FaultKind;
use crate::units::{FRACTION_BITS, Phase, Turns, nearest};

/// Index pulses that may stay away in a row, where an encoder watches.
const MOST_MISSED: u8 = 2;

/// Extra pulses: each weighs so much, a turn without one takes one off, and so many are no sensor any more.
const EXTRA_WEIGHT: u8 = 4;
const MOST_EXTRA: u8 = 12;

/// Pulses out of place, one after the other: a crank passes its flag more often than it should.
const CROWD: u8 = 2;

/// Index pulses over which what crank and encoder differ by is averaged: 2 to this power.
const CALM: u32 = 4;

/// Turns after which what happened to an axis is no longer why it is where it is.
const FORGOTTEN_AFTER: u8 = 8;

/// What was sorted out of a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sorted {
    /// The index tells where the crank is.
    pub is_heard: bool,
    /// It is elsewhere, by so much, and nothing but the index watches.
    pub has_moved: Option<Turns>,
    /// What there is to tell: its size, and whether the crank is still seen.
    pub told: Option<(FaultKind, Turns, bool)>,
}

/// What cranks are off by as an angle of 2⁻³² turn, which wraps as they do: half a word, and nothing to bring back within the turn.
pub(super) const fn angle(turns: Turns) -> i32 {
    (turns.to_bits() >> ANGLE_CUT) as i32
}

const ANGLE_CUT: u32 = FRACTION_BITS - 32;

fn of_angle(angle: i32) -> Turns {
    Turns::from_bits(i64::from(angle) << ANGLE_CUT)
}

/// Watches one axis.
#[derive(Clone, Debug)]
pub(super) struct AxisWatch {
    index: Option<IndexWatch>,
    encoder: Option<EncoderWatch>,
    heard: Heard,
    read: Read,
    tolerance: Turns,
    /// Further than this angle from where it was, a crank has moved.
    gate: u32,
    /// So far off, this crank alone takes the platform past a limit.
    alone: Turns,
    /// Offset at the last round, and where it was when all was well: angles.
    last: i32,
    home: i32,
    story: Story,
    /// Named in this tick, and not told yet.
    fresh: Option<(FaultKind, Turns)>,
    /// What it was called last, and for how many rounds more that counts.
    name: Option<FaultKind>,
    name_for: u8,
    silent: bool,
    missed: u8,
    extra: u8,
    /// Pulses out of place without one in place between.
    crowd: u8,
}

impl AxisWatch {
    pub(super) fn new(axis: &AxisSettings, tick_hz: u32, reading: Turns, alone: Turns) -> Self {
        let step = turns(1.0 / f64::from(axis.steps_per_turn));
        let tolerance = reading.saturating_add(step).saturating_add(step);
        let cycle = turns(f64::from(axis.cycle_steps) / f64::from(axis.steps_per_turn));
        // Half way to the first cycle that may be lost, less what a reading is off; and no less than two readings differ by.
        let mut gate = Turns::from_bits(tolerance.to_bits() * 4);
        if cycle > 0 {
            let (half, tolerance) = (cycle.to_bits() / 2, tolerance.to_bits());
            // Where steps are so coarse that this is less than what readings differ by, half a cycle is all that can be told.
            let sure = half - tolerance;
            let most = if sure < 2 * tolerance { half } else { sure };
            gate = gate.min(Turns::from_bits(most));
        }
        let whole = if cycle > 0 {
            tolerance.min(Turns::from_bits(cycle.to_bits() / 4))
        } else {
            tolerance
        };
        let place = |index: f64| Place {
            index: turns(index),
            flag: turns(axis.index_width_turns),
            delay: libm::round(axis.index_delay_s * f64::from(tick_hz) * 65_536.0) as u32,
            gate,
            tolerance,
            overdue: alone.max(gate),
            calm: if axis.encoder { CALM } else { 0 },
        };
        let index = axis.index_turns.map(|index| IndexWatch::new(place(index)));
        let jump = Turns::from_bits(tolerance.to_bits() * 4);
        let encoder = axis
            .encoder
            .then(|| EncoderWatch::new(axis.steps_per_turn, axis.reversed, jump));
        Self {
            index,
            encoder,
            heard: Heard::Nothing,
            read: Read::Nothing,
            tolerance,
            gate: angle(gate).unsigned_abs(),
            alone,
            last: 0,
            home: 0,
            story: Story::new(cycle, whole),
            fresh: None,
            name: None,
            name_for: 0,
            silent: false,
            missed: 0,
            extra: 0,
            crowd: 0,
        }
    }

    /// Whether a tick without a pulse is no news: of an axis by index whose next pulse is not due. Nearly all are so.
    #[inline(always)]
    pub(super) fn passes_over(&mut self, commanded: &TickPhase) -> bool {
        match (&self.encoder, &mut self.index) {
            (None, Some(index)) => index.passes_over(commanded),
            _ => false,
        }
    }

    /// Takes in a tick; whether there is news.
    #[inline(never)]
    pub(super) fn observe(
        &mut self,
        pulse: Option<&IndexPulse>,
        count: i32,
        commanded: &TickPhase,
        before_is_known: bool,
        clock: TickClock,
    ) -> bool {
        let Some(encoder) = &mut self.encoder else {
            let Some(index) = &mut self.index else {
                return false;
            };
            let told = commanded.turns;
            self.heard = index.observe(pulse, commanded, told, before_is_known, clock);
            return self.heard != Heard::Nothing;
        };
        // Where the motor is, not where it was told to be.
        let start = commanded.start.advanced(encoder.drift());
        let (read, turns) = encoder.observe(count, commanded);
        self.read = read;
        self.heard = match &mut self.index {
            Some(index) => {
                let measured = TickPhase { start, turns };
                // A motor's noise turns it back for a tick; its flag is met by the way that it is told.
                let told = commanded.turns;
                index.observe(pulse, &measured, told, before_is_known, clock)
            }
            None => Heard::Nothing,
        };
        self.heard != Heard::Nothing || self.read != Read::Nothing
    }

    pub(super) fn disregard(&mut self, pulse: bool, count: i32, start: Phase) {
        let mut start = start;
        if let Some(encoder) = &mut self.encoder {
            encoder.skip(count);
            start = start.advanced(encoder.drift());
        }
        if pulse && let Some(index) = &mut self.index {
            index.disregard(start);
        }
    }

    /// Sorts the news. Where all axes are late together, a pulse may be so by `patience`.
    pub(super) fn sort(&mut self, patience: Option<Turns>) -> Sorted {
        let mut sorted = self.sort_index(patience);
        if let Some(told) = self.sort_encoder(sorted.told.is_some()) {
            sorted.told = Some(told);
        }
        sorted
    }

    fn sort_index(&mut self, patience: Option<Turns>) -> Sorted {
        let Some(index) = &mut self.index else {
            return Sorted::default();
        };
        let mut sorted = Sorted {
            is_heard: true,
            ..Sorted::default()
        };
        match core::mem::replace(&mut self.heard, Heard::Nothing) {
            Heard::Nothing => return Sorted::default(),
            Heard::First => {
                // Whatever moved before, here the crank is; that the encoder jumped is told all the same.
                let doubt = self.encoder.as_mut().map(|encoder| &mut encoder.doubt);
                if let Some(by) = doubt.map(core::mem::take).filter(|doubt| *doubt != 0) {
                    let kind = match self.story.of_one(by) {
                        FaultKind::LostSteps => FaultKind::LostSteps,
                        _ => FaultKind::EncoderGlitch,
                    };
                    sorted.told = Some((kind, by, true));
                }
            }
            Heard::InPlace { extra } => {
                self.missed = 0;
                self.crowd = 0;
                self.extra = self.extra.saturating_sub(1);
                if core::mem::take(&mut self.silent) {
                    sorted.told = Some((FaultKind::IndexMissing, Turns::ZERO, false));
                } else if let Some(by) = extra {
                    sorted.told = Some(self.extra(by));
                } else if let Some(encoder) = &mut self.encoder {
                    let doubt = core::mem::take(&mut encoder.doubt);
                    if doubt != 0 {
                        sorted.told = Some((FaultKind::EncoderGlitch, doubt, true));
                    } else {
                        self.walk_by_encoder();
                    }
                }
            }
            Heard::Extra { by } => {
                sorted.is_heard = false;
                self.crowd = self.crowd.saturating_add(1);
                // One that is ahead already, and comes again before its time, is on its way.
                sorted.told = if self.crowd < CROWD && !self.story.is_ahead() {
                    Some(self.extra(by))
                } else {
                    self.name = Some(FaultKind::Runaway);
                    self.name_for = FORGOTTEN_AFTER;
                    Some((FaultKind::Runaway, by, false))
                };
            }
            Heard::Moved { by } => {
                self.silent = false;
                self.missed = 0;
                if let Some(encoder) = &mut self.encoder {
                    // Only where the encoder saw a jump as well did the motor move; else the crank did on its shaft.
                    let doubt = core::mem::take(&mut encoder.doubt);
                    // (One that passes its flag in the jump shows part of it.)
                    let (by_abs, doubt_abs) =
                        (angle(by).unsigned_abs(), angle(doubt).unsigned_abs());
                    let seen = doubt != 0
                        && (by < 0) == (doubt < 0)
                        && by_abs <= doubt_abs.saturating_add(self.gate);
                    let by = if seen {
                        index.believe_moved(doubt.wrapping_sub(by));
                        doubt
                    } else {
                        by
                    };
                    self.home = self.home.wrapping_add(angle(by));
                    self.named(by, (!seen).then_some(FaultKind::Slip));
                } else {
                    sorted.has_moved = Some(by);
                }
            }
            Heard::Unheard => {
                let doubt = self.encoder.as_mut().map(|encoder| &mut encoder.doubt);
                let Some(doubt) = doubt.map(core::mem::take).filter(|doubt| *doubt != 0) else {
                    return Sorted::default();
                };
                // No flag where the crank would be had the encoder lost counts: it did move.
                index.believe_moved(doubt);
                self.home = self.home.wrapping_add(angle(doubt));
                self.named(doubt, None);
            }
            Heard::Overdue => {
                sorted.is_heard = false;
                match (&self.encoder, patience) {
                    (Some(_), _) if index.is_known() => {
                        index.pass_over();
                        self.missed = self.missed.saturating_add(1);
                        let in_safety = self.missed <= MOST_MISSED;
                        sorted.told = Some((FaultKind::IndexMissing, Turns::ZERO, in_safety));
                    }
                    (_, Some(patience)) if patience > self.alone && !self.silent => {
                        index.wait(patience);
                        self.silent = true;
                    }
                    _ => {
                        self.silent = true;
                        let late = self.alone.wrapping_neg();
                        sorted.told = Some((FaultKind::Silent, late, false));
                    }
                }
            }
        }
        sorted
    }

    fn sort_encoder(&mut self, already: bool) -> Option<(FaultKind, Turns, bool)> {
        let encoder = self.encoder.as_mut()?;
        match core::mem::replace(&mut self.read, Read::Nothing) {
            Read::Glitch { by } if !already => Some((FaultKind::EncoderGlitch, by, true)),
            Read::Jump { .. } if let Some(index) = &mut self.index => {
                index.decide_soon();
                None
            }
            // Nothing else tells where the crank is: it is believed.
            Read::Jump { by } if self.index.is_none() => {
                encoder.believe();
                self.named(by, None);
                None
            }
            _ => None,
        }
    }

    fn extra(&mut self, by: Turns) -> (FaultKind, Turns, bool) {
        self.extra = self.extra.saturating_add(EXTRA_WEIGHT);
        (FaultKind::IndexExtra, by, self.extra <= MOST_EXTRA)
    }

    /// Crank and encoder go apart, turn by turn.
    fn walk_by_encoder(&mut self) {
        let (_, walk) = self.moved();
        if walk.unsigned_abs() > self.gate {
            self.home = angle(self.offset());
            self.named(of_angle(walk), Some(FaultKind::Slip));
        }
    }

    /// Gives what happened a name: that of its story unless it is known.
    fn named(&mut self, by: Turns, kind: Option<FaultKind>) {
        let kind = kind.unwrap_or_else(|| self.story.jumped(by));
        self.fresh = Some((kind, by));
        self.name = Some(kind);
        self.name_for = FORGOTTEN_AFTER;
    }

    /// At the end of a round in which all others jumped by `jump`, and have walked by `walk`, of an axis by index.
    pub(super) fn compare(&mut self, jump: i32, walk: i32) {
        let moved = self.moved();
        let own_jump = moved.0.wrapping_sub(jump);
        let own_walk = moved.1.wrapping_sub(walk);
        self.last = angle(self.offset());
        self.name_for = self.name_for.saturating_sub(1);
        if self.name_for == 0 {
            self.name = None;
        }
        if own_jump.unsigned_abs() > self.gate {
            self.home = self.home.wrapping_add(own_jump);
            self.named(of_angle(own_jump), None);
            return;
        }
        self.story.rest();
        if own_walk.unsigned_abs() > self.gate {
            self.home = self.last.wrapping_sub(walk);
            self.named(of_angle(own_walk), Some(FaultKind::Slip));
        }
    }

    /// How far the crank has gone since the last round, and since all was well.
    pub(super) fn moved(&self) -> (i32, i32) {
        let now = angle(self.offset());
        (now.wrapping_sub(self.last), now.wrapping_sub(self.home))
    }

    pub(super) const fn take_fresh(&mut self) -> Option<(FaultKind, Turns)> {
        self.fresh.take()
    }

    fn offset(&self) -> Turns {
        self.index.as_ref().map_or(Turns::ZERO, IndexWatch::offset)
    }

    /// Measured minus commanded, turns, −½ to ½.
    pub(super) fn drift(&self) -> Turns {
        match &self.encoder {
            Some(encoder) => nearest(self.offset().wrapping_add(encoder.drift())),
            None => self.offset(),
        }
    }

    /// What it is called that this axis is where it is, if that is known.
    pub(super) fn name(&self) -> Option<FaultKind> {
        self.manner().or(self.name)
    }

    /// How its motor moves, if that is why it is off.
    fn manner(&self) -> Option<FaultKind> {
        let encoder = self.encoder.as_ref()?;
        if angle(encoder.drift()).unsigned_abs() <= self.gate {
            return None;
        }
        match encoder.manner() {
            Manner::Follows => None,
            Manner::Stands => Some(FaultKind::Stuck),
            Manner::Backwards => Some(FaultKind::Reversed),
            Manner::Ahead => Some(FaultKind::Runaway),
        }
    }

    /// By its encoder alone, an axis that does not turn as it is told.
    pub(super) fn astray(&self) -> Option<(FaultKind, Turns)> {
        let by = self.encoder.as_ref()?.drift();
        let kind = self.manner().unwrap_or(FaultKind::Tilt);
        (by.wrapping_abs() > self.alone).then_some((kind, by))
    }

    /// So far off, this crank alone takes the platform past a limit.
    pub(super) const fn alone(&self) -> Turns {
        self.alone
    }

    /// The same, whatever all have done since the others were heard.
    pub(super) fn far(&self) -> Turns {
        self.alone.saturating_add(of_angle(self.gate as i32))
    }

    pub(super) const fn tolerance(&self) -> Turns {
        self.tolerance
    }

    /// What it is called that the crank jumped, with what it did before.
    pub(super) fn jumped(&mut self, by: Turns) -> FaultKind {
        self.story.jumped(by)
    }

    /// What a jump is called that nothing is known of but its size.
    pub(super) fn name_of(&self, by: Turns) -> FaultKind {
        self.story.of_one(by)
    }

    /// Its pulse is late, or nothing is expected of it.
    pub(super) fn is_late(&self) -> bool {
        self.encoder.is_none() && self.index.as_ref().is_none_or(IndexWatch::is_unheard)
    }

    #[inline(never)] // once a start, and long
    pub(super) fn reset(&mut self, phase: Phase) {
        if let Some(index) = &mut self.index {
            index.reset(phase);
        }
        if let Some(encoder) = &mut self.encoder {
            encoder.reset();
        }
        self.heard = Heard::Nothing;
        self.read = Read::Nothing;
        self.story.rest();
        self.fresh = None;
        self.name = None;
        self.silent = false;
        self.missed = 0;
        self.extra = 0;
        self.crowd = 0;
    }

    pub(super) fn settle(&mut self) {
        self.last = angle(self.offset());
        self.home = self.last;
        self.fresh = None;
        self.name = None;
    }

    pub(super) fn shift(&mut self, by: Turns) {
        if let Some(index) = &mut self.index {
            index.shift(by);
        }
        self.last = self.last.wrapping_add(angle(by));
        self.home = self.home.wrapping_add(angle(by));
    }

    /// Has no name for a slow walk: for tests of the limits alone.
    #[cfg(test)]
    pub(super) fn never_walks(&mut self) {
        self.gate = u32::MAX;
    }
}
