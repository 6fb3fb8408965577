//! Configuration of a controller from settings, part by part and in place.
//!
//! A controller takes some ten kilobytes. The stack of a microcontroller does not hold that beside the decoder of its settings. So one
//! controller exists from the beginning, without axes, and the settings fill it.

use super::channel::Channel;
use super::checksum::SettingsCheck;
use super::homing::{Homing, HomingConfig};
use super::wiring_proof::wiring_patterns;
use super::{Controller, LoopState};
use crate::axes::{Bounds, Follower, NO_CAMS};
use crate::mechanism::AnyMechanism;
use crate::monitor::DriftMonitor;
use crate::phase_offset::PhaseOffsets;
use crate::problem::{Problem, SettingsError};
use crate::program::{AmplitudeOverride, Program};
use crate::pulse::{Planner, PulseTiming, StepRates};
use crate::servo::{Coupling, FeedForward, servo_part};
use crate::settings::{AxisSettings, Settings, turns};
use crate::shaft::{Shaft, ShaftLimits};
use crate::signals::Output;
use crate::supervisor::{JOG_S, Supervisor};
use crate::units::{AxisSet, MAX_AXES, PerAxis, Phase, Turns};

/// Reciprocal of the part of the common limit up to which a mean phase error in homing counts as lag: one fourth.
const LAG_PART: f64 = 4.0;

impl Settings {
    /// Creates a controller from settings, as at power-up: idle, every axis at its offset, trims set.
    ///
    /// # Errors
    /// The first setting, program entry or trim that is wrong.
    pub fn controller(&self) -> Result<Controller, SettingsError> {
        let mut controller = Controller::new();
        controller.configure(self)?;
        Ok(controller)
    }
}

impl Controller {
    /// Creates a controller without axes. It stays at rest until it is configured.
    pub const fn new() -> Self {
        Self {
            state: LoopState::new(),
            tick_hz: 2000,
            mechanism: AnyMechanism::STANDSTILL,
            program: Program::new(),
            shaft: Shaft::new(ShaftLimits::STANDSTILL),
            park_crank: Turns::ZERO,
            channels: heapless::Vec::new(),
            has_servos: false,
            step_rate: StepRates::new(62_500),
            followers: 0,
            cams: NO_CAMS,
            monitor: DriftMonitor::new(),
            homing: Homing::new(HomingConfig::NONE),
            offsets: PhaseOffsets::new(),
            coupling: None,
            amplitude: AmplitudeOverride::new(2000),
            supervisor: Supervisor::new(0, 0, false),
            output: Output::idle([Turns::ZERO; MAX_AXES]),
            check: SettingsCheck::new(),
        }
    }

    /// Takes over the settings of a machine. The controller is then as at power-up.
    ///
    /// # Errors
    /// The first setting, program entry or trim that is wrong. The controller has no axes then.
    #[cold]
    #[inline(never)]
    pub fn configure(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        self.channels.clear();
        let configured = self.fill_in(settings);
        if configured.is_err() {
            self.channels.clear();
        }
        self.begin_check();
        configured
    }

    #[cold]
    fn fill_in(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        // This check comes first: the steps below rely on numbers within their ranges.
        settings.check()?;
        self.state = LoopState::new();
        settings.fill_program(&mut self.program)?;
        settings.fill_curves(&mut self.cams);
        self.fill_channels(settings)?;
        self.monitor.configure(settings);
        self.offsets.configure(settings);
        self.fill_homing(settings)?;
        self.coupling = servo_part(coupling(settings)?);
        self.tick_hz = settings.tick_hz;
        self.mechanism = settings.mechanism();
        self.shaft = Shaft::new(ShaftLimits::from_settings(
            &settings.limits,
            settings.tick_hz,
        ));
        self.park_crank = Phase::from_turns(turns(settings.park_turns)).within_turn();
        let settle_ticks = libm::ceil(settings.settle_s * f64::from(settings.tick_hz));
        let jog_ticks = libm::ceil(JOG_S * f64::from(settings.tick_hz));
        self.supervisor =
            Supervisor::new(settle_ticks as u32, jog_ticks as u32, settings.has_brake);
        self.amplitude = AmplitudeOverride::new(settings.tick_hz);
        self.fill_trims(settings);
        Ok(())
    }

