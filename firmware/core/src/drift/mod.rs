//! The drift monitor: how far each crank is from where commanded, what that does to the platform, and what it is
//! called.
//!
//! Words: *drift* is measured minus commanded phase of one axis. An *index pulse* comes once a turn of a crank, when it passes
//! its sensor; an *encoder*, where an axis has one, is read every tick. The cranks stand in a circle, so their N phase errors, with
//! the trims that correct them, are taken apart into *modes*: common (all lag alike: harmless), tilt about two axes, and warp,
//! which is what no flat platform can follow.
//!
//! - [`IndexFilter`] makes pulses of noisy lines; `index_watch` believes them, or does not.
//! - `encoder_watch` does the same for encoders. Of an axis that has both, the index shows what encoder and crank differ by.
//! - [`Mount`] takes drifts apart, [`DriftLimits`] says which modes are too large, `naming` what a crank that moved is called.
//!
//! A *round* is over when every axis without an encoder has been detected since the last: phase errors of one turn are compared with
//! each other and not with those of the turn before. What all cranks do alike is nobody's fault, and is taken out before one is
//! named.
//!
//! What it does not do: decide what is done ([`mod@crate::supervisor::reaction`] does), or move anything.

mod angles;
mod axis_watch;
mod encoder_watch;
mod findings;
mod history;
pub mod index_filter;
mod index_watch;
mod limits;
mod modes;
mod naming;
mod queue;
mod tick_phase;

pub use axis_watch::place_gate;
pub use findings::Finding;
pub use history::History;
pub use index_filter::IndexFilter;
pub use limits::DriftLimits;
pub use modes::{AxisSet, Knowledge, Modes, Mount};
pub(crate) use naming::is_better;
pub use tick_phase::{IndexPulse, TickPhase};

use crate::settings::{AxisSettings, Settings};
use crate::supervisor::{Fault, FaultKind};
use crate::units::{MAX_AXES, PerAxis, Phase, Turns, nearest};
use angles::{Angles, furthest, in_common, of_angle};
use axis_watch::AxisWatch;
use findings::Findings;
use queue::Queue;
use tick_phase::TickClock;

/// What came in during a tick.
#[derive(Clone, Copy, Debug)]
pub struct Sensed<'a> {
    /// Index pulses.
    pub index: &'a PerAxis<Option<IndexPulse>>,
    /// Encoder counts at its end, in the motors' own sense.
    pub encoder: &'a PerAxis<i32>,
    /// Phase of the master at the end of the tick that was planned last.
    pub phase: Phase,
    /// Commanded phases at that time, less the master's.
    pub lead: &'a PerAxis<Turns>,
    /// Turns that were commanded up to there.
    pub history: &'a History,
    /// Corrections that these phases contain.
    pub correction: &'a PerAxis<Turns>,
    /// Turns that the master made in it.
    pub speed: Turns,
    /// False if updates should wait for the next tick.
    pub may_process: bool,
}

impl Sensed<'_> {
    /// The phase of an axis over the tick that is over.
    fn over(&self, axis: usize) -> TickPhase {
        let lead = self.lead.get(axis).copied().unwrap_or_default();
        self.history.over(axis, self.phase.advanced(lead))
    }
}

