//! The phase-drift monitor. It measures the phase error of each crank, detects errors that are too large, and names the cause.
//!
//! A *phase error* is the measured minus the commanded phase of one axis. An *index pulse* comes once per turn of a crank, as it passes
//! its sensor. An *encoder*, where an axis has one, is read in every tick. The cranks stand in a circle. So their N phase errors, with the
//! trims that correct them, separate into *modes*: common (all lag alike, which is harmless), tilt about two axes, and warp, which no flat
//! platform can follow.
//!
//! - [`sensing`] turns lines and counts into phase errors. On an axis with both sensors, the index shows the difference between encoder and
//!   crank.
//! - `detection` compares the modes ([`Mount`]) with their limits ([`DriftLimits`]). It needs no name.
//! - `diagnosis` names the motion of a crank, and the other causes that look the same ([`alternatives`]).
//! - `axis_watch` holds the state of one axis, and `process` and `queue` spread the work over ticks.
//!
//! A *round* is over when every axis without an encoder has been detected since the round before. So phase errors of the same turn are
//! compared with each other. The motion that all cranks have in common is subtracted before one of them is named.
//!
//! The monitor neither chooses the reaction, which [`mod@crate::supervisor::reaction`] does, nor moves an axis.

mod axis_watch;
mod configure;
mod detection;
mod diagnosis;
mod process;
mod queue;
pub mod sensing;

pub use axis_watch::{Measured, place_gate};
pub use detection::limits::DriftLimits;
pub use detection::modes::{AxisSet, Knowledge, Modes, Mount};
pub use diagnosis::alternatives::alternatives;
pub(crate) use diagnosis::alternatives::may_run_away;
pub(crate) use diagnosis::events::is_better;
pub use diagnosis::findings::Finding;
pub use sensing::history::{History, TickTurns};
pub use sensing::index_filter::IndexFilter;
pub use sensing::tick_phase::{IndexPulse, IndexPulses, TickPhase};

use core::hash::{Hash, Hasher};

use crate::supervisor::FaultKind;
use crate::units::{MAX_AXES, PerAxis, Phase, Turns};
use axis_watch::AxisWatch;
use diagnosis::findings::Findings;
use queue::Queue;
use sensing::tick_phase::TickClock;

/// Feedback of a tick, and the commands of that tick.
#[derive(Clone, Copy, Debug)]
pub struct Sensed<'a> {
    /// Index pulses.
    pub index: &'a IndexPulses,
    /// Encoder counts at the end of the tick, in the motors' own sense.
    pub encoder: &'a PerAxis<i32>,
    /// Phase of the master at the end of the tick that was planned last.
    pub phase: Phase,
    /// Commanded phases at that time, less the master's.
    pub lead: &'a PerAxis<Turns>,
    /// Turns that were commanded up to that time.
    pub history: &'a History,
    /// Corrections that these phases contain.
    pub correction: &'a PerAxis<Turns>,
    /// Turns of the master in the tick.
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

/// Monitor of the phase errors of all axes.
#[derive(Clone, Debug)]
#[repr(C)] // The fields that every tick needs come first: the board's instructions reach 32 bytes, or 128 by words.
pub struct DriftMonitor {
    /// True if the last call of [`Self::observe`] covered the tick before the one that is over.
    before_is_known: bool,
    is_busy: bool,
    /// True if phase errors, peaks or modes may have changed since the last call of [`Self::take_changed`].
    changed: bool,
    /// Axes that have an index sensor and no encoder, and axes that have an encoder.
    by_index: AxisSet,
    by_encoder: AxisSet,
    /// True if all updates of a tick are processed in that tick.
    at_once: bool,
    /// True while homing searches for the phases of the cranks. Until then a phase error is no fault.
    is_homing: bool,
    /// Axes by index detected in this round.
    detected: AxisSet,
    /// Axes whose index has not been detected since [`Self::start_check`].
    unchecked: AxisSet,
    /// Motion that the axes without an encoder had in common in the last round.
    common_jump: Turns,
    queue: Queue,
    /// Turns until the next pulse of an axis without an encoder can be due; negative if that is not known.
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
    /// Crank that moved during homing, as its index showed, and the distance.
    moved: Option<(usize, Turns)>,
    axes: heapless::Vec<AxisWatch, MAX_AXES>,
}

