//! Results of a run: `report.json` for programs, and a summary for people.

mod causes;
mod ending;
mod lists;
mod model;
mod motors;
mod operating_range;
mod questions;
mod recorded;
mod remedy;
mod standing;
mod summary;
mod warnings;
mod words;

pub use operating_range::draw_operating_range;
pub use recorded::{Frames, RecordedReport, recorded_summary};
pub use remedy::remedy;
pub use summary::{coupling, summary};
pub use warnings::warnings;
pub use words::{describe, fault_words, notable, refused_words};

use std::collections::BTreeMap;

use cophase_core::settings::{AxisSettings, Settings};
use cophase_core::supervisor::State;
use cophase_scene::Scene;
use host_sim::checked::Checked;
use host_sim::dynamics::plant::Figure;
use host_sim::sim::Outcome;
use host_sim::sim::events::{EventKind, StoppedBy};
use serde::Serialize;

use crate::trace::Written;
use crate::trace::written::WrittenBy;
use lists::{
    CorrectionReport, EventReport, FaultReport, InjectedReport, correction_report, event_report,
    faults_in, injected_report,
};
use model::{FidelityReport, MethodReport};
use motors::MotorFigures;

/// Content of `report.json`.
///
/// Every run of a scene gives the same content, except for `speed`.
#[derive(Clone, Debug, Serialize)]
pub struct Report<'a> {
    name: &'a str,
    #[serde(flatten)]
    written_by: WrittenBy,
    fidelity: FidelityReport<'a>,
    method: MethodReport,
    ended: Ended,
    /// Gains of the cross-coupling, if the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    coupling: Option<CouplingReport>,
    warnings: Vec<String>,
    simulated_s: f64,
    control_ticks: u64,
    time_in_state_s: TimeInState,
    axes: Vec<AxisReport>,
    /// Cam tables, in the order of the scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cam_tables: Vec<CamTableReport<'a>>,
    phase_spread_worst_deg: f64,
    phase_spread_rms_deg: f64,
    /// Largest tilt of a platform, and its limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_worst_mrad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_limit_mrad: Option<f64>,
    /// Tilt at the end of a fault stop after which the drives held; and the largest tilt after that.
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_at_stop_mrad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_worst_held_mrad: Option<f64>,
    /// Largest tilt after the drives were switched off.
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_worst_off_mrad: Option<f64>,
    /// Time for which cranks continued to turn after that, s, on model levels where torque moves them.
    #[serde(skip_serializing_if = "Option::is_none")]
    coasted_s: Option<f64>,
    warp_worst_deg: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<FrameReport>,
    holding: HoldingReport,
    speed_top_hz: f64,
    amax_top_mps2: f64,
    /// Largest acceleration of the platform, on model levels where torque moves the cranks.
    #[serde(skip_serializing_if = "Option::is_none")]
    accel_worst_mps2: Option<f64>,
    /// Figures of a machine of another kind.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    machine_figures: BTreeMap<&'static str, Option<f64>>,
    late_deadlines: u32,
    missed_deadlines: u32,
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
    events_left_out: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    written: Option<Written>,
    scene: &'a Scene,
    /// Speed of the run, the only part that differs from run to run.
    speed: Speed,
}

