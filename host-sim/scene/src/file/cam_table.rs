//! `[[cam_table]]`: curves that axes follow instead of a gear, over one turn of the master.

use cophase_core::axes::{CamSettings, MAX_ACCELERATION_HZ_PER_S, MAX_SPEED_HZ, NET_TURNS};
use cophase_core::keys;
use cophase_core::settings::key::{needed, optional, or, or_value};
use serde::{Deserialize, Serialize};

use super::LawName;

keys! {
    /// Cam table: from a motion law over segments, or from a file of points.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct CamTable {
        /// Name of the table, for axes.
        name: String = needed("lobe"),
        /// Whole turns of the axis per turn of the master; 0 if the axis returns.
        net_turns: i32 = NET_TURNS,
        /// Limit on the speed of axes that follow it, rev/s.
        max_speed_hz: f64 = MAX_SPEED_HZ,
        /// Limit on the acceleration of axes that follow it, rev/s².
        max_acceleration_hz_per_s: f64 = MAX_ACCELERATION_HZ_PER_S,
        /// Motion law of the segments.
        law: LawName = or_value("modified-sine"),
        /// Segments from the master's phase 0 on; the axis rests for the remainder of the turn. Give these or `file`.
        segment: Vec<CamSegment> = or_value("[]"),
        /// CSV file of points, relative to the scene's folder.
        file: Option<String> = optional("lift.csv"),
    } and {
        /// Points of that file, axis turns. The loader fills them in, and so do machines that compute tables.
        #[serde(skip)]
        points_turns: Vec<f64>,
    }
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
            max_speed_hz: CamSettings::USUAL_MAX_SPEED_HZ,
            max_acceleration_hz_per_s: CamSettings::USUAL_MAX_ACCELERATION_HZ_PER_S,
            law: LawName::ModifiedSine,
            segment: Vec::new(),
            file: None,
            points_turns,
        }
    }
}

keys! {
    /// Segment of a cam table.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct CamSegment {
        /// Angle of the master over which it extends, degrees.
        deg: f64 = needed("120").from(1.0, 360.0),
        /// Travel of the axis over the segment, turns; 0 is a dwell.
        turns: f64 = or(0.0).from(-1000.0, 1000.0),
    }
}
