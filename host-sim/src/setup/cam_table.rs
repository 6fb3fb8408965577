//! Cam tables: points for the core from motion laws or files, and the tables that axes choose.

use cophase_core::axes::{
    CamSettings, CamTableSettings, FollowerSettings, MAX_CAM_POINTS, MAX_CAMS,
};
use cophase_scene::SceneError;
use cophase_scene::entry::ordinal;
use cophase_scene::file::{Axis, AxisOverrides, CamSegment, CamTable, Scene};
use cophase_scene::load::{meant_net_turns, nearest};

use crate::machines::Table;
use crate::machines::cam::{Points, law_at, off_law_of};

/// Largest difference of a table's acceleration from that of its law, relative to the law's peak.
const MAX_OFF_LAW: f64 = 0.15;

/// Returns the tables of a scene for the core.
pub(super) fn tables(scene: &Scene) -> Result<heapless::Vec<CamSettings, MAX_CAMS>, SceneError> {
    let tables = &scene.cam_table;
    if tables.len() > MAX_CAMS {
        return Err(SceneError::for_key(
            "cam_table",
            format!(
                "{} tables are more than the {MAX_CAMS} that a machine holds; axes may share one, each with a cam_shift_deg of its own",
                tables.len()
            ),
        ));
    }
    let names = tables.iter().enumerate();
    for (i, table) in names.clone() {
        if let Some((other, _)) = names.clone().take(i).find(|(_, t)| t.name == table.name) {
            return Err(SceneError::for_key(
                format!("cam_table[{i}].name"),
                format!(
                    "\"{}\" is the name of the {} [[cam_table]] entry already; give another one",
                    table.name,
                    ordinal(other)
                ),
            ));
        }
    }
    names.map(|(i, table)| one(i, table)).collect()
}

fn one(entry: usize, table: &CamTable) -> Result<CamSettings, SceneError> {
    let key = |name: &str| format!("cam_table[{entry}].{name}");
    let points_turns = match (&table.file, table.segment.is_empty()) {
        (_, true) if !table.points_turns.is_empty() => {
            Ok(table.points_turns.iter().copied().collect())
        }
        (Some(_), true) => Err(SceneError::for_key(
            key("file"),
            "can be read beside a scene file only; give segments",
        )),
        (None, false) => sampled(entry, table),
        (Some(_), false) => Err(SceneError::for_key(
            key("segment"),
            "given together with file, which has the same meaning; leave one out",
        )),
        (None, true) => Err(SceneError::for_key(
            key("segment"),
            "missing; give segments such as { deg = 120, turns = 2.5 }, or the points as a CSV file with file = \"…\"",
        )),
    }?;
    Ok(CamSettings {
        net_turns: table.net_turns,
        max_speed_hz: table.max_speed_hz,
        max_acceleration_hz_per_s: table.max_acceleration_hz_per_s,
        points_turns,
    })
}