#[derive(Clone, Debug, Serialize)]
struct Ended {
    state: &'static str,
    fault: bool,
    /// State of the drives at the end: `held`, `off`, or `on` in a run that ended before it stopped.
    drives: &'static str,
    /// True if the simulated machine's equations diverged.
    diverged: bool,
    /// Cause of the last stop.
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped_by: Option<&'static str>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct CouplingReport {
    proportional: f64,
    per_s: f64,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct TimeInState {
    idle: f64,
    homing: f64,
    run: f64,
    stop: f64,
    parked: f64,
    fault: f64,
}

#[derive(Clone, Debug, Serialize)]
struct AxisReport {
    steps: i64,
    command_turns: f64,
    actual_turns: f64,
    slipped_cycles: i64,
    /// Largest measured phase error since power-up or the last `reset-peak`, without sign.
    phase_error_peak_deg: f64,
    /// Correction of the phase error at the end.
    correction_deg: f64,
    /// Largest ratio of required torque to pull-out torque.
    #[serde(skip_serializing_if = "Option::is_none")]
    pull_out_used: Option<f64>,
    /// Largest torque of the motor.
    #[serde(skip_serializing_if = "Option::is_none")]
    torque_worst_nm: Option<f64>,
    /// Figures by which its motor is chosen.
    motor: MotorFigures,
    /// Results of the follower of its cam.
    #[serde(flatten)]
    follower: Option<FollowerReport>,
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

#[derive(Clone, Debug, Serialize)]
struct FrameReport {
    /// Static deflection under the frame and its load, from which displacements are counted.
    sag_um: f64,
    /// Largest displacement of a point on the mount circle from rest.
    displacement_worst_um: f64,
    /// Largest force on the ground, beyond the weight at rest.
    ground_force_worst_n: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct FollowerReport {
    /// Largest deviation of the pusher from its law.
    off_law_worst_mm: f64,
    pusher_accel_worst_mps2: f64,
    cam_side_accel_worst_mps2: f64,
    /// Largest deviation of the pusher's acceleration from that of its law.
    off_law_accel_worst_mps2: f64,
}

#[derive(Clone, Debug, Serialize)]
struct HoldingReport {
    held_s: f64,
    worst_relative_error: f64,
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
        outcome: &Outcome,
        written: Option<Written>,
        wall_s: f64,
    ) -> Self {
        let statistics = &outcome.statistics;
        let axes = &checked.settings.axes;
        let [idle, homing, run, stop, parked, fault] =
            statistics.time_in_state_s.map(|s| round(s, 6));
        let of_platform =
            |tilt_mrad: Option<f64>| tilt_mrad.filter(|_| checked.tilt_limit_mrad().is_some());
        let motors = MotorFigures::of_all(checked);
        let axis = |i: usize| AxisReport {
            steps: statistics.steps[i],
            command_turns: statistics.turns[i].0,
            actual_turns: statistics.turns[i].1,
            slipped_cycles: statistics.cycles_off(i),
            phase_error_peak_deg: statistics.phase_error_peak_deg[i],
            correction_deg: statistics.correction_deg[i],
            pull_out_used: statistics.torque_used[i].map(|(used, _)| used),
            torque_worst_nm: statistics.worst_torque_nm.get(i).copied(),
            motor: motors[i],
            follower: statistics.followers.get(i).map(|peaks| FollowerReport {
                off_law_worst_mm: peaks.off_m * 1e3,
                pusher_accel_worst_mps2: peaks.pusher_mps2,
                cam_side_accel_worst_mps2: peaks.cam_side_mps2,
                off_law_accel_worst_mps2: peaks.off_mps2,
            }),
            bounds: BoundsReport::new(&checked.settings, &checked.settings.axes[i]),
        };
        Self {
            name: &checked.scene.name,
            written_by: WrittenBy::this(),
            fidelity: FidelityReport::new(checked),
            method: MethodReport::new(checked, outcome),
            ended: Ended {
                state: outcome.state.name(),
                fault: outcome.fault.is_some(),
                drives: match outcome.state {
                    State::Parked => "held",
                    State::Fault if statistics.fault_hold.is_on() => "held",
                    State::Fault | State::Idle => "off",
                    State::Homing | State::Run | State::Stop => "on",
                },
                diverged: outcome.diverged.is_some(),
                stopped_by: statistics.stopped_by.map(|by| match by {
                    StoppedBy::ProgramEnd => "program end",
                    StoppedBy::Request => "request",
                    StoppedBy::Fault => "fault",
                }),
            },
            coupling: coupling(checked).map(|_| CouplingReport {
                proportional: checked.settings.correction.coupling,
                per_s: checked.settings.correction.coupling_per_s,
            }),
            warnings: warnings(checked, outcome),
            simulated_s: outcome.simulated_s(),
            control_ticks: outcome.ticks,
            time_in_state_s: TimeInState {
                idle,
                homing,
                run,
                stop,
                parked,
                fault,
            },
            axes: (0..checked.scene.axes.count).map(axis).collect(),
            cam_tables: checked
                .cam_tables()
                .map(|(table, points, off_law_accel)| CamTableReport {
                    name: &table.name,
                    points,
                    off_law_accel,
                })
                .collect(),
            phase_spread_worst_deg: statistics.worst_spread_deg,
            phase_spread_rms_deg: statistics.rms_spread_deg,
            tilt_worst_mrad: of_platform(Some(statistics.worst_tilt_mrad)),
            tilt_limit_mrad: checked.tilt_limit_mrad(),
            tilt_at_stop_mrad: of_platform(statistics.fault_hold.at_stop_mrad),
            tilt_worst_held_mrad: of_platform(statistics.fault_hold.at_stop_mrad)
                .map(|_| statistics.fault_hold.worst_mrad),
            tilt_worst_off_mrad: of_platform(statistics.coast.worst_tilt_mrad),
            coasted_s: (statistics.coast.turned_s > 0.0)
                .then(|| round(statistics.coast.turned_s, 6)),
            warp_worst_deg: statistics.worst_warp_deg,
            frame: statistics.frame.map(|frame| FrameReport {
                sag_um: frame.sag_um,
                displacement_worst_um: frame.worst_um,
                ground_force_worst_n: frame.worst_ground_n,
            }),
            holding: HoldingReport {
                held_s: round(statistics.holding.held_s, 6),
                worst_relative_error: statistics.holding.worst_relative,
            },
            speed_top_hz: statistics.top_speed_hz,
            amax_top_mps2: statistics.top_amax_mps2,
            accel_worst_mps2: outcome
                .method
                .filter(|_| checked.machine.moves_by_torque(checked.fidelity))
                .map(|_| statistics.worst_accel_mps2),
            machine_figures: statistics.figures.iter().map(Figure::entry).collect(),
            late_deadlines: statistics.late_deadlines,
            missed_deadlines: statistics.missed_deadlines,
            injected: statistics
                .events
                .iter()
                .filter_map(injected_report)
                .collect(),
            corrections: statistics
                .events
                .iter()
                .filter_map(|event| correction_report(event, axes.len()))
                .collect(),
            reported_faults: faults_in(&statistics.events, axes, |what| match what {
                EventKind::Reported(fault) => Some(fault),
                _ => None,
            }),
            faults: faults_in(&statistics.events, axes, |what| match what {
                EventKind::Fault { fault, .. } => Some(fault),
                _ => None,
            }),
            events: statistics.events.iter().map(event_report).collect(),
            events_left_out: statistics.events_left_out,
            written,
            scene: &checked.scene,
            speed: Speed {
                wall_s,
                times_real_time: outcome.simulated_s() / wall_s.max(1e-9),
            },
        }
    }
}

/// Rounds a time. Times are sums of ticks, so their last digits are rounding errors.
fn round(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale
}