/// Watches the drift of all axes.
#[derive(Clone, Debug)]
pub struct DriftMonitor {
    limits: DriftLimits,
    mount: Mount,
    axes: heapless::Vec<AxisWatch, MAX_AXES>,
    /// Axes that have an index sensor; that have no encoder besides; that have an encoder.
    sensed: AxisSet,
    by_index: AxisSet,
    by_encoder: AxisSet,
    clock: TickClock,
    /// The last call of [`Self::observe`] covered the tick before the one that is over.
    before_is_known: bool,
    /// Where the cranks stand is not known yet: what they are off by is nobody's fault.
    finding_out: bool,
    /// Meanwhile a crank was detected elsewhere than in the turn before, by so much.
    moved: Option<(usize, Turns)>,
    phase_error: PerAxis<Turns>,
    peak: PerAxis<Turns>,
    /// Axes whose phase error or peak may have changed.
    stale: AxisSet,
    /// Axes by index detected in this round.
    detected: AxisSet,
    /// Axes whose index has been detected at all.
    known: AxisSet,
    /// Axes whose index has been detected since [`Self::start_check`].
    checked: AxisSet,
    /// The two sets before, as of the last batch that was evaluated.
    evaluated: AxisSet,
    evaluated_checked: AxisSet,
    rounds: u32,
    /// In the last round, axes by index were off by about what they were in the one before: all but those that moved of themselves.
    is_even: bool,
    /// They have been compared since, so that the end of this round shows nothing.
    is_compared: bool,
    modes: Modes,
    /// Phase errors, peaks or modes may have changed since [`Self::take_changed`] was called last.
    changed: bool,
    findings: Findings,
    queue: Queue,
    is_busy: bool,
    /// No pulse of an axis by index is due before its axis has made so many more turns; negative if that is not known.
    margin: Turns,
}

/// The margin is not known.
const NO_MARGIN: Turns = Turns::from_bits(-1);

impl Default for DriftMonitor {
    fn default() -> Self {
        Self::new()
    }
}

impl DriftMonitor {
    /// A monitor without axes.
    pub const fn new() -> Self {
        Self {
            limits: DriftLimits::NONE,
            mount: Mount::NONE,
            axes: heapless::Vec::new(),
            sensed: 0,
            by_index: 0,
            by_encoder: 0,
            clock: TickClock::new(62_500),
            before_is_known: false,
            finding_out: true,
            moved: None,
            phase_error: [Turns::ZERO; MAX_AXES],
            peak: [Turns::ZERO; MAX_AXES],
            stale: 0,
            detected: 0,
            known: 0,
            checked: 0,
            evaluated: 0,
            evaluated_checked: 0,
            rounds: 0,
            is_even: false,
            is_compared: false,
            modes: Modes::ZERO,
            changed: false,
            findings: Findings::new(),
            queue: Queue::new(),
            is_busy: false,
            margin: NO_MARGIN,
        }
    }

    /// Begins anew with settings that have been checked.
    #[cold]
    #[inline(never)]
    pub fn configure(&mut self, settings: &Settings) {
        let limits = DriftLimits::new(&settings.drift, &settings.machine, settings.tick_hz);
        let set = |has: &dyn Fn(&AxisSettings) -> bool| {
            let axes = settings.axes.iter().enumerate();
            axes.fold(0, |set, (i, axis)| set | u8::from(has(axis)) << i)
        };
        let sensed = set(&|axis| axis.index_turns.is_some());
        let by_encoder = set(&|axis| axis.encoder);
        self.mount = Mount::with(settings.axes.len(), sensed | by_encoder);
        self.axes.clear();
        for (i, axis) in settings.axes.iter().enumerate() {
            let watch = AxisWatch::new(
                axis,
                settings.index.width_us * 1e-6,
                settings.tick_hz,
                limits.reading,
                limits.alone(&self.mount, i),
            );
            let pushed = self.axes.push(watch);
            debug_assert!(pushed.is_ok(), "settings hold no more axes than these");
        }
        self.limits = limits;
        self.sensed = sensed;
        self.by_index = sensed & !by_encoder;
        self.by_encoder = by_encoder;
        self.clock = TickClock::new(settings.tick_cycles());
        self.before_is_known = false;
        self.start_check();
        self.rounds = 0;
        self.reset_peak();
        self.reset(&[Phase::ZERO; MAX_AXES]);
    }

    /// Takes in what came during a tick that is over; returns the next finding to report, if there is one.
    #[inline(never)]
    pub fn observe(&mut self, sensed: &Sensed<'_>) -> Option<Finding> {
        let before_is_known = core::mem::replace(&mut self.before_is_known, true);
        self.findings.pass(sensed.speed);
        if self.by_encoder != 0 {
            self.observe_encoders(sensed, before_is_known);
        }
        let arrived = self.queue_pulses(sensed, before_is_known);
        self.margin = self.margin.wrapping_sub(sensed.history.most());
        if self.margin < 0 {
            self.check_timeouts(sensed);
        }
        let has_updates = self.has_updates() && (sensed.may_process || self.by_encoder != 0);
        if has_updates {
            self.process_queue(sensed, arrived);
        }
        self.is_busy = has_updates && self.by_encoder == 0;
        self.findings.next()
    }

