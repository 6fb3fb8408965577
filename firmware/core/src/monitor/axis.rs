//! One axis of the monitor: what its sensors show together.
//!
//! An axis with both sensors has the phase error of its encoder plus the place of its index, which is the difference of crank and encoder.
//! A jump of the encoder is *unconfirmed* until the index decides. A pulse in its place shows that counts were lost. No pulse there shows
//! that the crank moved. If the index is out of place and the encoder has measured nothing, the crank slipped on its shaft.

use super::angles::{Angle, angle, exceeds, of_angle};
use super::config::AxisConfig;
use super::counts::Counts;
use super::encoder::{Encoder, Read, Tracking};
use super::evaluate::Tick;
use super::index::{Index, MAX_LATE, Passage, Pulse};
use super::names::{Events, may_be_fast};
use super::pulses::IndexPulse;
use super::steady_drift::SteadyDrift;
use crate::commanded::TickPhase;
use crate::servo::{ServoPart, servo_part};
use crate::settings::AxisSettings;
use crate::supervisor::FaultKind;
use crate::units::{AxisSet, PerAxis, Phase, Turns, nearest};

/// Missing index pulses in a row that are tolerated on an axis with an encoder.
const MAX_MISSED: u8 = 2;

/// Filter of a phase error, on an axis whose encoder shows it all the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorFilter {
    /// The error in this tick, with the noise of a reading.
    None,
    /// The mean over the last ticks: with less noise, and delayed by some ticks.
    LowPass,
    /// The error at the last passage of the flag, where loads are alike in each turn, to be compared with that of a turn ago. Without an
    /// index sensor, the same as `LowPass`.
    AtIndex,
}

/// Motion of a crank on its shaft or away from its command.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    /// Since the last round.
    pub jump: Angle,
    /// Since the place from which slow motion is counted.
    pub drift: Angle,
}

/// Fault that is to be reported: its kind, its size, and whether the crank is still detected.
pub(super) type Report = (FaultKind, Turns, bool);

/// Observations of a tick, of all axes. Sets have a bit for each axis.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    /// True while homing searches for the phases of the cranks.
    pub is_homing: bool,
    /// Axis that is observed.
    pub axis: usize,
    /// Axes whose index showed where they are.
    pub updated: AxisSet,
    /// Axes with a motion, and with a steady drift, that have not been reported yet.
    pub moved: AxisSet,
    pub drifting: AxisSet,
    /// Axes whose pulses are late and no longer come in their places, and by how many turns.
    pub late: AxisSet,
    pub late_by: PerAxis<Turns>,
    /// Distance by which the axis moved, as its index shows.
    pub has_moved: Option<Angle>,
    /// Fault of the axis that is to be reported.
    pub reported: Option<Report>,
}

impl Shown {
    const fn is_updated(&self) -> bool {
        self.updated & 1 << self.axis != 0
    }

    fn is_late(&mut self, by: Turns) {
        if let Some(late) = self.late_by.get_mut(self.axis) {
            *late = by;
            self.late |= 1 << self.axis;
        }
    }
}

/// One axis: its configuration, and its state.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) config: AxisConfig,
    /// Without a sensor, pulses are ignored, and the place stays zero.
    pub(super) index: Index,
    pub(super) encoder: Option<ServoPart<Encoder>>,
    /// Place in the last round, and the place from which slow motion is counted.
    last: Angle,
    drift_origin: Angle,
    pub(super) events: Events,
    pub(super) steady_drift: SteadyDrift,
}

impl Axis {
    #[cold]
    pub(super) fn new(config: AxisConfig, axis: &AxisSettings) -> Self {
        let encoder = axis.encoder.then(|| Encoder::new(Counts::new(axis)));
        Self {
            config,
            index: Index::new(Phase::ZERO),
            encoder: servo_part(encoder),
            last: Angle::ZERO,
            drift_origin: Angle::ZERO,
            events: Events::new(),
            steady_drift: SteadyDrift::default(),
        }
    }

