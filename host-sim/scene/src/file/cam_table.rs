//! `[[cam_table]]`: curves that axes follow instead of a gear, over one turn of the master.

use cophase_core::axes::CamSettings;
use serde::{Deserialize, Serialize};

use super::LawName;

/// Cam table: from a motion law over segments, or from a file of points.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CamTable {
    /// Name of the table, for axes.
    pub name: String,
    /// Whole turns of the axis per turn of the master; 0 if the axis returns.
    #[serde(default)]
    pub net_turns: i32,
    /// Limit on the speed of axes that follow it, rev/s.
    #[serde(default = "usual_max_speed_hz")]
    pub max_speed_hz: f64,
    /// Limit on the acceleration of axes that follow it, rev/s².
    #[serde(default = "usual_max_acceleration_hz_per_s")]
    pub max_acceleration_hz_per_s: f64,
    /// Motion law of the segments.
    #[serde(default)]
    pub law: LawName,
    /// Segments from the master's phase 0 on; the axis rests for the remainder of the turn. Give these or `file`.
    #[serde(default, rename = "segment", skip_serializing_if = "Vec::is_empty")]
    pub segments: Vec<CamSegment>,
    /// CSV file of points, relative to the scene's folder.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Points of that file, axis turns. The loader fills them in, and so do machines that compute tables.
    #[serde(skip)]
    pub points_turns: Vec<f64>,
}

impl CamTable {
    /// Creates a table from points, in turns of the axis, at equal distances over a turn of the master. After a turn the axis is where its
    /// last point is nearest to the first.
    pub fn of_points(name: &str, points_turns: Vec<f64>) -> Self {
        let (first, last) = (points_turns.first(), points_turns.last());
        let travel = last.zip(first).map_or(0.0, |(last, first)| last - first);
        Self {
            name: name.to_owned(),
            net_turns: travel.round() as i32,
            max_speed_hz: usual_max_speed_hz(),
            max_acceleration_hz_per_s: usual_max_acceleration_hz_per_s(),
            law: LawName::default(),
            segments: Vec::new(),
            file: None,
            points_turns,
        }
    }
}

/// Segment of a cam table.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CamSegment {
    /// Angle of the master over which it extends, degrees.
    pub deg: f64,
    /// Travel of the axis over the segment, turns; 0 is a dwell.
    #[serde(default)]
    pub turns: f64,
}

const fn usual_max_speed_hz() -> f64 {
    CamSettings::USUAL_MAX_SPEED_HZ
}

const fn usual_max_acceleration_hz_per_s() -> f64 {
    CamSettings::USUAL_MAX_ACCELERATION_HZ_PER_S
}