/// The margin is not known.
const NO_MARGIN: Turns = Turns::from_bits(-1);

impl DriftMonitor {
    /// Skips a tick whose phase is not known. A sensor that made a pulse in it works.
    pub fn disregard(&mut self, sensed: &Sensed<'_>) {
        self.before_is_known = false;
        self.margin = NO_MARGIN;
        let axes = self.axes.iter_mut().zip(sensed.encoder);
        for (axis, (watch, &count)) in axes.enumerate() {
            let has_pulse = sensed.index.axes() & 1 << axis != 0;
            watch.disregard(has_pulse, count, sensed.over(axis).start);
        }
    }

    /// Name of a single jump of an axis, by its size alone.
    pub fn name_of(&self, axis: usize, by: Turns) -> FaultKind {
        let watch = self.axes.get(axis);
        watch.map_or(FaultKind::Slip, |watch| watch.traits.name_of_one(by))
    }

    /// True if every index has been detected since [`Self::reset`], and a turn has confirmed its place. The last detection has been
    /// evaluated if the monitor is not busy.
    pub fn is_homed(&self) -> bool {
        let mut axes = self.axes.iter();
        axes.all(|watch| !watch.traits.has_index || watch.index.is_confirmed())
    }

    /// True if the last tick had work pending, of axes without an encoder.
    pub const fn is_busy(&self) -> bool {
        self.is_busy
    }

    /// Rounds that are over since power-up; wraps.
    pub const fn rounds(&self) -> u32 {
        self.rounds
    }

