//! Results of a run: `report.json` for programs, and a summary for people.

mod causes;
mod controller;
mod ending;
mod lists;
mod marks;
mod model;
mod motors;
mod operating_range;
mod phrases;
mod questions;
mod remedy;
mod standstill;
mod summary;
mod warnings;

pub use controller::{Frames, recorded_summary};
pub use marks::mark;
pub use operating_range::draw_operating_range;
pub use phrases::{describe, fault_words, notable, refused_words};
pub use remedy::remedy;
pub use summary::{coupling, summary};
pub use warnings::warnings;

use cophase_core::settings::{AxisSettings, Settings};
use cophase_core::supervisor::State;
use cophase_link::message::Identity;
use cophase_scene::Scene;
use host_sim::checked::Checked;
use host_sim::machines::follower::Peaks;
use host_sim::sim::Outcome;
use host_sim::sim::events::{EventKind, StoppedBy};
use host_sim::sim::record::{AxisRecord, Figures, RunRecord, TimeInState, rounded};
use serde::Serialize;

use crate::record::{Gaps, Recorded};
use crate::trace::TraceInfo;
use crate::trace::trace_info::WrittenBy;
use controller::{ControllerReport, recording_warnings};
use lists::{
    CorrectionReport, EventReport, FaultReport, InjectedReport, correction_report, event_report,
    faults_in, injected_report,
};
use model::{FidelityReport, MethodReport};
use motors::MotorFigures;

/// Content of `report.json`, of a simulated run or of a recording. It has the [record](RunRecord) of the run between what it was a run of and
/// what was written. `None` and empty lists have no keys.
///
/// Every run of a scene gives the same content, except for `speed`.
#[derive(Clone, Debug, Serialize)]
pub struct Report<'a> {
    name: &'a str,
    #[serde(flatten)]
    written_by: WrittenBy,
    #[serde(flatten)]
    source: Source<'a>,
    ended: Ended,
    /// Gains of the cross-coupling, if the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    coupling: Option<CouplingReport>,
    warnings: Vec<String>,
    #[serde(flatten)]
    duration: Duration,
    control_ticks: u64,
    time_in_state_s: TimeInState,
    axes: Vec<AxisReport<'a>>,
    /// Cam tables, in the order of the scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cam_tables: Vec<CamTableReport<'a>>,
    #[serde(flatten)]
    figures: &'a Figures,
    /// Injected faults, in the order in which they began.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    injected: Vec<InjectedReport>,
    /// Corrections of phase errors in the run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    corrections: Vec<CorrectionReport>,
    /// Faults that the loop reported, whatever its reaction.
    reported_faults: Vec<FaultReport>,
    faults: Vec<FaultReport>,
    events: Vec<EventReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    events_left_out: Option<usize>,
    #[serde(flatten)]
    stream: Option<StreamReport<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    written: Option<TraceInfo>,
    #[serde(flatten)]
    simulation: Option<SimulationReport<'a>>,
}

/// Origin of the run: a scene, or a controller.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
enum Source<'a> {
    Scene {
        fidelity: FidelityReport<'a>,
        method: MethodReport,
    },
    Controller {
        controller: ControllerReport<'a>,
    },
}

#[derive(Clone, Copy, Debug, Serialize)]
#[serde(untagged)]
enum Duration {
    Simulated {
        simulated_s: f64,
    },
    /// Time from the first sample to the end of the last one, gaps included.
    Recorded {
        recorded_s: f64,
    },
}

#[derive(Clone, Copy, Debug, Serialize)]
struct StreamReport<'a> {
    samples: &'a Gaps,
    frames: Frames,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct SimulationReport<'a> {
    scene: &'a Scene,
    /// Speed of the run, the only part that differs from run to run.
    speed: Speed,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Ended {
    /// Last state; none in a recording without samples.
    state: Option<&'static str>,
    fault: bool,
    #[serde(flatten)]
    simulated: Option<EndOfSimulation>,
    /// Cause of the last stop.
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped_by: Option<StoppedBy>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct EndOfSimulation {
    /// State of the drives at the end: `held`, `off`, or `on` in a run that ended before it stopped.
    drives: &'static str,
    /// True if the simulated machine's equations diverged.
    diverged: bool,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct CouplingReport {
    proportional: f64,
    per_s: f64,
}

/// Record of an axis, and what is known of it without a run.
#[derive(Clone, Debug, Serialize)]
struct AxisReport<'a> {
    #[serde(flatten)]
    record: &'a AxisRecord,
    /// Figures by which its motor is chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    motor: Option<MotorFigures>,
    #[serde(flatten)]
    follower: Option<Peaks>,
    /// Upper bounds on the motion of an axis that follows a cam table, at the limits of the master.
    #[serde(flatten)]
    bounds: Option<BoundsReport>,
}

#[derive(Clone, Debug, Serialize)]
struct CamTableReport<'a> {
    name: &'a str,
    /// Number of points of its curve.
    points: usize,
    /// Largest difference of the curve's acceleration from its law's, relative to the law's peak, if it has a law.
    #[serde(skip_serializing_if = "Option::is_none")]
    off_law_accel: Option<f64>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct BoundsReport {
    speed_bound_hz: f64,
    acceleration_bound_hz_per_s: f64,
    jerk_bound_hz_per_s2: f64,
}

impl BoundsReport {
    fn new(settings: &Settings, axis: &AxisSettings) -> Option<Self> {
        let is_cam = axis.follower.constant_ratio().is_none();
        is_cam.then(|| {
            let bounds = settings.axis_bounds(axis);
            Self {
                speed_bound_hz: bounds.speed,
                acceleration_bound_hz_per_s: bounds.acceleration,
                jerk_bound_hz_per_s2: bounds.jerk,
            }
        })
    }
}

/// Speed of a run.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Speed {
    /// Wall-clock time, s.
    pub wall_s: f64,
    /// Simulated seconds per second of wall-clock time.
    pub times_real_time: f64,
}