    #[cold]
    fn fill_channels(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        let tick_hz = settings.tick_hz;
        let timing = PulseTiming::new(&settings.pulse, settings.clock_hz, tick_hz)?;
        let mut leads = [Turns::ZERO; MAX_AXES];
        for (i, (axis, lead)) in settings.axes.iter().zip(&mut leads).enumerate() {
            let follower = axis.follower.follower(&self.cams);
            if axis.index_turns.is_some() && !follower.allows_index(&self.cams) {
                return Err(SettingsError::new("axes.index", Problem::IndexOnCam).on_entry(i));
            }
            let bounds = follower.bounds(&settings.master_bounds(), &self.cams);
            let is_servo = !axis.drive.takes_pulses() || axis.encoder;
            if is_servo && !cfg!(feature = "servo") {
                return Err(SettingsError::new("axes.drive", Problem::ServoNotBuilt).on_entry(i));
            }
            let feed_forward =
                feed_forward(settings, axis, &bounds, timing).map_err(|e| e.on_entry(i))?;
            *lead = turns(axis.offset_turns).wrapping_add(follower.start());
            let channel = Channel {
                follower,
                planner: Planner::new(timing, axis.steps_per_crank_turn()),
                reversed: axis.reversed,
                feed_forward: servo_part(feed_forward),
            };
            let pushed = self.channels.push(channel);
            debug_assert!(pushed.is_ok(), "settings hold no more axes than these");
        }
        self.has_servos = self.channels.iter().any(|c| c.feed_forward.is_some());
        self.step_rate = StepRates::new(timing.tick());
        let channels = self.channels.iter().enumerate();
        self.followers = channels.fold(0, |followers, (axis, channel)| {
            followers | AxisSet::from(!channel.follower.is_direct()) << axis
        });
        self.output.reset(leads);
        self.group_axes();
        Ok(())
    }

    #[cold]
    fn fill_homing(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        let patterns = if settings.correction.prove_wiring {
            wiring_patterns(settings, &self.monitor, &self.offsets)?
        } else {
            [PerAxis::default(); 2]
        };
        self.homing = Homing::new(HomingConfig {
            patterns,
            has_home_offset: self.followers == 0,
            count: settings.axes.len(),
            lag: turns(settings.drift.common_limit_deg / 360.0 / LAG_PART),
            tolerance: core::array::from_fn(|axis| self.monitor.tolerance(axis)),
        });
        Ok(())
    }

    #[cold]
    fn fill_trims(&mut self, settings: &Settings) {
        for (i, &trim_turns) in settings.trims_turns.iter().enumerate() {
            // At exactly the limit, which is rounded down, a trim may lose the last of its 48 fraction bits.
            let _whole = self.set_trim(i, turns(trim_turns));
        }
    }
}

impl Default for Controller {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the feed-forward of an axis, if it is a servo. Checks that its steps or counts can be made at full speed.
#[cold]
fn feed_forward(
    settings: &Settings,
    axis: &AxisSettings,
    bounds: &Bounds,
    timing: PulseTiming,
) -> Result<Option<FeedForward>, SettingsError> {
    let tick_hz = settings.tick_hz;
    let hz = f64::from(tick_hz);
    // In its slot, a phase offset moves up to the number of axes times as fast as its rate.
    let offset_hz = axis.trim_rate_hz * settings.axes.len() as f64;
    let speed_hz = bounds.speed + offset_hz;
    let (counts, motor_hz) = (axis.steps_per_turn, axis.gear.ratio() * speed_hz);
    let checked = match axis.drive {
        _ if speed_hz > 0.5 * hz => {
            let turns_per_tick = speed_hz / hz;
            let problem = Problem::TooFastForTick { turns_per_tick };
            Err(SettingsError::new("axes.ratio", problem))
        }
        kind if kind.takes_pulses() => timing
            .check_rate(counts, motor_hz, tick_hz)
            .map_err(SettingsError::from),
        _ => PulseTiming::check_counts(counts, motor_hz, tick_hz).map_err(SettingsError::from),
    };
    let master_hz = settings.limits.speed_hz;
    checked.map_err(|error| axis.follower.too_fast(error, master_hz, speed_hz))?;
    if axis.drive.takes_pulses() {
        return Ok(None);
    }
    FeedForward::new(
        &settings.machine,
        settings.axes.len(),
        axis.rotor_inertia_kgm2,
        axis.gear,
        tick_hz,
        turns(speed_hz / hz),
        turns(bounds.acceleration / hz / hz),
    )
    .map(Some)
}

/// Returns the cross-coupling of servos, if the settings request it. Every axis must then be a servo with an encoder.
#[cold]
fn coupling(settings: &Settings) -> Result<Option<Coupling>, SettingsError> {
    let measured = |axis: &AxisSettings| !axis.drive.takes_pulses() && axis.encoder;
    let coupling = Coupling::new(settings);
    if coupling.is_some() && !settings.axes.iter().all(measured) {
        let key = "correction.coupling";
        return Err(SettingsError::new(key, Problem::CouplingBlind));
    }
    Ok(coupling)
}
