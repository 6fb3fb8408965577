//! The phase-drift monitor. It measures the phase error of each crank, detects errors that are too large, and names the cause.
//!
//! A *phase error* is the measured minus the commanded phase of one axis. An *index pulse* comes once per turn of a crank, as it passes
//! its sensor. An *encoder*, where an axis has one, is read in every tick. The cranks stand in a circle. So their N phase errors, with the
//! trims that correct them, separate into *modes*: common (all lag alike, which is harmless), tilt about two axes, and warp, which no flat
//! platform can follow.
//!
//! `docs/detection.md` is the specification, with the proof. In short:
//!
//! - The *estimate* of a crank is the phase error that its sensors showed last. While its index pulse is late, the crank must be behind that
//!   place, so the estimate falls with the delay.
//! - *Detection* compares the modes ([`Mount`]) of the estimates with their limits ([`DriftLimits`]). So one comparison finds a crank that
//!   moved, one that stands, and one whose sensor has failed. If all cranks are late together, only their common part moves.
//! - A *name* is a function of the last events of a crank, and of what its encoder shows. It is not needed to stop the machine.
//!
//! | module | |
//! | --- | --- |
//! | `config` | what follows from the settings |
//! | `filter` | from lines to index pulses |
//! | `index` | what a pulse shows of a crank, once a turn |
//! | `counts`, `encoder` | what counts show of a motor, in every tick |
//! | `axis` | both together |
//! | `modes`, `limits` | what the cranks do to the platform, and what they may do |
//! | `names`, `steady_drift` | the motion of a crank, and its name |
//! | `evaluate`, `findings` | detection, comparison of the cranks, and reports |
//!
//! The monitor neither chooses the reaction, which its [kind](FaultKind::reaction) has, nor moves an axis.

mod alternatives;
mod angles;
mod axis;
mod config;
mod counts;
mod encoder;
mod evaluate;
mod filter;
mod findings;
mod index;
mod limits;
mod modes;
mod names;
mod pulses;
mod steady_drift;

pub use alternatives::alternatives;
pub(crate) use alternatives::may_run_away;
pub use angles::Angle;
pub use axis::ErrorFilter;
pub(crate) use config::Config;
pub use config::place_gate;
pub use filter::IndexFilter;
pub use findings::Finding;
pub use limits::DriftLimits;
pub use modes::{Knowledge, Modes, Mount};
pub use pulses::{IndexPulse, IndexPulses};

use core::hash::{Hash, Hasher};

use crate::commanded::History;
use crate::settings::Settings;
use crate::supervisor::FaultKind;
use crate::units::{AxisSet, MAX_AXES, PerAxis, Phase, Turns};
use angles::{angle, in_common, of_angle};
use axis::Axis;
use config::AxisConfig;
use findings::Findings;

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
}