    /// Takes note of a tick to which no phase belongs: sensors that were detected in it are alive.
    pub fn disregard(&mut self, sensed: &Sensed<'_>) {
        self.before_is_known = false;
        self.margin = NO_MARGIN;
        for (axis, watch) in self.axes.iter_mut().enumerate() {
            if let (Some(pulse), Some(&count)) = (sensed.index.get(axis), sensed.encoder.get(axis))
            {
                watch.disregard(pulse.is_some(), count, sensed.over(axis).start);
            }
        }
    }

    /// Sorts the update of an axis: a pulse, or a timeout or an encoder's. Returns true if the crank moved so far that the others are
    /// not waited for.
    #[inline(never)]
    fn sort(&mut self, axis: usize, may_be_timeout: bool, sensed: &Sensed<'_>) -> bool {
        let all_late = may_be_timeout && self.axes.iter().all(AxisWatch::is_late);
        let tolerance = self.limits.common;
        let others = self.in_common_but(axis, sensed.correction);
        let Some(watch) = self.axes.get_mut(axis) else {
            return false;
        };
        let sorted = watch.sort(all_late.then_some(tolerance));
        self.stale |= 1 << axis;
        if sorted.is_detected {
            self.detected |= 1 << axis;
            self.known |= 1 << axis;
            self.checked |= 1 << axis;
        }
        // A crank may pass a limit by its own pulse, long before the round is over.
        let correction = sensed.correction.get(axis).copied().unwrap_or_default();
        let own = watch.phase_error().wrapping_add(correction);
        let off = nearest(own.wrapping_sub(others)).abs();
        let has_moved = sorted.has_moved.filter(|_| watch.is_by_index());
        let most = if has_moved.is_some() {
            watch.alone()
        } else {
            watch.far()
        };
        // One that was late, and comes while all are stopped for that, is reported with what it did before they stand.
        let is_waited_for = has_moved.is_some() && self.findings.has_requested_stop();
        let is_far = sorted.is_detected && (off > most || is_waited_for);
        // A crank was not detected for a time during homing; the place where it shows again shows what it did.
        if let Some(by) = has_moved
            && self.finding_out
            && self.findings.has_requested_stop()
        {
            let kind = watch.jumped(by);
            self.find(axis, kind, by, false);
        } else if let Some(by) = sorted.has_moved
            && self.finding_out
        {
            self.moved = Some((axis, by));
        }
        if let Some((kind, by, within_limits)) = sorted.reported {
            self.find(axis, kind, by, within_limits);
        }
        is_far
    }

    /// Draws the conclusions from the axes that were updated, of which some have moved far. Returns true if limits are to be
    /// checked.
    #[inline(never)]
    fn conclude(&mut self, updated: AxisSet, moved: AxisSet) -> bool {
        let round =
            updated != 0 && self.detected & self.by_index == self.by_index && self.detected != 0;
        if self.finding_out && self.are_known() && updated != 0 && !round {
            // All turn at homing speed alike: what was detected a turn ago is as good.
            self.update();
        } else if moved != 0 && !round && !self.finding_out && self.others_are_detected(moved) {
            // It is not waited for the others, of which none is late: they have not moved with it.
            self.update();
            self.compare();
            self.is_compared = true;
        } else if round {
            self.detected = 0;
            self.rounds = self.rounds.wrapping_add(1);
            self.update();
            if !self.finding_out {
                let others_moved = self.compare().abs();
                let is_whole = !core::mem::take(&mut self.is_compared);
                self.is_even = is_whole && others_moved <= self.limits.reading;
            }
        } else if self.by_encoder != 0 || self.is_even && self.others_are_detected(updated) {
            // What all have in common is what it was in the round before, so that a crank may be held against others of a turn ago.
            self.update();
        } else {
            return false;
        }
        true
    }