    /// Processes a tick of an axis without an encoder. Returns by how many turns its next pulse is late; negative if it is not due.
    #[inline(always)] // of the loop over all axes
    pub(super) fn observe(&mut self, tick: &Tick<'_>, shown: &mut Shown) -> Turns {
        let axis = shown.axis;
        if let Some(pulse) = tick.sensed.index.of(axis) {
            let over = tick.over(axis);
            let before = tick.before(axis);
            let index = &mut self.index;
            let pulse = index.measure(&self.config, tick, pulse.cycle, &over, before, over.turns);
            self.pulse(pulse, None, shown);
            return self.index.late(over.end());
        }
        self.index.late(tick.end(axis))
    }

    /// Processes a tick of an axis with an encoder.
    #[inline(never)]
    pub(super) fn observe_encoder(&mut self, tick: &Tick<'_>, shown: &mut Shown) {
        let axis = shown.axis;
        let Some(encoder) = &mut self.encoder else {
            return;
        };
        let commanded = tick.over(axis);
        let count = tick.sensed.encoder.get(axis).copied().unwrap_or_default();
        // The phase of the motor, not of its command.
        let start = commanded.start.advanced(encoder.phase_error);
        let before = encoder.last_turns;
        let (read, turns) = encoder.observe(count, &commanded, self.config.jump());
        let jumped = encoder.unconfirmed.map(|jumps| jumps.at);
        let over = TickPhase { start, turns };
        if self.config.has_index {
            // Noise may turn a motor back for a tick. The commanded sense decides which end of the flag it meets.
            let measure = |pulse: IndexPulse| {
                let turns = commanded.turns;
                self.index
                    .measure(&self.config, tick, pulse.cycle, &over, before, turns)
            };
            let pulse = tick.sensed.index.of(axis).and_then(measure);
            self.pulse(pulse, jumped, shown);
            if self.index.late(over.end()) > 0 {
                self.wait(over.start, commanded.turns, jumped, shown);
            }
        }
        if shown.reported.is_none() {
            shown.reported = self.read(read, shown);
        }
        if shown.is_updated()
            && let Some(encoder) = &mut self.encoder
        {
            encoder.at_flag = encoder.filtered;
        }
    }

    /// Processes a pulse.
    fn pulse(&mut self, pulse: Option<Pulse>, jumped: Option<Phase>, shown: &mut Shown) {
        let Some(pulse) = pulse else {
            return;
        };
        // A place that passed before the pulse decides first.
        if self.index.contradicts(&self.config, &pulse) {
            let passage = self.index.pass(&self.config, pulse.at, jumped);
            self.apply(passage, shown);
        }
        let passage = self.index.decide(&self.config, pulse);
        self.apply(passage, shown);
    }

    /// Processes that the next pulse may be late at the end of a tick of `commanded` turns, which began at the phase `start`.
    #[inline(never)] // seldom
    pub(super) fn wait(
        &mut self,
        start: Phase,
        commanded: Turns,
        jumped: Option<Phase>,
        shown: &mut Shown,
    ) {
        // Pulses have been reported up to a part of the tick.
        let covered = (commanded.to_bits() >> 16).wrapping_mul(i64::from(self.config.covered));
        let now = start.advanced(Turns::from_bits(covered));
        if !shown.is_updated() {
            let passage = self.index.pass(&self.config, now, jumped);
            self.apply(passage, shown);
        }
        // A missing pulse is no evidence against an encoder, except before the first pulse.
        let late = self.index.late(now);
        if late > self.config.gate && !(self.config.has_encoder && self.index.is_known()) {
            shown.is_late(late.min(MAX_LATE));
        }
    }

    /// Processes a tick whose phase is not known.
    pub(super) fn disregard(&mut self, has_pulse: bool, count: i32, start: Phase) {
        let mut start = start;
        if let Some(encoder) = &mut self.encoder {
            encoder.skip(count);
            start = start.advanced(encoder.phase_error);
        }
        if has_pulse && self.config.has_index {
            self.index.disregard(start);
        }
    }

