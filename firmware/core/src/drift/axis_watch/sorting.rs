//! What the news of a tick comes to: index and encoder held against each other.
//!
//! An encoder that jumped is *doubted* until the index tells: a pulse where it was due shows that counts were lost, silence
//! there that the crank moved. An index that is out of place, with an encoder that saw nothing, is a crank that slipped on its shaft.

use super::{AxisWatch, FORGOTTEN_AFTER};
use crate::drift::angles::{angle, of_angle};
use crate::drift::encoder_watch::Read;
use crate::drift::index_watch::Heard;
use crate::supervisor::FaultKind;
use crate::units::Turns;

/// Index pulses that may stay away in a row, where an encoder watches.
const MOST_MISSED: u8 = 2;

/// Extra pulses: each weighs so much, a turn without one takes one off, and so many are no sensor any more.
const EXTRA_WEIGHT: u8 = 4;
const MOST_EXTRA: u8 = 12;

/// Pulses out of place, one after the other: a crank passes its flag more often than it should.
const CROWD: u8 = 2;

/// What there is to tell: what it is, its size, and whether the crank is still seen.
type Tale = (FaultKind, Turns, bool);

/// What was sorted out of a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::drift) struct Sorted {
    /// The index tells where the crank is.
    pub is_heard: bool,
    /// It is elsewhere, by so much.
    pub has_moved: Option<Turns>,
    /// What there is to tell.
    pub told: Option<Tale>,
}

impl Sorted {
    /// The index was heard, and with it there may be something to tell.
    const fn heard(told: Option<Tale>) -> Self {
        Self {
            is_heard: true,
            has_moved: None,
            told,
        }
    }

    /// The index was heard of a crank that is elsewhere, by so much.
    const fn moved(by: Turns) -> Self {
        Self {
            is_heard: true,
            has_moved: Some(by),
            told: None,
        }
    }

    /// Where the crank is was not heard, but there may be something to tell.
    const fn unheard(told: Option<Tale>) -> Self {
        Self {
            is_heard: false,
            has_moved: None,
            told,
        }
    }
}

impl AxisWatch {
    /// Sorts the news. Where all axes are late together, a pulse may be so by `patience`.
    pub(in crate::drift) fn sort(&mut self, patience: Option<Turns>) -> Sorted {
        let mut sorted = match core::mem::replace(&mut self.heard, Heard::Nothing) {
            Heard::Nothing => Sorted::default(),
            Heard::First => Sorted::heard(self.first()),
            Heard::InPlace { extra, may_be_fast } => {
                // Which of the two it is, an encoder knows. (At three times its speed there are two between.)
                let is_sure = !may_be_fast && self.crowd == 0 || self.encoder.is_some();
                Sorted::heard(self.in_place(extra, is_sure))
            }
            Heard::Running { by } if self.encoder.is_none() => {
                Sorted::unheard(Some(self.runs_away(by)))
            }
            Heard::Running { .. } => Sorted::default(),
            Heard::Extra { by } => Sorted::unheard(Some(self.out_of_place(by))),
            Heard::Moved { by } => {
                // It came twice in a turn, and not where it was: a crank that runs, or that moved once, and a stray pulse before.
                let may_run = core::mem::take(&mut self.crowd) > 0 && self.encoder.is_none();
                let told = may_run.then_some((FaultKind::IndexExtra, by, false));
                Sorted {
                    told,
                    ..Sorted::moved(self.elsewhere(by))
                }
            }
            Heard::Unheard => self.nowhere(),
            Heard::Overdue => Sorted::unheard(self.overdue(patience)),
        };
        if let (true, Some(encoder)) = (sorted.is_heard, &self.encoder) {
            self.at_flag = encoder.calm_drift();
        }
        if let Some(told) = self.sort_encoder(sorted.told.is_some()) {
            sorted.told = Some(told);
        }
        sorted
    }

    /// The jump of the encoder that is doubted, if there is one. It is settled with that.
    fn take_doubt(&mut self) -> Option<Turns> {
        let doubt = core::mem::take(&mut self.encoder.as_mut()?.doubt);
        (doubt != 0).then_some(doubt)
    }

    /// The first pulse of all: whatever moved before, here the crank is. That the encoder jumped is told all the same.
    fn first(&mut self) -> Option<Tale> {
        self.home = angle(self.offset());
        let by = self.take_doubt()?;
        let kind = match self.story.of_one(by) {
            FaultKind::LostSteps => FaultKind::LostSteps,
            _ => FaultKind::EncoderGlitch,
        };
        Some((kind, by, true))
    }