    /// What all axes but one are off by in common, with their corrections. Not the mean of all: that one would be held against
    /// what it did itself.
    fn in_common_but(&self, axis: usize, correction: &PerAxis<Turns>) -> Turns {
        in_common(&self.phase_error, correction, self.watched() & !(1 << axis))
    }

    /// Whether none but the axes in `moved` is late.
    fn others_are_detected(&self, moved: AxisSet) -> bool {
        let others = self.by_index & !moved;
        let mut axes = self.axes.iter().enumerate();
        axes.all(|(axis, watch)| others & 1 << axis == 0 || !watch.is_late())
    }

    fn update(&mut self) {
        self.changed = true;
        let mut stale = core::mem::take(&mut self.stale) | self.by_encoder;
        for ((phase_error, peak), watch) in self
            .phase_error
            .iter_mut()
            .zip(&mut self.peak)
            .zip(&self.axes)
        {
            if stale & 1 != 0 {
                *phase_error = watch.phase_error();
                *peak = phase_error.wrapping_abs().max(*peak);
            }
            stale >>= 1;
        }
    }

    /// Names the axes by index that moved otherwise than the others in this round; what these moved by.
    fn compare(&mut self) -> Turns {
        of_angle(compare(&mut self.axes, self.by_index))
    }

    /// Phase errors with their corrections. While nobody knows the common zero, they may lie around half a turn: then their differences
    /// to the first are what counts.
    fn corrected_errors(&self, correction: &PerAxis<Turns>) -> PerAxis<Turns> {
        let mut error = self.phase_error;
        let first = self.watched().trailing_zeros() as usize;
        let base = match error.get(first) {
            Some(&first) if self.finding_out => first,
            _ => Turns::ZERO,
        };
        for (error, &correction) in error.iter_mut().zip(correction) {
            *error = nearest(error.wrapping_add(correction).wrapping_sub(base));
        }
        error
    }

    /// Takes the phase errors apart into modes; returns false if not all of them are known.
    #[inline(never)]
    fn update_modes(&mut self, sensed: &Sensed<'_>) -> bool {
        if self.finding_out {
            self.check_encoders();
        }
        if !self.are_known() {
            return false;
        }
        self.modes = self.mount.modes(&self.corrected_errors(sensed.correction));
        self.changed = true;
        true
    }

