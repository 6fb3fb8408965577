//! Comparison of the index and the encoder of one axis.
//!
//! A jump of the encoder is *unconfirmed* until the index decides. A pulse in its place shows that counts were lost. No pulse there shows
//! that the crank moved. If the index is out of place and the encoder has measured nothing, the crank slipped on its shaft.

use super::AxisWatch;
use crate::drift::detection::angles::angle;
use crate::drift::sensing::encoder_watch::Read;
use crate::drift::sensing::index_watch::Detection;
use crate::supervisor::FaultKind;
use crate::units::Turns;

/// Missing index pulses in a row that are tolerated on an axis with an encoder.
const MOST_MISSED: u8 = 2;

/// Fault that is to be reported: its kind, its size, and whether the crank is still detected.
pub(in crate::drift) type Report = (FaultKind, Turns, bool);

/// Result for one axis and one tick.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::drift) struct Sorted {
    /// The index shows where the crank is.
    pub is_detected: bool,
    /// Distance by which the crank moved, as the index shows.
    pub has_moved: Option<Turns>,
    /// Fault that is to be reported.
    pub reported: Option<Report>,
}

impl AxisWatch {
    /// Evaluates what index and encoder detected in a tick. If all axes are late together, a pulse may be late by `patience`.
    pub(in crate::drift) fn sort(
        &mut self,
        detection: Detection,
        read: Read,
        patience: Option<Turns>,
        is_homing: bool,
    ) -> Sorted {
        let mut has_moved = None;
        let reported = match detection {
            Detection::Nothing => None,
            Detection::First => self.first(),
            Detection::InPlace {
                was_overdue,
                extra,
                may_be_fast,
            } => {
                // An encoder shows whether the crank runs fast. At three times the commanded speed, two extra pulses come per turn.
                let is_sure = !may_be_fast && !self.diagnosis.had_extra() || self.encoder.is_some();
                self.in_place(was_overdue, extra, is_sure)
            }
            Detection::Running { by } => self.encoder.is_none().then(|| self.runs_away(by)),
            // Before the place is confirmed, pulses at several places may be noise. An encoder shows whether the crank runs.
            Detection::Extra { by } if !self.index.is_confirmed() => {
                let is_sure = !self.diagnosis.had_extra() || self.encoder.is_some();
                Some(self.extra(by, is_sure))
            }
            Detection::Extra { by } => Some(self.out_of_place(by)),
            // Noise would have to come twice, each time ahead of the last guess. So the crank gains, as one does that slips.
            Detection::Dismissed { by } if self.diagnosis.had_extra() => {
                has_moved = Some(self.elsewhere(by.wrapping_neg()));
                None
            }
            Detection::Dismissed { by } => {
                self.diagnosis.pass_turn();
                self.home = angle(self.index.offset);
                Some(self.extra(by, true))
            }
            Detection::Moved { by, from_guess } => {
                // Two pulses in a turn, neither in its place: the crank runs away, or it moved after an extra pulse. Before the place is
                // confirmed, the first pulse may have been noise, and the next turns decide.
                let is_alone = self.encoder.is_none() && !from_guess;
                let may_run = is_alone && self.diagnosis.had_extra();
                has_moved = Some(self.elsewhere(by));
                may_run.then_some((FaultKind::IndexExtra, by, false))
            }
            Detection::Undetected => self.nowhere(&mut has_moved),
            Detection::Overdue { waited } => self.overdue(patience.filter(|_| !waited), is_homing),
        };
        let is_place = matches!(
            detection,
            Detection::First | Detection::InPlace { .. } | Detection::Dismissed { .. }
        );
        let is_detected = is_place || has_moved.is_some();
        if is_detected && let Some(encoder) = &mut self.encoder {
            encoder.at_flag = encoder.filtered;
        }
        Sorted {
            is_detected,
            has_moved,
            reported: reported.or_else(|| self.sort_encoder(read)),
        }
    }

    /// Takes the unconfirmed jump of the encoder, if there is one.
    fn take_unconfirmed_jump(&mut self) -> Option<Turns> {
        self.encoder.as_mut()?.unconfirmed_jump.take()
    }

    /// Processes the first pulse of all, which shows where the crank is. Reports a jump that the encoder made before it.
    fn first(&mut self) -> Option<Report> {
        self.home = angle(self.index.offset);
        let by = self.take_unconfirmed_jump()?;
        let kind = match self.traits.name_of_one(by) {
            FaultKind::LostSteps => FaultKind::LostSteps,
            _ => FaultKind::EncoderGlitch,
        };
        Some((kind, by, true))
    }