/// Monitor of the phase errors of all axes.
#[derive(Clone, Debug)]
pub struct DriftMonitor {
    config: Config,
    /// True if the last call of [`Self::observe`] covered the tick before the one that is over.
    before_is_known: bool,
    /// True if phase errors, peaks or modes may have changed since the last call of [`Self::take_changed`].
    changed: bool,
    /// True while homing searches for the phases of the cranks. Until then a phase error is no fault.
    is_homing: bool,
    /// Axes by index detected in this round.
    detected: AxisSet,
    /// Axes whose index showed where they are, in the last tick.
    shown: AxisSet,
    /// Motion that the axes without an encoder had in common in the last round.
    common_jump: Angle,
    /// Turns until a pulse of an axis without an encoder can be late; negative if that is not known.
    margin: Turns,
    rounds: u32,
    /// Turns by which homing has moved the zero of all phases.
    zero: Turns,
    findings: Findings,
    phase_error: PerAxis<Turns>,
    peak: PerAxis<Turns>,
    modes: Modes,
    /// Crank that moved during homing, as its index showed, and the distance.
    moved: Option<(usize, Turns)>,
    axes: heapless::Vec<Axis, MAX_AXES>,
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
            config: Config::NONE,
            before_is_known: false,
            changed: false,
            is_homing: true,
            detected: 0,
            shown: 0,
            common_jump: Angle::ZERO,
            margin: NO_MARGIN,
            rounds: 0,
            zero: Turns::ZERO,
            findings: Findings::new(),
            phase_error: [Turns::ZERO; MAX_AXES],
            peak: [Turns::ZERO; MAX_AXES],
            modes: Modes::ZERO,
            moved: None,
            axes: heapless::Vec::new(),
        }
    }

    /// Replaces the configuration by that of checked settings, and resets the monitor.
    #[cold]
    #[inline(never)]
    pub fn configure(&mut self, settings: &Settings) {
        self.config.set(settings);
        self.axes.clear();
        for (i, axis) in settings.axes.iter().enumerate() {
            let Config { limits, mount, .. } = &self.config;
            let limit = limits.single_axis_limit(mount, i, settings.axes.len());
            let config = AxisConfig::new(axis, settings, limits.reading, limit);
            let pushed = self.axes.push(Axis::new(config, axis));
            debug_assert!(pushed.is_ok(), "settings hold no more axes than these");
        }
        self.before_is_known = false;
        self.zero = Turns::ZERO;
        self.rounds = 0;
        self.reset_peak();
        self.reset(&[Phase::ZERO; MAX_AXES]);
    }

    /// Turns by which homing has moved the zero of all phases.
    pub(crate) const fn zero(&self) -> Turns {
        self.zero
    }

    /// Configuration, which follows from the settings.
    pub(crate) const fn config(&self) -> &Config {
        &self.config
    }

    /// Hashes one of three slices of an axis's configuration. Returns false for the axis after the last.
    #[inline(always)]
    pub(crate) fn hash_axis(&self, axis: usize, slice: usize, hasher: &mut impl Hasher) -> bool {
        // Beyond their capacity there are none, even if their number is wrong.
        let axis = self.axes.get(axis).filter(|_| axis < MAX_AXES);
        axis.inspect(|axis| axis.config.hash_slice(slice, hasher))
            .is_some()
    }

    /// Hashes what no tick changes of the encoder of an axis. Returns false for the axis after the last.
    #[inline(always)]
    pub(crate) fn hash_encoder(&self, axis: usize, hasher: &mut impl Hasher) -> bool {
        let encoder = self.axes.get(axis).map(|state| &state.encoder);
        // An option of the constants would be none as well if a flipped bit makes an encoder of memory without one.
        if let Some(encoder) = encoder {
            encoder.is_some().hash(hasher);
            if let Some(encoder) = encoder {
                encoder.constants().hash(hasher);
            }
        }
        encoder.is_some() && axis < MAX_AXES
    }

    /// Skips a tick whose phase is not known. A sensor that made a pulse in it works.
    pub fn disregard(&mut self, sensed: &Sensed<'_>) {
        self.before_is_known = false;
        self.margin = NO_MARGIN;
        let recent = sensed.history.recent();
        let commands = sensed.encoder.iter().zip(sensed.lead);
        for (axis, (state, (&count, &lead))) in self.axes.iter_mut().zip(commands).enumerate() {
            let has_pulse = sensed.index.axes() & 1 << axis != 0;
            let over = recent.over(axis, sensed.phase.advanced(lead));
            state.disregard(has_pulse, count, over.start);
        }
    }

    /// Name of a single jump of an axis, by its size alone.
    pub fn name_of(&self, axis: usize, by: Turns) -> FaultKind {
        let axis = self.axes.get(axis);
        axis.map_or(FaultKind::Slip, |axis| axis.config.name_of_one(by))
    }

    /// True if every index has been detected since [`Self::reset`], and a turn has confirmed its place.
    pub fn is_homed(&self) -> bool {
        let mut axes = self.axes.iter();
        axes.all(|axis| !axis.config.has_index || axis.index.is_confirmed())
    }

    /// Rounds that are over since power-up; wraps. A round is over when each axis without an encoder has passed its index; if there is none,
    /// with each pulse.
    pub const fn rounds(&self) -> u32 {
        self.rounds
    }

    /// Discards all measurements, because cranks may have been turned while the drives were off. Homing begins.
    pub fn reset(&mut self, phase: &PerAxis<Phase>) {
        self.detected = 0;
        self.common_jump = Angle::ZERO;
        self.is_homing = true;
        self.moved = None;
        self.findings.clear();
        self.margin = NO_MARGIN;
        for (state, &phase) in self.axes.iter_mut().zip(phase) {
            state.reset(phase);
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
    pub fn errors(&self, filter: ErrorFilter) -> PerAxis<Turns> {
        let mut errors = self.phase_error;
        for (error, axis) in errors.iter_mut().zip(&self.axes) {
            *error = axis.error(filter);
        }
        errors
    }

    /// Axes whose index showed where they are, in the last tick.
    pub(crate) const fn shown(&self) -> AxisSet {
        self.shown
    }

    /// Axes with an index sensor.
    pub(crate) fn with_index(&self) -> AxisSet {
        let axes = self.axes.iter().enumerate();
        axes.fold(0, |set, (i, axis)| {
            set | AxisSet::from(axis.config.has_index) << i
        })
    }

    /// Ends homing: from now on, motion of a crank away from its command is a fault.
    pub fn settle(&mut self) {
        self.is_homing = false;
        self.axes.iter_mut().for_each(Axis::settle);
    }

    /// Moves the zero of all phases, so that every phase error falls by `by`.
    pub fn shift(&mut self, by: Turns) {
        self.zero = self.zero.wrapping_sub(by);
        for axis in &mut self.axes {
            axis.shift(-angle(by));
        }
        self.phase_error = self.errors(ErrorFilter::None);
        self.reset_peak();
    }

    /// Largest error of a reading of an axis, turns.
    pub fn tolerance(&self, axis: usize) -> Turns {
        let axis = self.axes.get(axis);
        axis.map_or(Turns::ZERO, |axis| axis.config.tolerance)
    }

    /// Largest difference of two readings of a crank whose rotor only swings, turns.
    pub fn swing(&self, axis: usize) -> Turns {
        let axis = self.axes.get(axis);
        axis.map_or(Turns::MAX, |axis| axis.config.swing())
    }

    /// Turns by which one crank alone takes the platform beyond a limit.
    pub fn single_axis_limit(&self, axis: usize) -> Turns {
        let axis = self.axes.get(axis);
        axis.map_or(Turns::MAX, |axis| axis.config.single_axis_limit)
    }

    /// Phase error of an axis's motor by its encoder, if it has one.
    pub fn motor_error(&self, axis: usize) -> Option<Turns> {
        self.axes.get(axis)?.tracking_error()
    }

    /// True if the sensor of an axis that is commanded to this phase may be at an end of its flag, so that a swinging rotor makes pulses.
    pub fn is_at_flag(&self, axis: usize, phase: Phase) -> bool {
        self.axes.get(axis).is_some_and(|axis| {
            let index = axis.config.index.wrapping_add(self.zero);
            axis.index.is_at_flag(&axis.config, index, phase)
        })
    }

    /// True if these phase errors keep the platform within its limits of tilt and warp.
    pub fn allows(&self, error: &PerAxis<Turns>) -> bool {
        self.are_within(&error.map(angle))
    }

    fn are_within(&self, error: &PerAxis<Angle>) -> bool {
        let modes = self.config.mount.modes(error);
        let exceeded = self.config.limits.of_cranks.exceeded(&modes, Turns::ZERO);
        exceeded.is_none()
    }

    /// The watched axis that is furthest from the phase error that all have in common.
    pub fn furthest(&self, error: &PerAxis<Turns>) -> usize {
        self.furthest_of(&error.map(angle))
    }

    /// Axis that is furthest from all others, and its distance, if the cranks exceed a limit of the platform as they stand.
    pub fn left_beyond_limits(&self, correction: &PerAxis<Turns>) -> Option<(usize, Turns)> {
        let errors = self.left(correction);
        if self.are_within(&errors) {
            return None;
        }
        let axis = self.furthest_of(&errors);
        // This is the common error of the others. The mean of all would contain the error of this axis itself.
        let others = self.watched() & !(1 << axis);
        let common = in_common(&errors, others);
        Some((axis, of_angle(*errors.get(axis)? - common)))
    }

    /// Axes that some sensor detects.
    pub const fn watched(&self) -> AxisSet {
        self.config.by_index | self.encoders()
    }

    /// Axes with an encoder.
    const fn encoders(&self) -> AxisSet {
        // Without servos the compiler drops all code for encoders.
        if cfg!(feature = "servo") {
            self.config.by_encoder
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

    /// Modes of the estimates with their corrections, as last computed.
    pub const fn modes(&self) -> &Modes {
        &self.modes
    }

    /// Axes without an encoder that have a pulse.
    #[inline(always)]
    pub const fn pulsed_by_index(&self, index: &IndexPulses) -> AxisSet {
        index.axes() & self.config.by_index
    }

    /// Processes the feedback of a tick that is over. Returns the next finding to report, if there is one.
    #[inline(never)]
    pub fn observe(&mut self, sensed: &Sensed<'_>) -> Option<Finding> {
        self.findings.pass(sensed.speed);
        self.margin = self.margin.wrapping_sub(sensed.history.max());
        self.shown = 0;
        let arrived = self.pulsed_by_index(sensed.index);
        if arrived != 0 || self.margin < 0 || self.encoders() != 0 {
            self.sense(sensed);
        }
        self.before_is_known = true;
        self.findings.next()
    }
}

#[cfg(test)]
mod tests;