    /// Evaluates what a pulse, or its absence, showed.
    #[inline(never)]
    fn apply(&mut self, passage: Passage, shown: &mut Shown) {
        let has_encoder = self.config.has_encoder;
        let before = shown.has_moved;
        let reported = match passage {
            Passage::Nothing => return,
            Passage::First => self.first(),
            Passage::InPlace { extra, was_missing } => {
                self.on_expected_pulse(extra, was_missing && !has_encoder, shown)
            }
            Passage::Elsewhere { by } => {
                let runs = !has_encoder && self.events.runs_on(by, &self.config);
                runs.then(|| self.runs_away(by))
            }
            // Before the place is confirmed, pulses at several places may be noise. An encoder shows whether the crank runs.
            Passage::Extra { by } if !self.index.is_confirmed() => {
                let is_sure = !self.events.had_extra() || has_encoder;
                Some(self.extra(by, is_sure))
            }
            // If the crank is ahead already, and its pulse is early again, it runs away.
            Passage::Extra { by } => {
                let is_ahead = self.events.has_jumped_ahead() && self.error(ErrorFilter::None) > 0;
                let runs = self.events.had_extra() || is_ahead;
                Some(if runs {
                    self.runs_away(by)
                } else {
                    self.extra(by, true)
                })
            }
            // Two pulses in a turn, neither at the guess: the crank gains, or it is noise, and the next turn decides.
            Passage::Dismissed { by } if self.events.had_extra() => {
                shown.has_moved = Some(self.on_moved_pulse(-by, shown));
                None
            }
            // The flag passes once in a turn, so the only pulse of this turn is its own, whether the guess was noise or the crank gains.
            Passage::Dismissed { by } => {
                self.index.confirm();
                let report = self.extra(by, true); // in the turn that is over
                self.events.pass_turn();
                self.drift_origin = self.index.place;
                Some(report)
            }
            Passage::Moved { by, from_guess } => {
                // Two pulses in a turn, neither in its place: the crank runs away, or it moved after an extra pulse. Before the place is
                // confirmed, the first pulse may have been noise, and the next turns decide.
                let may_run = !has_encoder && !from_guess && self.events.had_extra();
                shown.has_moved = Some(self.on_moved_pulse(by, shown));
                may_run.then_some((FaultKind::IndexExtra, of_angle(by), false))
            }
            Passage::NotWhereCountsWereLost => self.on_absent_pulse(shown),
            Passage::Missing => Some(self.missing(shown.is_homing)),
        };
        let is_place = matches!(
            passage,
            Passage::First | Passage::InPlace { .. } | Passage::Dismissed { .. }
        );
        if is_place || shown.has_moved != before {
            shown.updated |= 1 << shown.axis;
        }
        if shown.reported.is_none() {
            shown.reported = reported;
        }
    }

    /// Processes the first pulse of all, which shows where the crank is. Reports a jump that the encoder made before it.
    fn first(&mut self) -> Option<Report> {
        self.drift_origin = self.index.place;
        let by = self.take_unconfirmed()?;
        let kind = match self.config.name_of_one(by) {
            FaultKind::LostSteps => FaultKind::LostSteps,
            _ => FaultKind::EncoderGlitch,
        };
        Some((kind, by, true))
    }

    /// Takes the unconfirmed jump of the encoder, if there is one.
    fn take_unconfirmed(&mut self) -> Option<Turns> {
        self.encoder.as_mut()?.take_unconfirmed()
    }

    /// Processes a pulse in its place, and perhaps an extra one before it.
    fn on_expected_pulse(
        &mut self,
        extra: Option<Angle>,
        was_missing: bool,
        shown: &mut Shown,
    ) -> Option<Report> {
        // An encoder shows whether the crank runs fast. At three times the commanded speed, two extra pulses come per turn.
        let extra = extra.map(|by| {
            let is_slow = !may_be_fast(by) && !self.events.had_extra();
            self.extra(by, is_slow || self.config.has_encoder)
        });
        self.events.pass_turn();
        if self.config.has_encoder {
            // The crank may move away from its encoder, turn by turn.
            self.follow_drift(self.motion().drift, shown);
        }
        if was_missing {
            return Some((FaultKind::IndexMissing, Turns::ZERO, false));
        }
        if extra.is_some() {
            return extra;
        }
        let unconfirmed = self.take_unconfirmed()?;
        Some((FaultKind::EncoderGlitch, unconfirmed, true))
    }