    /// Discards all measurements, because cranks may have been turned while the drives were off. Homing begins.
    pub fn reset(&mut self, phase: &PerAxis<Phase>) {
        self.detected = 0;
        self.common_jump = Turns::ZERO;
        self.is_homing = true;
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

    /// Phase error of each axis, turns, −½ to ½, as measured at this time.
    #[inline(never)]
    pub fn errors(&self, measured: Measured) -> PerAxis<Turns> {
        let mut errors = self.phase_error;
        for (error, watch) in errors.iter_mut().zip(&self.axes) {
            *error = watch.error(measured);
        }
        errors
    }

    /// True if errors that are measured [over a turn](Measured::OverTurn) cover a whole turn since [`Self::reset`] or [`Self::start_check`].
    pub fn is_turn_over(&self) -> bool {
        !self.has_encoders() || self.averaged >= Turns::ONE
    }

    /// Updates the phase error of an axis.
    fn update(&mut self, axis: usize) {
        let slots = self.phase_error.get_mut(axis).zip(self.peak.get_mut(axis));
        if let (Some(watch), Some((phase_error, peak))) = (self.axes.get(axis), slots) {
            *phase_error = watch.phase_error();
            *peak = phase_error.wrapping_abs().max(*peak);
            self.changed = true;
        }
    }

    /// Starts a check: every index must be detected again, and encoders are averaged over a new turn.
    pub fn start_check(&mut self) {
        self.unchecked = 0;
        self.averaged = Turns::ZERO;
        for (axis, watch) in self.axes.iter_mut().enumerate() {
            self.unchecked |= AxisSet::from(watch.traits.has_index) << axis;
            if let Some(encoder) = &mut watch.encoder {
                encoder.mean = Turns::ZERO;
            }
        }
    }

    /// True if every index has been detected since [`Self::start_check`], and encoders have been read over a turn.
    pub fn is_check_done(&self) -> bool {
        self.unchecked == 0 && self.is_turn_over()
    }

    /// Ends homing: from now on, motion of a crank away from its command is a fault.
    pub fn settle(&mut self) {
        self.is_homing = false;
        for watch in &mut self.axes {
            watch.settle();
        }
    }

    /// Moves the zero of all phases, so that every phase error falls by `by`.
    pub fn shift(&mut self, by: Turns) {
        for watch in &mut self.axes {
            watch.shift(by.wrapping_neg());
        }
        self.phase_error = self.errors(Measured::Now);
        self.reset_peak();
    }

    /// Hashes what no tick changes of all axes.
    #[inline(always)]
    pub(crate) fn hash_common(&self, hasher: &mut impl Hasher) {
        let Self {
            before_is_known: _,
            is_busy: _,
            changed: _,
            by_index,
            by_encoder,
            at_once,
            is_homing: _,
            detected: _,
            unchecked: _,
            common_jump: _,
            queue: _,
            margin: _,
            rounds: _,
            averaged: _,
            clock,
            findings: _,
            phase_error: _,
            peak: _,
            modes: _,
            limits: _,
            mount,
            moved: _,
            axes,
        } = self;
        (by_index, by_encoder, at_once).hash(hasher);
        (mount.detected(), clock, axes.len()).hash(hasher);
    }

    /// Weights of the axes in the modes.
    pub(crate) const fn mount(&self) -> &Mount {
        &self.mount
    }

    /// Limits on the modes.
    pub(crate) const fn limits(&self) -> &DriftLimits {
        &self.limits
    }

    /// Hashes one of four slices of what no tick changes of an axis. Returns false for the axis after the last.
    #[inline(always)]
    pub(crate) fn hash_axis(
        &self,
        axis: usize,
        slice: usize,
        home_offset: Turns,
        hasher: &mut impl Hasher,
    ) -> bool {
        // Beyond their capacity there are none, even if their number is wrong.
        match self.axes.get(axis) {
            Some(watch) if axis < MAX_AXES => {
                watch.hash_slice(slice, home_offset, hasher);
                true
            }
            _ => false,
        }
    }

    /// Largest error of a reading of an axis, turns.
    pub fn tolerance(&self, axis: usize) -> Turns {
        let watch = self.axes.get(axis);
        watch.map_or(Turns::ZERO, |watch| watch.traits.tolerance)
    }

    /// Largest difference of two readings of a crank whose rotor only swings, turns.
    pub fn swing(&self, axis: usize) -> Turns {
        let watch = self.axes.get(axis);
        watch.map_or(Turns::MAX, |watch| watch.traits.swing())
    }

    /// Turns by which one crank alone takes the platform beyond a limit.
    pub fn alone(&self, axis: usize) -> Turns {
        let watch = self.axes.get(axis);
        watch.map_or(Turns::MAX, |watch| watch.traits.alone)
    }

    /// Phase error of an axis's motor by its encoder, if it has one.
    pub fn motor_error(&self, axis: usize) -> Option<Turns> {
        self.axes.get(axis)?.tracking_error()
    }

    /// True if the sensor of an axis that is commanded to this phase may be at an end of its flag, so that a swinging rotor makes pulses.
    pub fn is_at_flag(&self, axis: usize, phase: Phase) -> bool {
        let watch = self.axes.get(axis);
        watch.is_some_and(|watch| watch.index.is_at_flag(&watch.traits, phase))
    }

    /// True if these phase errors keep the platform within its limits of tilt and warp.
    pub fn allows(&self, error: &PerAxis<Turns>) -> bool {
        let modes = self.mount.modes(error);
        let exceeded = self.limits.of_cranks.exceeded(&modes, Turns::ZERO);
        exceeded.is_none()
    }

    /// Axes that some sensor detects.
    pub const fn watched(&self) -> AxisSet {
        self.by_index | self.encoders()
    }

    /// True if all updates of a tick are processed in that tick.
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

    /// True if an axis has an encoder.
    pub const fn has_encoders(&self) -> bool {
        self.encoders() != 0
    }

    /// Phase error of each axis, as last measured: turns, −½ to ½.
    pub const fn phase_error(&self) -> &PerAxis<Turns> {
        &self.phase_error
    }

    /// Largest phase error of each axis so far, without sign.
    pub const fn peak(&self) -> &PerAxis<Turns> {
        &self.peak
    }

    /// Forgets the largest phase errors.
    pub fn reset_peak(&mut self) {
        self.peak = self.phase_error.map(Turns::wrapping_abs);
        self.changed = true;
    }

    /// True if phase errors, their peaks or their modes may have changed since the last call.
    pub const fn take_changed(&mut self) -> bool {
        core::mem::replace(&mut self.changed, false)
    }

    /// Modes of the phase errors with their corrections, as last computed.
    pub const fn modes(&self) -> &Modes {
        &self.modes
    }
}

#[cfg(test)]
mod tests;
