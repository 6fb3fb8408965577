//! Motion laws of cam tables, and how close a table's curve is to its law.

use cophase_core::axes::{MAX_CAM_POINTS, Spline};
use cophase_scene::file::CamTable;

use super::law;

/// Number of places at which a curve is compared with its law, per point of the table.
const SAMPLES_A_POINT: usize = 16;

/// Points of a table, turns.
pub type Points = heapless::Vec<f64, MAX_CAM_POINTS>;

/// Returns the position at an angle of the master, turns, and its second derivative, turns per turn².
pub fn law_at(table: &CamTable, angle_deg: f64) -> (f64, f64) {
    let law = law(table.law);
    let (mut start_deg, mut turns) = (0.0, 0.0);
    for segment in &table.segment {
        let own = (angle_deg - start_deg) / segment.deg;
        if own < 1.0 {
            let motion = law.at(own);
            let per_turn = 360.0 / segment.deg;
            let bend = segment.turns * motion.acceleration * per_turn * per_turn;
            return (turns + segment.turns * motion.displacement, bend);
        }
        start_deg += segment.deg;
        turns += segment.turns;
    }
    (turns, 0.0)
}

/// Returns the largest difference of a table's acceleration from that of its law, relative to the law's peak. A table from a file has no
/// law.
pub fn off_law(table: &CamTable, points: &Points) -> Option<f64> {
    (!table.segment.is_empty()).then(|| off_law_of(table, points))
}

/// Returns the largest difference of a table's acceleration from that of its law of segments, relative to the law's peak.
pub fn off_law_of(table: &CamTable, points: &Points) -> f64 {
    let mut curve = Spline::NONE;
    curve.fit(points, table.net_turns);
    let samples = points.len() * SAMPLES_A_POINT;
    let between = (0..samples).map(|i| 360.0 * i as f64 / samples as f64);
    // The difference is largest at points, and where a segment ends between two points.
    let mut end_deg = 0.0;
    let ends = table.segment.iter().map(|segment| {
        end_deg += segment.deg;
        end_deg
    });
    let (mut peak, mut off) = (0.0_f64, 0.0_f64);
    for angle_deg in between.chain(ends.filter(|&end_deg| end_deg < 360.0)) {
        let (_, bend) = law_at(table, angle_deg);
        peak = peak.max(bend.abs());
        off = off.max((curve.second_derivative(angle_deg / 360.0) - bend).abs());
    }
    if peak > 0.0 { off / peak } else { 0.0 }
}