    fn extra(&mut self, by: Angle, is_sure: bool) -> Report {
        let within_limits = self.events.extra(by) && is_sure;
        (FaultKind::IndexExtra, of_angle(by), within_limits)
    }

    fn runs_away(&mut self, by: Angle) -> Report {
        self.events.run();
        (FaultKind::Runaway, of_angle(by), false)
    }

    /// Processes a motion of the crank, `by` as the index shows. Returns the whole motion.
    fn on_moved_pulse(&mut self, by: Angle, shown: &mut Shown) -> Angle {
        self.events.pass_turn();
        if self.encoder.is_none() {
            return by; // named at the end of the round
        }
        shown.moved |= 1 << shown.axis;
        let jump = self.take_unconfirmed().unwrap_or_default();
        // If the encoder jumped as well, the motor moved. Otherwise the crank slipped on its shaft. If the crank passes its flag during the
        // jump, the index shows only a part of it.
        let observed = of_angle(by);
        let same_sense = jump != 0 && (observed < 0) == (jump < 0);
        let max = of_angle(angle(jump))
            .wrapping_abs()
            .saturating_add(self.config.gate);
        if same_sense && observed.wrapping_abs() <= max {
            self.confirm(jump, observed, false);
            return angle(jump);
        }
        self.events.slip(by);
        self.drift_origin += by;
        by
    }

    /// Processes a missing pulse at the place where lost counts of the encoder would have put it. If the encoder jumped, the crank moved
    /// with it.
    fn on_absent_pulse(&mut self, shown: &mut Shown) -> Option<Report> {
        let jump = self.take_unconfirmed()?;
        if !self.config.is_beyond_gate(angle(jump)) {
            // The reading came back, so the crank did not move.
            return Some((FaultKind::EncoderGlitch, jump, true));
        }
        self.confirm(jump, Turns::ZERO, true);
        shown.has_moved = Some(angle(jump));
        shown.moved |= 1 << shown.axis;
        None
    }

    /// Records that the crank made the same `jump` as its encoder. The index has `shown` a part of it.
    fn confirm(&mut self, jump: Turns, shown: Turns, has_passed: bool) {
        self.index.move_place(jump.wrapping_sub(shown), has_passed);
        self.drift_origin += angle(jump);
        self.jump(angle(jump));
    }

    /// Records that the crank jumped.
    pub(super) fn jump(&mut self, by: Angle) {
        self.events.jump(by, self.error(ErrorFilter::None) > 0);
    }

    /// Processes a missing pulse of an axis whose encoder shows that it turns.
    fn missing(&self, is_homing: bool) -> Report {
        if self.events.is_slipping(&self.config) && !is_homing {
            // The crank slipped on its shaft in the turn before, so the encoder does not show where it is.
            return (
                FaultKind::Slip,
                self.config.single_axis_limit.wrapping_neg(),
                false,
            );
        }
        let within_limits = self.index.missed <= MAX_MISSED;
        (FaultKind::IndexMissing, Turns::ZERO, within_limits)
    }

    /// Evaluates a reading of the encoder.
    fn read(&mut self, read: Read, shown: &mut Shown) -> Option<Report> {
        match read {
            Read::Glitch { by } => return Some((FaultKind::EncoderGlitch, by, true)),
            // There is no index that could decide, so the jump counts.
            Read::Jump { by } if !self.config.has_index => {
                self.encoder.as_mut()?.accept();
                self.jump(angle(by));
                shown.moved |= 1 << shown.axis;
            }
            _ => {}
        }
        None
    }

    /// Compares an axis without an encoder with the `common` motion, and begins a new round.
    pub(super) fn compare(&mut self, common: Motion, shown: &mut Shown) {
        let own = self.motion();
        let jump = own.jump - common.jump;
        self.last = self.index.place;
        if self.config.is_beyond_gate(jump) {
            self.drift_origin += jump;
            self.jump(jump);
            shown.moved |= 1 << shown.axis;
        } else {
            self.follow_drift(own.drift - common.drift, shown);
        }
    }

