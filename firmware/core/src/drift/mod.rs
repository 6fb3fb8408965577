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
//! - [`Mount`] takes drifts apart, [`DriftLimits`] says which modes are too large, `diagnosis` what a crank that moved is called.
//!
//! A *round* is over when every axis without an encoder has been detected since the last: phase errors of one turn are compared with
//! each other and not with those of the turn before. What all cranks do alike is nobody's fault, and is taken out before one is
//! named.
//!
//! What it does not do: decide what is done ([`mod@crate::supervisor::reaction`] does), or move anything.

mod axis_watch;
mod configure;
mod detection;
mod diagnosis;
mod process;
mod queue;
pub mod sensing;

pub use axis_watch::place_gate;
pub use detection::limits::DriftLimits;
pub use detection::modes::{AxisSet, Knowledge, Modes, Mount};
pub use diagnosis::alternatives::alternatives;
pub(crate) use diagnosis::events::is_better;
pub use diagnosis::findings::Finding;
pub use sensing::history::History;
pub use sensing::index_filter::IndexFilter;
pub use sensing::tick_phase::{IndexPulse, TickPhase};

use crate::supervisor::FaultKind;
use crate::units::{MAX_AXES, PerAxis, Phase, Turns};
use axis_watch::{AxisWatch, Measured};
use detection::angles::furthest;
use diagnosis::findings::Findings;
use queue::Queue;
use sensing::tick_phase::TickClock;

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
#[repr(C)] // What every tick needs comes first: the board's instructions reach 32 bytes, or 128 by words.
pub struct DriftMonitor {
    /// The last call of [`Self::observe`] covered the tick before the one that is over.
    before_is_known: bool,
    is_busy: bool,
    /// Phase errors, peaks or modes may have changed since [`Self::take_changed`] was called last.
    changed: bool,
    /// Axes that have an index sensor; that have no encoder besides; that have an encoder.
    sensed: AxisSet,
    by_index: AxisSet,
    by_encoder: AxisSet,
    /// All updates of a tick are processed in it.
    at_once: bool,
    /// Where the cranks stand is not known yet: what they are off by is nobody's fault.
    finding_out: bool,
    /// Axes by index detected in this round.
    detected: AxisSet,
    /// Axes whose index has been detected at all.
    known: AxisSet,
    /// All indexes had been detected when axes were evaluated last.
    is_homed: bool,
    /// Axes whose index has been detected since [`Self::start_check`].
    checked: AxisSet,
    /// In the last round, axes by index were off by about what they were in the one before: all but those that moved of themselves.
    is_even: bool,
    /// They have been compared since, so that the end of this round shows nothing.
    is_compared: bool,
    queue: Queue,
    /// No pulse of an axis by index is due before its axis has made so many more turns; negative if that is not known.
    margin: Turns,
    rounds: u32,
    /// Turns of the master over which the errors of encoders have been averaged, up to one.
    averaged: Turns,
    clock: TickClock,
    findings: Findings,
    phase_error: PerAxis<Turns>,
    peak: PerAxis<Turns>,
    modes: Modes,
    limits: DriftLimits,
    mount: Mount,
    /// Meanwhile a crank was detected elsewhere than in the turn before, by so much.
    moved: Option<(usize, Turns)>,
    axes: heapless::Vec<AxisWatch, MAX_AXES>,
}

/// The margin is not known.
const NO_MARGIN: Turns = Turns::from_bits(-1);

impl DriftMonitor {
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

    /// What a jump of an axis is called that nothing is known of but its size.
    pub fn name_of(&self, axis: usize, by: Turns) -> FaultKind {
        let watch = self.axes.get(axis);
        watch.map_or(FaultKind::Slip, |watch| watch.name_of(by))
    }

    /// True if every axis that has a sensor has been detected since [`Self::reset`], and that has been evaluated.
    pub const fn is_homed(&self) -> bool {
        self.is_homed
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
        self.is_homed = self.are_known();
        self.is_even = false;
        self.is_compared = false;
        self.finding_out = true;
        self.moved = None;
        self.findings.clear();
        self.queue = Queue::new();
        self.margin = NO_MARGIN;
        self.averaged = Turns::ZERO;
        for (watch, &phase) in self.axes.iter_mut().zip(phase) {
            watch.reset(phase);
        }
        self.phase_error = [Turns::ZERO; MAX_AXES];
        self.modes = Modes::default();
        self.changed = true;
    }

    /// Takes the crank that was detected elsewhere than in the turn before during homing, and the distance.
    pub const fn take_moved(&mut self) -> Option<(usize, Turns)> {
        self.moved.take()
    }