impl<'a> Report<'a> {
    /// Creates the report of a run that took `wall_s`.
    pub fn new(
        checked: &'a Checked,
        outcome: &'a Outcome,
        written: Option<TraceInfo>,
        wall_s: f64,
    ) -> Self {
        let record = &outcome.record;
        let simulated_s = outcome.simulated_s();
        let source = Source::Scene {
            fidelity: FidelityReport::new(checked),
            method: MethodReport::new(checked, outcome),
        };
        let ended = Ended {
            state: Some(outcome.state.name()),
            fault: outcome.fault.is_some(),
            simulated: Some(EndOfSimulation {
                drives: match outcome.state {
                    State::Parked => "held",
                    State::Fault if record.is_held => "held",
                    State::Fault | State::Idle => "off",
                    State::Homing | State::Run | State::Stop => "on",
                },
                diverged: outcome.diverged.is_some(),
            }),
            stopped_by: record.stopped_by,
        };
        let duration = Duration::Simulated { simulated_s };
        let settings = &checked.settings;
        let mut report = Self::of_record(
            &checked.scene.name,
            source,
            ended,
            duration,
            record,
            &settings.axes,
        );
        report.coupling = coupling(checked).map(|_| CouplingReport {
            proportional: settings.correction.coupling,
            per_s: settings.correction.coupling_per_s,
        });
        report.warnings = warnings(checked, outcome);
        let motors = MotorFigures::of_all(checked);
        for (i, (axis, motor)) in report.axes.iter_mut().zip(motors).enumerate() {
            axis.motor = Some(motor);
            axis.bounds = BoundsReport::new(settings, &settings.axes[i]);
        }
        report.cam_tables = checked
            .cam_tables()
            .map(|(table, points, off_law_accel)| CamTableReport {
                name: &table.name,
                points,
                off_law_accel,
            })
            .collect();
        report.events_left_out = Some(record.events_left_out);
        report.written = written;
        report.simulation = Some(SimulationReport {
            scene: &checked.scene,
            speed: Speed {
                wall_s,
                times_real_time: simulated_s / wall_s.max(1e-9),
            },
        });
        report
    }

    /// Creates the report of a recording of a controller with these axes, with the counters of its loop, the frames of the line, and the
    /// reason if the line was lost.
    pub fn of_recording(
        identity: &'a Identity,
        axes: &[AxisSettings],
        recorded: &'a Recorded,
        frames: Frames,
        lost_line: Option<&str>,
    ) -> Self {
        let record = &recorded.record;
        let recorded_s = record.control_ticks as f64 / f64::from(identity.tick_hz);
        let source = Source::Controller {
            controller: ControllerReport::new(identity),
        };
        let ended = Ended {
            state: recorded.state().map(State::name),
            fault: recorded.has_fault(),
            simulated: None,
            stopped_by: record.stopped_by,
        };
        let duration = Duration::Recorded {
            recorded_s: rounded(recorded_s, 9),
        };
        let mut report = Self::of_record(&identity.settings, source, ended, duration, record, axes);
        report.warnings = recording_warnings(recorded, lost_line);
        report.stream = Some(StreamReport {
            samples: &recorded.gaps,
            frames,
        });
        report.written = Some(recorded.written);
        report
    }

    /// Creates the report of a record of these axes, with what simulated runs and recordings both have.
    fn of_record(
        name: &'a str,
        source: Source<'a>,
        ended: Ended,
        duration: Duration,
        record: &'a RunRecord,
        axes: &[AxisSettings],
    ) -> Self {
        let axis = |record: &'a AxisRecord| AxisReport {
            record,
            motor: None,
            follower: record.follower,
            bounds: None,
        };
        let events = &record.events;
        let corrections = events.iter();
        let corrections = corrections.filter_map(|event| correction_report(event, axes.len()));
        Self {
            name,
            written_by: WrittenBy::this(),
            source,
            ended,
            coupling: None,
            warnings: Vec::new(),
            duration,
            control_ticks: record.control_ticks,
            time_in_state_s: record.time_in_state_s,
            axes: record.axes.iter().map(axis).collect(),
            cam_tables: Vec::new(),
            figures: &record.figures,
            injected: events.iter().filter_map(injected_report).collect(),
            corrections: corrections.collect(),
            reported_faults: faults_in(events, axes, |what| match what {
                EventKind::Reported(fault) => Some(fault),
                _ => None,
            }),
            faults: faults_in(events, axes, |what| match what {
                EventKind::Fault { fault, .. } => Some(fault),
                _ => None,
            }),
            events: events.iter().map(event_report).collect(),
            events_left_out: None,
            stream: None,
            written: None,
            simulation: None,
        }
    }
}