    /// Records how far the crank is from where slow motion is counted, once a turn.
    fn follow_drift(&mut self, drift: Angle, shown: &mut Shown) {
        if self.steady_drift.add(drift, self.config.drift_step()) {
            shown.drifting |= 1 << shown.axis;
        }
        if self.config.is_beyond_gate(drift) {
            self.drift_origin += drift;
            self.steady_drift.shift(drift);
            self.events.slip(drift);
            shown.moved |= 1 << shown.axis;
        }
    }

    /// Motion of the crank.
    pub(super) fn motion(&self) -> Motion {
        Motion {
            jump: self.index.place - self.last,
            drift: self.index.place - self.drift_origin,
        }
    }

    /// True if the crank moved by more than a gate from the `common` motion.
    pub(super) fn moves_from(&self, common: Motion) -> bool {
        let own = self.motion();
        self.config.is_beyond_gate(own.jump - common.jump)
            || self.config.is_beyond_gate(own.drift - common.drift)
    }

    /// Measured minus commanded, turns, −½ to ½.
    #[inline(never)]
    pub(super) fn error(&self, filter: ErrorFilter) -> Turns {
        let place = of_angle(self.index.place);
        let Some(encoder) = &self.encoder else {
            return place;
        };
        let own = match filter {
            ErrorFilter::None => encoder.phase_error,
            ErrorFilter::AtIndex if self.config.has_index => encoder.at_flag,
            ErrorFilter::LowPass | ErrorFilter::AtIndex => encoder.filtered,
        };
        nearest(place.wrapping_add(own))
    }

    /// Name of the fault that moved this axis in the last turns, or moves it now, if it is known.
    pub(super) fn name(&self) -> Option<FaultKind> {
        self.tracking().or_else(|| self.events.name(&self.config))
    }

    /// True if the crank moved in the last turns, or its motor does now.
    pub(super) fn has_moved(&self) -> bool {
        self.events.has_moved() || self.tracking().is_some()
    }

    /// Name of the motor's motion by its encoder, if that is the cause of its phase error.
    pub(super) fn tracking(&self) -> Option<FaultKind> {
        let encoder = self.encoder.as_ref()?;
        if !exceeds(angle(encoder.phase_error), self.config.gate) {
            return None;
        }
        match encoder.tracking {
            Tracking::Ok => None,
            Tracking::Stalled if encoder.has_gone_back(&self.config) => Some(FaultKind::Reversed),
            Tracking::Stalled => Some(FaultKind::Stuck),
            Tracking::Overspeed => Some(FaultKind::Runaway),
        }
    }

    /// Phase error of the motor by its encoder.
    pub(super) fn tracking_error(&self) -> Option<Turns> {
        self.encoder.as_ref().map(|encoder| encoder.phase_error)
    }

    /// True if its encoder alone shows that the axis does not turn as commanded.
    pub(super) fn is_off_track(&self) -> bool {
        let error = self.tracking_error();
        error.is_some_and(|error| error.wrapping_abs() > self.config.single_axis_limit)
    }

    /// Discards all measurements. The search for the index begins at this phase.
    #[inline(never)] // long, and runs only once per start
    pub(super) fn reset(&mut self, phase: Phase) {
        self.index = Index::new(phase);
        if let Some(encoder) = &mut self.encoder {
            encoder.reset();
        }
        self.events = Events::new();
    }

    /// Ends homing: motion counts from here.
    pub(super) fn settle(&mut self) {
        self.last = self.index.place;
        self.drift_origin = self.last;
        self.events = Events::new();
        self.steady_drift = SteadyDrift::default();
    }

    /// Moves the zero of all phases, so that the phase error grows by `by`.
    pub(super) fn shift(&mut self, by: Angle) {
        if self.config.has_index {
            self.index.shift(by);
        }
        self.last += by;
        self.drift_origin += by;
    }
}