    /// Phase error of each axis as it is known now, round or not, with little of the readings' noise and some ticks late.
    pub fn filtered_error(&self) -> PerAxis<Turns> {
        self.errors(Measured::Lately)
    }

    /// The same as each crank passed its flag last: to be compared with what it was a turn ago.
    pub fn errors_at_flags(&self) -> PerAxis<Turns> {
        self.errors(Measured::AtFlag)
    }

    /// Phase errors of one turn: the mean of those that encoders show, and others as the cranks passed their flags. What loads do to a
    /// crank differs by its angle, and a crank that swings where its rods let go is elsewhere there each time.
    pub fn turn_errors(&self) -> PerAxis<Turns> {
        self.errors(Measured::OverTurn)
    }

    #[inline(never)]
    fn errors(&self, measured: Measured) -> PerAxis<Turns> {
        let mut errors = self.phase_error;
        for (error, watch) in errors.iter_mut().zip(&self.axes) {
            *error = watch.error(measured);
        }
        errors
    }

    /// True if [`Self::turn_errors`] cover a whole turn since [`Self::reset`] or [`Self::start_check`].
    pub fn is_turn_over(&self) -> bool {
        !self.has_encoders() || self.averaged >= Turns::ONE
    }

    /// Takes in the phase error of an axis.
    fn update(&mut self, axis: usize) {
        let slots = self.phase_error.get_mut(axis).zip(self.peak.get_mut(axis));
        if let (Some(watch), Some((phase_error, peak))) = (self.axes.get(axis), slots) {
            *phase_error = watch.phase_error();
            *peak = phase_error.wrapping_abs().max(*peak);
            self.changed = true;
        }
    }

    /// Whatever was detected, every index is to be detected again, and encoders to be read over a turn.
    pub fn start_check(&mut self) {
        self.checked = 0;
        self.averaged = Turns::ZERO;
        for watch in &mut self.axes {
            watch.restart_average();
        }
    }

    /// True if every index has been detected since [`Self::start_check`], and encoders have been read over a turn.
    pub fn is_check_done(&self) -> bool {
        self.queue.is_evaluated()
            && self.checked & self.sensed == self.sensed
            && self.is_turn_over()
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
        self.phase_error = self.errors(Measured::Now);
        self.peak = self.phase_error.map(Turns::wrapping_abs);
        self.changed = true;
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

    /// Turns by which one crank alone takes the platform beyond a limit.
    pub fn alone(&self, axis: usize) -> Turns {
        self.axes
            .get(axis)
            .map_or(Turns::MAX, |watch| watch.alone())
    }

    /// Phase error of an axis's motor by its encoder, if it has one.
    pub fn motor_error(&self, axis: usize) -> Option<Turns> {
        self.axes.get(axis)?.tracking_error()
    }

    /// True if the sensor of an axis that is commanded to this phase may be at an end of its flag, so that a swinging rotor makes pulses.
    pub fn is_at_flag(&self, axis: usize, phase: Phase) -> bool {
        self.axes
            .get(axis)
            .is_some_and(|watch| watch.is_at_flag(phase))
    }

    /// The watched axis that is furthest from what all have in common.
    pub fn furthest(&self, error: &PerAxis<Turns>) -> usize {
        furthest(error, self.watched())
    }

    /// Whether the platform may tilt and bend so.
    pub fn allows(&self, error: &PerAxis<Turns>) -> bool {
        self.limits.of_platform(&self.mount.modes(error)).is_none()
    }

    /// True if an axis without an encoder has a pulse.
    pub fn has_pulse_by_index(&self, index: &PerAxis<Option<IndexPulse>>) -> bool {
        let mut pulses = index.iter().enumerate();
        pulses.any(|(axis, pulse)| pulse.is_some() && self.by_index & 1 << axis != 0)
    }

    /// Axes that some sensor detects.
    pub const fn watched(&self) -> AxisSet {
        self.sensed | self.encoders()
    }

    /// Whether all updates of a tick are processed in it.
    const fn is_at_once(&self) -> bool {
        cfg!(feature = "servo") && self.at_once
    }

    /// Axes with an encoder.
    const fn encoders(&self) -> AxisSet {
        // Without servos the compiler drops all code for encoders.
        if cfg!(feature = "servo") {
            self.by_encoder
        } else {
            0
        }
    }

    /// Whether axes with an encoder are among them.
    pub const fn has_encoders(&self) -> bool {
        self.encoders() != 0
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
        self.peak = self.phase_error.map(Turns::wrapping_abs);
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

#[cfg(test)]
mod tests;