    /// Compares the modes with the limits, and reports what was named.
    #[inline(never)]
    fn check(&mut self, sensed: &Sensed<'_>) {
        let exceeded = self.exceeded(sensed.speed);
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let fresh = self.axes.get_mut(axis).and_then(AxisWatch::take_fresh);
            // During homing and levelling the homing itself evaluates what the cranks do.
            if let Some((kind, by)) = fresh.filter(|_| !self.finding_out) {
                self.find(axis, kind, by, exceeded.is_none());
            }
        }
        if let Some(kind) = exceeded {
            let error = self.corrected_errors(sensed.correction);
            self.attribute(kind, &error, sensed.speed);
        }
    }

    /// The limit that the cranks exceed, if they do: of the platform, or of the common lag.
    fn exceeded(&self, speed: Turns) -> Option<FaultKind> {
        // Where cranks were left, or tilted to prove their wiring, they stay; one that has moved goes on, and may be past already.
        let goes_on = || !self.finding_out && self.axes.iter().any(AxisWatch::has_moved);
        let may_be = self.limits.of_readings(&self.modes);
        let exceeded = may_be.and_then(|kind| {
            if goes_on() {
                Some(kind)
            } else {
                self.limits.of_platform(&self.modes)
            }
        });
        if exceeded.is_some() || self.finding_out {
            return exceeded;
        }
        self.limits.of_common(&self.modes, speed)
    }

    /// The cranks are beyond a limit: which of them, and why, if that is known.
    #[inline(never)]
    fn attribute(&mut self, kind: FaultKind, error: &PerAxis<Turns>, speed: Turns) {
        if kind == FaultKind::CommonLag {
            let size = self.limits.beyond_natural(&self.modes, speed);
            return self.findings.push(Fault::new(kind).with_size(size), false);
        }
        let kind = if self.finding_out {
            FaultKind::HomingRangeExceeded
        } else {
            kind
        };
        // Of two cranks that are apart, the one of which something is known is the one that moved.
        let worst = self.worst(error);
        let named = |axis: usize| self.axes.get(axis).and_then(AxisWatch::name);
        let count = self.axes.len();
        let known = (worst..count)
            .chain(0..worst)
            .take(if count == 2 { 2 } else { 1 })
            .find(|&axis| named(axis).is_some());
        match known {
            Some(axis) => self.push_axis(axis, named(axis).unwrap_or(kind)),
            None => self.push_axis(worst, kind),
        }
    }

    #[inline(never)]
    fn push_axis(&mut self, axis: usize, kind: FaultKind) {
        let size = self.phase_error.get(axis).copied().unwrap_or_default();
        self.findings
            .push(Fault::new(kind).on_axis(axis).with_size(size), false);
    }

    /// The axis that is furthest from what all have in common.
    fn worst(&self, error: &PerAxis<Turns>) -> usize {
        furthest(error, self.watched())
    }

    /// While nobody knows where the cranks should be, encoders still show an axis that does not turn as commanded; of all that do not,
    /// too, whose phase errors are alike.
    fn check_encoders(&mut self) {
        for axis in 0..self.axes.len().min(MAX_AXES) {
            let Some(watch) = self.axes.get(axis) else {
                continue;
            };
            if let Some((kind, by)) = watch.tracking_fault() {
                let fault = Fault::new(kind).on_axis(axis).with_size(by);
                self.findings.push(fault, false);
            }
        }
    }

    #[inline(never)]
    fn find(&mut self, axis: usize, kind: FaultKind, by: Turns, within_limits: bool) {
        let fault = Fault::new(kind).on_axis(axis).with_size(by);
        self.findings.push(fault, within_limits);
    }

    /// What a jump of an axis is called that nothing is known of but its size.
    pub fn name_of(&self, axis: usize, by: Turns) -> FaultKind {
        let watch = self.axes.get(axis);
        watch.map_or(FaultKind::Slip, |watch| watch.name_of(by))
    }

    /// Whether every axis that has a sensor has been detected since [`Self::reset`], and phase errors are up to date.
    pub const fn is_homed(&self) -> bool {
        self.evaluated == self.sensed
    }

    const fn are_known(&self) -> bool {
        self.known == self.sensed
    }

    /// Whether the last tick had updates by index to process.
    pub const fn is_busy(&self) -> bool {
        self.is_busy
    }

    /// Rounds that are over since power-up; wraps.
    pub const fn rounds(&self) -> u32 {
        self.rounds
    }

    /// Forgets what was measured: the cranks may have been turned while the drives were off. From now on they are homed.
    pub fn reset(&mut self, phase: &PerAxis<Phase>) {
        self.detected = 0;
        self.known = 0;
        self.evaluated = 0;
        self.is_even = false;
        self.is_compared = false;
        self.finding_out = true;
        self.moved = None;
        self.findings.clear();
        self.queue = Queue::new();
        self.margin = NO_MARGIN;
        for (watch, &phase) in self.axes.iter_mut().zip(phase) {
            watch.reset(phase);
        }
        self.phase_error = [Turns::ZERO; MAX_AXES];
        self.modes = Modes::default();
        self.stale = AxisSet::MAX;
        self.changed = true;
    }

    /// Takes the crank that was detected elsewhere than in the turn before during homing, and the distance.
    pub const fn take_moved(&mut self) -> Option<(usize, Turns)> {
        self.moved.take()
    }

    /// Phase error of each axis as it is known now, round or not, with little of the readings' noise and some ticks late.
    pub fn filtered_error(&self) -> PerAxis<Turns> {
        let mut errors = self.phase_error;
        fill(&mut errors, &self.axes, AxisWatch::filtered_error);
        errors
    }

    /// The same as each crank passed its flag last: to be compared with what it was a turn ago.
    pub fn errors_at_flags(&self) -> PerAxis<Turns> {
        let mut errors = self.phase_error;
        fill(&mut errors, &self.axes, AxisWatch::error_at_flag);
        errors
    }

    /// Takes in what was detected in a round that is not over.
    pub fn refresh(&mut self) {
        self.update();
    }

    /// Whatever was detected, every index is to be detected again.
    pub const fn start_check(&mut self) {
        self.checked = 0;
        self.evaluated_checked = 0;
    }

    /// Whether every index has been detected since [`Self::start_check`].
    pub const fn is_check_done(&self) -> bool {
        self.evaluated_checked & self.sensed == self.sensed
    }

    /// The cranks are where they are: from now on, what moves one of them is a fault.
    pub fn settle(&mut self) {
        self.finding_out = false;
        for watch in &mut self.axes {
            watch.settle();
        }
    }

    /// All phases are counted from elsewhere: every crank is `by` less ahead than it was.
    pub fn shift(&mut self, by: Turns) {
        for watch in &mut self.axes {
            watch.shift(by.wrapping_neg());
        }
        self.stale = AxisSet::MAX;
        self.update();
        self.peak = self.phase_error.map(Turns::wrapping_abs);
    }

    /// What a crank's reading may be off by, turns.
    pub fn tolerance(&self, axis: usize) -> Turns {
        self.axes
            .get(axis)
            .map_or(Turns::ZERO, |watch| watch.tolerance())
    }

    /// What a crank's readings differ by, at most, where its rotor only swings, turns.
    pub fn swing(&self, axis: usize) -> Turns {
        self.axes
            .get(axis)
            .map_or(Turns::MAX, |watch| watch.swing())
    }

    /// The watched axis that is furthest from what all have in common.
    pub fn furthest(&self, error: &PerAxis<Turns>) -> usize {
        self.worst(error)
    }

    /// Whether the platform may tilt and bend so.
    pub fn allows(&self, error: &PerAxis<Turns>) -> bool {
        self.limits.of_platform(&self.mount.modes(error)).is_none()
    }

    /// Axes that some sensor detects.
    pub const fn watched(&self) -> AxisSet {
        self.sensed | self.by_encoder
    }

    /// Whether axes with an encoder are among them.
    pub const fn has_encoders(&self) -> bool {
        self.by_encoder != 0
    }

    /// Phase error of each axis, as last measured: turns, −½ to ½.
    pub const fn phase_error(&self) -> &PerAxis<Turns> {
        &self.phase_error
    }

    /// The largest of it so far, without sign.
    pub const fn peak(&self) -> &PerAxis<Turns> {
        &self.peak
    }

    /// Forgets the largest phase errors.
    pub fn reset_peak(&mut self) {
        self.peak = [Turns::ZERO; MAX_AXES];
        // The present phase errors count again with the next update.
        self.stale = AxisSet::MAX;
        self.changed = true;
    }

    /// Whether phase errors, their peaks or their modes may have changed since the last call.
    pub const fn take_changed(&mut self) -> bool {
        core::mem::replace(&mut self.changed, false)
    }

    /// The modes of the phase errors and their correction, as last taken.
    pub const fn modes(&self) -> &Modes {
        &self.modes
    }
}

/// A phase error of each axis.
#[inline(never)]
fn fill(errors: &mut [Turns], axes: &[AxisWatch], of: impl Fn(&AxisWatch) -> Turns) {
    for (phase_error, watch) in errors.iter_mut().zip(axes) {
        *phase_error = of(watch);
    }
}

/// Compares what each axis of a set did in a round with what they did in common, which it gives.
#[inline(never)]
fn compare(axes: &mut [AxisWatch], set: AxisSet) -> i32 {
    let (mut jumps, mut walks) = (Angles::default(), Angles::default());
    for (axis, watch) in axes.iter().enumerate() {
        if set & 1 << axis != 0 {
            let (jump, walk) = watch.moved();
            jumps.push(jump);
            walks.push(walk);
        }
    }
    let (jump, walk) = (jumps.common(), walks.common());
    for (axis, watch) in axes.iter_mut().enumerate() {
        if set & 1 << axis != 0 {
            watch.compare(jump, walk);
        }
    }
    jump
}

#[cfg(test)]
mod tests;