/// Returns the points of a motion law over segments, in the number for which the curve's acceleration is closest to the law's.
///
/// The spline's second derivative is off where the law's third one jumps between two points, so a number is best that has points at the
/// ends of segments, or near them.
fn sampled(entry: usize, table: &CamTable) -> Result<Points, SceneError> {
    let (mut end_deg, mut travel) = (0.0, 0.0);
    for (i, segment) in table.segment.iter().enumerate() {
        let key = |name: &str| format!("cam_table[{entry}].segment[{i}].{name}");
        end_deg += segment.deg;
        travel += segment.turns;
        if end_deg > 360.0 + 1e-9 {
            return Err(SceneError::for_key(
                key("deg"),
                format!(
                    "the segments up to here extend over {end_deg} of the 360 degrees of a turn; shorten them"
                ),
            ));
        }
    }
    if (travel - f64::from(table.net_turns)).abs() > 1e-9 {
        return Err(SceneError::for_key(
            format!("cam_table[{entry}].net_turns"),
            format!(
                "{} is not the travel of the segments, {travel} turns; {}after a turn of the master the axis must be whole turns further, or back",
                table.net_turns,
                meant_net_turns(travel, 1e-9)
            ),
        ));
    }
    // A count beats a larger one only by more than rounding.
    let counts = (MAX_CAM_POINTS / 2..=MAX_CAM_POINTS).rev();
    let mut best: Option<(Points, f64)> = None;
    for count in counts {
        let points = (0..count)
            .map(|i| law_at(table, 360.0 * i as f64 / count as f64).0)
            .collect();
        let off = off_law_of(table, &points);
        if best.as_ref().is_none_or(|(_, best)| off < best - 1e-9) {
            best = Some((points, off));
        }
    }
    let (points, off) = best.unwrap_or_default();
    if off <= MAX_OFF_LAW {
        return Ok(points);
    }
    // The segment of the largest acceleration is the shortest for its travel.
    let steepness = |segment: &CamSegment| segment.turns.abs() / (segment.deg * segment.deg);
    let segments = table.segment.iter().enumerate();
    let (number, deg) = segments
        .max_by(|(_, a), (_, b)| steepness(a).total_cmp(&steepness(b)))
        .map_or((0, 0.0), |(number, segment)| (number, segment.deg));
    Err(SceneError::for_key(
        format!("cam_table[{entry}].segment[{number}].deg"),
        format!(
            "{deg} is too short: the curve through {} points, the best for these segments, is off the law's acceleration by {:.0} % of its peak, \
             and {:.0} % is the most; extend the segment over a larger angle",
            points.len(),
            1e2 * off,
            1e2 * MAX_OFF_LAW,
        ),
    ))
}

/// Returns the follower of an axis.
pub(super) fn follower(scene: &Scene, axis: &Axis) -> FollowerSettings {
    let Some(name) = &axis.own.cam else {
        return FollowerSettings::gear(axis.ratio);
    };
    // Names have been checked.
    let table = scene.cam_table.iter().position(|table| table.name == *name);
    FollowerSettings::CamTable(CamTableSettings {
        table: table.unwrap_or(MAX_CAMS) as u8,
        shift_turns: axis.own.cam_shift_deg / 360.0,
    })
}

/// Checks the table names of axes, and that each axis can follow a table. `machine` is the table of the scene's machine. Returns the
/// errors, each once.
pub(super) fn check_axes(scene: &Scene, machine: &dyn Table) -> Vec<SceneError> {
    let entries = scene.axis.iter().enumerate();
    let mut errors: Vec<_> = entries
        .filter_map(|(entry, own)| check_axis(scene, machine, entry, own).err())
        .collect();
    // The first wrong axis shows what is wrong with all.
    errors.dedup_by(|error, before| error.problem == before.problem);
    errors
}

fn check_axis(
    scene: &Scene,
    machine: &dyn Table,
    entry: usize,
    own: &AxisOverrides,
) -> Result<(), SceneError> {
    let key = |name: &str| format!("axis[{entry}].{name}");
    let Some(name) = &own.cam else {
        if own.cam_shift_deg == 0.0 {
            return Ok(());
        }
        return Err(SceneError::for_key(
            key("cam_shift_deg"),
            "shifts nothing: the axis follows no table; give cam = \"…\", or leave it out",
        ));
    };
    let names: Vec<_> = scene.cam_table.iter().map(|t| t.name.as_str()).collect();
    if !names.contains(&name.as_str()) {
        let meant = nearest(name, &names).map(|name| format!("did you mean \"{name}\"? "));
        return Err(SceneError::for_key(
            key("cam"),
            format!(
                "there is no [[cam_table]] of the name \"{name}\"; {}given are: {}",
                meant.unwrap_or_default(),
                names.join(", ")
            ),
        ));
    }
    if own.ratio.is_some() {
        return Err(SceneError::for_key(
            key("ratio"),
            "given together with cam; an axis has a gear or follows a table, so leave one out",
        ));
    }
    if !machine.axes_follow_tables() {
        return Err(SceneError::for_key(
            key("cam"),
            "turns neither a crank nor a cam evenly: only pushers on screws follow a table here, so give [cam] with cam.screw_lead_mm",
        ));
    }
    Ok(())
}