    /// Processes a pulse in its place, and perhaps an extra one before it. Unless `is_sure` is true, an extra pulse stops the machine.
    fn in_place(
        &mut self,
        was_overdue: bool,
        extra: Option<Turns>,
        is_sure: bool,
    ) -> Option<Report> {
        let extra = extra.map(|by| self.extra(by, is_sure));
        self.diagnosis.pass_turn();
        if self.encoder.is_some() {
            // The crank may move away from its encoder, turn by turn.
            self.walk(self.motion().walk);
        }
        if was_overdue {
            return Some((FaultKind::IndexMissing, Turns::ZERO, false));
        }
        if extra.is_some() {
            return extra;
        }
        let unconfirmed_jump = self.take_unconfirmed_jump()?;
        Some((FaultKind::EncoderGlitch, unconfirmed_jump, true))
    }

    /// Processes another pulse out of place. If the crank is ahead already, and its pulse is early again, it runs away.
    fn out_of_place(&mut self, by: Turns) -> Report {
        let is_ahead = self.diagnosis.has_jumped_ahead() && self.phase_error() > 0;
        if !self.diagnosis.had_extra() && !is_ahead {
            return self.extra(by, true);
        }
        self.runs_away(by)
    }

    fn runs_away(&mut self, by: Turns) -> Report {
        self.diagnosis.run();
        (FaultKind::Runaway, by, false)
    }

    /// Processes a motion of the crank, `by` as the index shows. Returns the whole motion.
    fn elsewhere(&mut self, by: Turns) -> Turns {
        self.diagnosis.pass_turn();
        if self.encoder.is_none() {
            return by; // named at the end of the round
        }
        let unconfirmed_jump = self.take_unconfirmed_jump().unwrap_or_default();
        // If the encoder jumped as well, the motor moved. Otherwise the crank slipped on its shaft. If the crank passes its flag during the
        // jump, the index shows only a part of it.
        let shown = angle(by).unsigned_abs();
        let jumped = angle(unconfirmed_jump).unsigned_abs();
        let same_sense = unconfirmed_jump != 0 && (by < 0) == (unconfirmed_jump < 0);
        if same_sense && shown <= jumped.saturating_add(angle(self.traits.gate).unsigned_abs()) {
            self.confirm(unconfirmed_jump, by);
            return unconfirmed_jump;
        }
        self.diagnosis.drift(by);
        self.home = self.home.wrapping_add(angle(by));
        by
    }

    /// Processes a missing pulse at the place where lost counts of the encoder would have put it. If the encoder jumped, the crank moved
    /// with it, and `has_moved` becomes the distance.
    fn nowhere(&mut self, has_moved: &mut Option<Turns>) -> Option<Report> {
        let unconfirmed_jump = self.take_unconfirmed_jump()?;
        if !self.traits.is_beyond_gate(angle(unconfirmed_jump)) {
            // The reading came back, so the crank did not move.
            return Some((FaultKind::EncoderGlitch, unconfirmed_jump, true));
        }
        self.confirm(unconfirmed_jump, Turns::ZERO);
        *has_moved = Some(unconfirmed_jump);
        None
    }

    /// Records that the crank made the same `jump` as its encoder. The index has `shown` a part of it.
    fn confirm(&mut self, jump: Turns, shown: Turns) {
        self.index
            .believe_moved(&self.traits, jump.wrapping_sub(shown));
        self.home = self.home.wrapping_add(angle(jump));
        self.jump(jump);
    }

    /// Processes an overdue pulse: the crank may be beyond its limit.
    fn overdue(&mut self, patience: Option<Turns>, is_homing: bool) -> Option<Report> {
        let index = &mut self.index;
        let alone = self.traits.alone;
        if self.encoder.is_some() && index.is_known() {
            index.pass_over(&self.traits);
            if self.diagnosis.is_slipping() && !is_homing {
                // The crank slipped on its shaft in the turn before, so the encoder does not show where it is.
                return Some((FaultKind::Slip, alone.wrapping_neg(), false));
            }
            let within_limits = index.missed <= MOST_MISSED;
            return Some((FaultKind::IndexMissing, Turns::ZERO, within_limits));
        }
        if let Some(patience) = patience.filter(|&most| most > alone) {
            index.wait(patience);
            return None;
        }
        Some((FaultKind::IndexTimeout, alone.wrapping_neg(), false))
    }

    /// Evaluates a reading of the encoder.
    fn sort_encoder(&mut self, read: Read) -> Option<Report> {
        match read {
            Read::Glitch { by } => Some((FaultKind::EncoderGlitch, by, true)),
            // There is no index that could decide, so the jump counts.
            Read::Jump { by } if !self.traits.has_index => {
                self.encoder.as_mut()?.believe();
                self.jump(by);
                None
            }
            _ => None,
        }
    }

    fn extra(&mut self, by: Turns, is_sure: bool) -> Report {
        let within_limits = self.diagnosis.extra(by) && is_sure;
        (FaultKind::IndexExtra, by, within_limits)
    }
}
