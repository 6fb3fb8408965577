//! From settings to a controller: first all that may be wrong with them, then what nothing can be wrong with any more.
//!
//! A controller is large, some ten kilobytes with six axes. Wherever an error could come instead of it, the stack would hold it once
//! more: so it is made when there is none any more, and where it is to stay.

use super::Controller;
use super::align::Align;
use super::channel::Channel;
use super::punctuality::Punctuality;
use super::wiring_proof::wiring_patterns;
use crate::axes::{Axis, Correction};
use crate::drift::{DriftMonitor, History};
use crate::program::{Cursor, Program};
use crate::pulse::{Paces, Planner, PulseTiming};
use crate::servo::{Coupling, FeedForward};
use crate::settings::{AxisSettings, DriveKind, Problem, Settings, SettingsError, turns};
use crate::shaft::{Motion, Shaft, ShaftLimits, Target};
use crate::signals::Output;
use crate::supervisor::Supervisor;
use crate::units::{Amax, MAX_AXES, PerAxis, Phase, Turns};

/// A mean drift that is found in align counts as lag up to this part of the common limit: one in four.
const LAG_PART: f64 = 4.0;

/// What settings come to that may be refused.
#[derive(Clone, Debug)]
pub struct Prepared {
    timing: PulseTiming,
    feed_forward: PerAxis<Option<FeedForward>>,
    /// The tilts that prove the wiring; none that is not to be proved.
    patterns: [PerAxis<Turns>; 2],
    drift: DriftMonitor,
    correction: Correction,
    coupling: Option<Coupling>,
}

impl Prepared {
    /// Checks settings.
    ///
    /// # Errors
    /// The first that is wrong.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        let tick_hz = settings.tick_hz;
        let hz = f64::from(tick_hz);
        let timing = PulseTiming::new(&settings.pulse, tick_hz)?;
        let mut feed_forward = [None; MAX_AXES];
        for (i, (axis, slot)) in settings.axes.iter().zip(&mut feed_forward).enumerate() {
            let ratio = f64::from(axis.ratio.0) / f64::from(axis.ratio.1);
            // Trim comes on top of what the gear makes.
            let speed_hz = settings.limits.speed_hz * ratio + 2.0 * axis.trim_rate_hz;
            let place = |error: SettingsError| error.on_entry(i);
            if speed_hz > 0.5 * hz {
                let problem = Problem::TooFastForTick {
                    turns_per_tick: speed_hz / hz,
                };
                return Err(place(SettingsError::new("axes.ratio", problem)));
            }
            match axis.drive {
                DriveKind::Stepper => timing.check_rate(axis, speed_hz, tick_hz).map_err(place)?,
                DriveKind::Servo => {
                    PulseTiming::check_counts(axis, speed_hz, tick_hz).map_err(place)?;
                    let acceleration =
                        settings.limits.reachable_stop_acceleration_hz_per_s() * ratio;
                    *slot = Some(FeedForward::new(
                        &settings.machine,
                        settings.axes.len(),
                        axis.rotor_inertia_kgm2,
                        tick_hz,
                        turns(speed_hz / hz),
                        turns(acceleration / hz / hz),
                    )?);
                }
            }
        }
        let drift = DriftMonitor::new(settings);
        let correction = Correction::new(settings);
        let patterns = if settings.correction.prove_wiring {
            wiring_patterns(settings.axes.len(), &drift, &correction)?
        } else {
            [[Turns::ZERO; MAX_AXES]; 2]
        };
        let measured = |axis: &AxisSettings| axis.drive == DriveKind::Servo && axis.encoder;
        let coupling = Coupling::new(settings);
        if coupling.is_some() && !settings.axes.iter().all(measured) {
            let key = "correction.coupling";
            return Err(SettingsError::new(key, Problem::CouplingBlind));
        }
        Ok(Self {
            timing,
            feed_forward,
            patterns,
            drift,
            correction,
            coupling,
        })
    }
}

impl Controller {
    /// A controller at power-up, of settings that were prepared.
    #[inline(never)] // in a frame of its own
    pub fn assembled(prepared: &Prepared, settings: &Settings, program: Program) -> Self {
        let tick_hz = settings.tick_hz;
        let hz = f64::from(tick_hz);
        let axes = settings.axes.iter().zip(&prepared.feed_forward);
        let channels: heapless::Vec<Channel, MAX_AXES> = axes
            .map(|(settings, &feed_forward)| Channel {
                axis: Axis::new(settings, tick_hz),
                planner: Planner::new(prepared.timing, settings.steps_per_turn),
                reversed: settings.reversed,
                feed_forward,
            })
            .collect();
        let phase = core::array::from_fn(|i| {
            channels
                .get(i)
                .map_or(Phase::ZERO, |channel| channel.axis.offset())
        });
        let drift = prepared.drift.clone();
        let has_datum = settings
            .axes
            .iter()
            .all(|axis| axis.ratio.0 == axis.ratio.1);
        let lag = turns(settings.drift.common_limit_deg / 360.0 / LAG_PART);
        let tolerance = core::array::from_fn(|axis| drift.tolerance(axis));
        let park = Phase::from_turns(turns(settings.park_turns)).within_turn();
        Self {
            tick_hz,
            profile: settings.profile(),
            program,
            cursor: Cursor::new(),
            target: Target::steady(Turns::ZERO),
            end: (Amax::ZERO, Turns::ZERO),
            shaft: Shaft::new(ShaftLimits::new(&settings.limits, tick_hz)),
            park_crank: park,
            park,
            has_servos: prepared.feed_forward.iter().any(Option::is_some),
            pace: Paces::new(prepared.timing.tick()),
            trimming: 0,
            own: None,
            geared: 0,
            align: Align::new(prepared.patterns, has_datum, channels.len(), lag, tolerance),
            drift,
            correction: prepared.correction.clone(),
            corrected: 0,
            turned: Turns::ZERO,
            coupling: prepared.coupling.clone(),
            untold: None,
            stop_input: false,
            driven: 0,
            supervisor: Supervisor::new(libm::ceil(settings.settle_s * hz) as u32),
            motion: Motion {
                at_rest: true,
                ..Motion::default()
            },
            ticks: 0,
            punctuality: Punctuality::default(),
            overrun: None,
            was_late: false,
            output: Output::idle(phase),
            history: History::new(),
            channels,
        }
    }
}