    /// A pulse where it was due, and perhaps an extra one before it; unless it is not sure that it was extra.
    fn in_place(&mut self, extra: Option<Turns>, is_sure: bool) -> Option<Tale> {
        self.missed = 0;
        self.crowd = 0;
        self.is_slipping = false;
        self.extra = self.extra.saturating_sub(1);
        if self.encoder.is_some() {
            self.forget(); // the others do at the end of their round
        }
        if core::mem::take(&mut self.silent) {
            return Some((FaultKind::IndexMissing, Turns::ZERO, false));
        }
        if let Some(by) = extra {
            let (kind, by, in_safety) = self.extra(by);
            return Some((kind, by, in_safety && is_sure));
        }
        if let Some(doubt) = self.take_doubt() {
            return Some((FaultKind::EncoderGlitch, doubt, true));
        }
        if self.encoder.is_some() {
            self.walk_by_encoder();
        }
        None
    }

    /// Another pulse out of place. Of a crank that is ahead already, and comes again before its time: it is on its way.
    fn out_of_place(&mut self, by: Turns) -> Tale {
        self.crowd = self.crowd.saturating_add(1);
        if self.crowd < CROWD && !self.story.is_ahead() {
            return self.extra(by);
        }
        self.runs_away(by)
    }

    fn runs_away(&mut self, by: Turns) -> Tale {
        self.name = Some(FaultKind::Runaway);
        self.name_for = FORGOTTEN_AFTER;
        (FaultKind::Runaway, by, false)
    }

    /// The crank is elsewhere, `by` as its index has it; by how much in all.
    fn elsewhere(&mut self, by: Turns) -> Turns {
        self.silent = false;
        self.missed = 0;
        if self.encoder.is_none() {
            return by; // named when the round is over
        }
        let doubt = self.take_doubt().unwrap_or_default();
        // Only where the encoder saw a jump as well did the motor move; else the crank did on its shaft. (One that passes its flag
        // in the jump shows part of it.)
        let (shown, jumped) = (angle(by).unsigned_abs(), angle(doubt).unsigned_abs());
        let same_sense = doubt != 0 && (by < 0) == (doubt < 0);
        let (by, kind) = if same_sense && shown <= jumped.saturating_add(self.gate) {
            self.believe_moved(doubt.wrapping_sub(by));
            (doubt, None)
        } else {
            (by, Some(FaultKind::Slip))
        };
        self.home = self.home.wrapping_add(angle(by));
        self.named(by, kind);
        by
    }

    /// Nothing came where the crank would be had the encoder lost counts: if it jumped, the crank did.
    fn nowhere(&mut self) -> Sorted {
        let Some(doubt) = self.take_doubt() else {
            return Sorted::default();
        };
        self.believe_moved(doubt);
        self.home = self.home.wrapping_add(angle(doubt));
        self.named(doubt, None);
        Sorted::moved(doubt)
    }

    /// No pulse for so long that the crank may be past its limit.
    fn overdue(&mut self, patience: Option<Turns>) -> Option<Tale> {
        let index = self.index.as_mut()?;
        if self.encoder.is_some() && index.is_known() {
            index.pass_over();
            self.missed = self.missed.saturating_add(1);
            if self.is_slipping && index.is_settled() {
                // Nor does an encoder vouch for a crank that slipped on its shaft in the turn before.
                return Some((FaultKind::Slip, self.alone.wrapping_neg(), false));
            }
            let in_safety = self.missed <= MOST_MISSED;
            return Some((FaultKind::IndexMissing, Turns::ZERO, in_safety));
        }
        let was_silent = core::mem::replace(&mut self.silent, true);
        if let Some(patience) = patience.filter(|&most| most > self.alone && !was_silent) {
            index.wait(patience);
            return None;
        }
        Some((FaultKind::Silent, self.alone.wrapping_neg(), false))
    }

    fn believe_moved(&mut self, by: Turns) {
        if let Some(index) = &mut self.index {
            index.believe_moved(by);
        }
    }

    fn sort_encoder(&mut self, already: bool) -> Option<Tale> {
        let encoder = self.encoder.as_mut()?;
        match core::mem::replace(&mut self.read, Read::Nothing) {
            Read::Glitch { by } if !already => Some((FaultKind::EncoderGlitch, by, true)),
            Read::Jump { .. } if let Some(index) = &mut self.index => {
                index.decide_within_a_turn_of(self.jumped_at);
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

    fn extra(&mut self, by: Turns) -> Tale {
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
}
