//! Record of a run: the figures of `report.json`, under their names there.
//!
//! A figure is `None` if nobody knows it, or if the machine has no such thing. A controller does not know the truth about its machine. Not
//! every machine has a platform, a frame or followers.

use cophase_core::supervisor::State;
use serde::{Serialize, Serializer};

use super::events::{Event, EventKind, StoppedBy};
use crate::dynamics::plant::Figure;
use crate::machines::follower::Peaks;

/// Largest number of events that are kept. This is enough for any single scene, and a campaign uses only the numbers.
pub const MAX_EVENTS: usize = 10_000;

/// Record of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunRecord {
    /// Control ticks: those that were simulated, or those from the first to the last sample.
    pub control_ticks: u64,
    /// Time in each state.
    pub time_in_state_s: TimeInState,
    /// Each axis, as the run ended.
    pub axes: Vec<AxisRecord>,
    /// Figures of the whole run.
    pub figures: Figures,
    /// Events in order of time; the first [`MAX_EVENTS`] of them.
    pub events: Vec<Event>,
    /// Number of further events.
    pub events_left_out: usize,
    /// Number of faults that the loop reported.
    pub reported: u32,
    /// Cause of the last stop.
    pub stopped_by: Option<StoppedBy>,
    /// True if the drives held after a fault as the run ended.
    pub is_held: bool,
    /// True if cranks still coasted as the run ended.
    pub is_coasting: bool,
    /// End of the last tick in which a crank moved without its drive, s since power-up; none if all stood.
    pub moved_until_s: Option<f64>,
    /// Warnings of a machine with its own plant model.
    pub machine_warnings: Vec<String>,
}

impl RunRecord {
    /// Time at which the first motor slipped or the first fault latched, s; none if neither happened.
    pub fn first_effect_s(&self) -> Option<f64> {
        let first = self.events.iter().find(|event| {
            matches!(
                event.what,
                EventKind::Slipped { .. } | EventKind::Fault { .. }
            )
        });
        first.map(|event| event.t_s)
    }

    /// Adds an event.
    pub fn note(&mut self, t_s: f64, what: EventKind) {
        if self.events.len() < MAX_EVENTS {
            self.events.push(Event { t_s, what });
        } else {
            self.events_left_out += 1;
        }
    }
}

/// Time in each state, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimeInState([f64; State::ALL.len()]);

impl TimeInState {
    /// Adds a time in a state, which may have a number that is none.
    pub(super) fn add(&mut self, state: u8, time_s: f64) {
        if let Some(sum_s) = self.0.get_mut(usize::from(state)) {
            *sum_s += time_s;
        }
    }
}

impl Serialize for TimeInState {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let times_s = self.0.iter().map(|time_s| rounded(*time_s, 6));
        serializer.collect_map(State::ALL.iter().map(|state| state.name()).zip(times_s))
    }
}

/// Record of one axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AxisRecord {
    /// Steps or counts commanded.
    pub steps: i64,
    /// Turns commanded.
    pub command_turns: f64,
    /// Turns made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub actual_turns: Option<f64>,
    /// Electrical cycles by which the axis left its command, by itself or by a fault of the scene: negative behind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slipped_cycles: Option<i64>,
    /// Largest measured phase error, degrees, without sign: since power-up or the last `reset-peak`, or among the samples.
    pub phase_error_peak_deg: f64,
    /// Correction of the phase error at the end, degrees.
    pub correction_deg: f64,
    /// Largest ratio of required torque to pull-out torque; none if torque is not compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pull_out_used: Option<f64>,
    /// Largest torque of the motor, N·m; none if torque does not move the cranks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_worst_nm: Option<f64>,
    /// Peak values of its follower, if it is a cam shaft.
    #[serde(skip)]
    pub follower: Option<Peaks>,
    /// Speed at the largest ratio of torques, rev/s.
    #[serde(skip)]
    pub pull_out_used_at_hz: f64,
    /// Electrical cycles that its motor slipped itself.
    #[serde(skip)]
    pub motor_slips: i64,
    /// Error of a shaft that ended off its command, turns: positive ahead; 0 if it did not.
    #[serde(skip)]
    pub off_command_turns: f64,
    /// True if the shaft made less than half of the motion that the program commanded.
    #[serde(skip)]
    pub stood: bool,
}

/// Figures of a whole run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Largest difference between the phase errors of two cranks while the drives were on, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase_spread_worst_deg: Option<f64>,
    /// Root mean square of this difference while running, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase_spread_rms_deg: Option<f64>,
    /// Largest tilt of the platform while the drives were on, mrad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_worst_mrad: Option<f64>,
    /// Limit of the tilt, mrad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_limit_mrad: Option<f64>,
    /// Tilt at the end of the last fault stop after which the drives held, mrad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_at_stop_mrad: Option<f64>,
    /// Largest tilt while they held, mrad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_worst_held_mrad: Option<f64>,
    /// Largest tilt of the platform with the drives off, after they had been on, mrad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_worst_off_mrad: Option<f64>,
    /// Longest time for which cranks coasted after their drives were switched off, s.
    #[serde(
        skip_serializing_if = "Option::is_none",
        serialize_with = "optional_time"
    )]
    pub coasted_s: Option<f64>,
    /// Largest deviation of a crank from the plane of all cranks, degrees, while the drives were on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warp_worst_deg: Option<f64>,
    /// Motion of the frame, if it moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<FramePeaks>,
    /// Accuracy of steady holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holding: Option<Holding>,
    /// Largest commanded speed, rev/s.
    pub speed_top_hz: f64,
    /// Amplitude of that speed, m/s².
    pub amax_top_mps2: f64,
    /// Largest acceleration of the platform itself while running, m/s²; none if torque does not move the cranks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accel_worst_mps2: Option<f64>,
    /// Figures of a machine with its own plant model.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "by_key")]
    pub machine_figures: Vec<Figure>,
    /// Deadlines met more than half a tick late.
    pub late_deadlines: u32,
    /// Deadlines missed completely.
    pub missed_deadlines: u32,
}

/// Accuracy of amax while the program holds it and the shaft has reached its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Holding {
    /// Duration of all such holds, s.
    #[serde(serialize_with = "time")]
    pub held_s: f64,
    /// Largest relative error of the platform's acceleration amplitude.
    pub worst_relative_error: f64,
}

/// Motion of a frame, and the force that it passed to the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FramePeaks {
    /// Static sag under its own weight and the load, µm. Displacements are counted from there.
    pub sag_um: f64,
    /// Largest displacement of any point on the mount circle from rest, µm.
    pub displacement_worst_um: f64,
    /// Largest force on the ground beyond the weight at rest, N.
    pub ground_force_worst_n: f64,
}

/// Rounds a time. Times are sums of ticks, so their last digits are rounding errors.
pub fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale
}

fn time<S: Serializer>(time_s: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(rounded(*time_s, 6))
}

fn optional_time<S: Serializer>(time_s: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    time_s
        .map(|time_s| rounded(time_s, 6))
        .serialize(serializer)
}

fn by_key<S: Serializer>(figures: &[Figure], serializer: S) -> Result<S::Ok, S::Error> {
    let mut entries: Vec<_> = figures.iter().map(Figure::entry).collect();
    entries.sort_by_key(|(key, _)| *key);
    serializer.collect_map(entries)
}
