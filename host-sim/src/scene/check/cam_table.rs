//! Cam tables: points for the core from motion laws or files, and the tables that axes choose.

use cophase_core::axes::{
    CamSettings, CamTableSettings, FollowerSettings, LEAST_CAM_POINTS, MAX_CAM_POINTS, MAX_CAMS,
};
use cophase_methods::problems::Law;

use super::numbers::range;
use crate::scene::SceneError;
use crate::scene::entry::ordinal;
use crate::scene::file::{CamTable, Scene};
use crate::scene::load::nearest;

/// Distance from a point up to which an angle counts as on it, relative to the distance of two points.
const ON_A_POINT: f64 = 1e-9;

/// Returns the tables of a scene for the core.
pub(super) fn tables(scene: &Scene) -> Result<heapless::Vec<CamSettings, MAX_CAMS>, SceneError> {
    let tables = &scene.cam_table;
    if tables.len() > MAX_CAMS {
        return Err(SceneError::at(
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
            return Err(SceneError::at(
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
    let points_turns = match (&table.file, table.segments.is_empty()) {
        (_, true) if !table.points_turns.is_empty() => {
            Ok(table.points_turns.iter().copied().collect())
        }
        (Some(_), true) => Err(SceneError::at(
            key("file"),
            "can be read beside a scene file only; give segments",
        )),
        (None, false) => sampled(entry, table),
        (Some(_), false) => Err(SceneError::at(
            key("segment"),
            "given together with file, which has the same meaning; leave one out",
        )),
        (None, true) => Err(SceneError::at(
            key("segment"),
            "missing; give segments such as { deg = 120, turns = 2.5 }, or the points as a CSV file with file = \"…\"",
        )),
    }?;
    Ok(CamSettings {
        net_turns: table.net_turns,
        points_turns,
    })
}

/// Returns the points of a motion law over segments.
fn sampled(
    entry: usize,
    table: &CamTable,
) -> Result<heapless::Vec<f64, MAX_CAM_POINTS>, SceneError> {
    let (mut corners_deg, mut end_deg, mut travel) = (Vec::new(), 0.0, 0.0);
    for (i, segment) in table.segments.iter().enumerate() {
        let key = |name: &str| format!("cam_table[{entry}].segment[{i}].{name}");
        range(&key("deg"), segment.deg, 1.0, 360.0)?;
        range(&key("turns"), segment.turns, -1000.0, 1000.0)?;
        end_deg += segment.deg;
        travel += segment.turns;
        corners_deg.push(end_deg);
        if end_deg > 360.0 + 1e-9 {
            return Err(SceneError::at(
                key("deg"),
                format!(
                    "the segments up to here extend over {end_deg} of the 360 degrees of a turn; shorten them"
                ),
            ));
        }
    }
    if (travel - f64::from(table.net_turns)).abs() > 1e-9 {
        return Err(SceneError::at(
            format!("cam_table[{entry}].net_turns"),
            format!(
                "{} is not the travel of the segments, {travel} turns; after a turn of the master the axis must be whole turns further, or back",
                table.net_turns
            ),
        ));
    }
    let law = Law::from(table.law);
    let points = point_count(&corners_deg);
    let at = |i: usize| position(table, law, 360.0 * i as f64 / points as f64);
    Ok((0..points).map(at).collect())
}

/// Returns the position at an angle of the master, turns.
fn position(table: &CamTable, law: Law, angle_deg: f64) -> f64 {
    let (mut start_deg, mut turns) = (0.0, 0.0);
    for segment in &table.segments {
        let part = (angle_deg - start_deg) / segment.deg;
        if part < 1.0 {
            return turns + segment.turns * law.at(part).displacement;
        }
        start_deg += segment.deg;
        turns += segment.turns;
    }
    turns
}

/// Returns the number of points: the largest with a point at every corner, where the law's third derivative jumps. If that is below
/// half of a table's capacity, the capacity.
fn point_count(corners_deg: &[f64]) -> usize {
    let on_points = |count: &usize| {
        corners_deg.iter().all(|corner_deg| {
            let place = corner_deg / 360.0 * *count as f64;
            (place - place.round()).abs() < ON_A_POINT
        })
    };
    const { assert!(LEAST_CAM_POINTS <= MAX_CAM_POINTS / 2) };
    let counts = (MAX_CAM_POINTS / 2..=MAX_CAM_POINTS).rev();
    counts.clone().find(on_points).unwrap_or(MAX_CAM_POINTS)
}

/// Returns the follower of axis `number`.
pub(super) fn follower(scene: &Scene, number: usize, ratio: (u32, u32)) -> FollowerSettings {
    let overrides = scene.overrides(number);
    let chosen = overrides.and_then(|own| Some((own.cam.as_ref()?, own.cam_shift_deg)));
    let Some((name, shift_deg)) = chosen else {
        return FollowerSettings::gear(ratio);
    };
    // Names have been checked.
    let table = scene.cam_table.iter().position(|table| table.name == *name);
    FollowerSettings::CamTable(CamTableSettings {
        table: table.unwrap_or(MAX_CAMS) as u8,
        shift_turns: shift_deg / 360.0,
    })
}

/// Checks the table names of axes, and that each axis can follow a table.
pub(super) fn check_axes(scene: &Scene) -> Result<(), SceneError> {
    for (entry, own) in scene.axis.iter().enumerate() {
        let key = |name: &str| format!("axis[{entry}].{name}");
        let Some(name) = &own.cam else {
            if own.cam_shift_deg != 0.0 {
                return Err(SceneError::at(
                    key("cam_shift_deg"),
                    "shifts nothing: the axis follows no table; give cam = \"…\", or leave it out",
                ));
            }
            continue;
        };
        let names: Vec<_> = scene.cam_table.iter().map(|t| t.name.as_str()).collect();
        if !names.contains(&name.as_str()) {
            let meant = nearest(name, &names).map(|name| format!("did you mean \"{name}\"? "));
            return Err(SceneError::at(
                key("cam"),
                format!(
                    "there is no [[cam_table]] of the name \"{name}\"; {}given are: {}",
                    meant.unwrap_or_default(),
                    names.join(", ")
                ),
            ));
        }
        if own.ratio.is_some() {
            return Err(SceneError::at(
                key("ratio"),
                "given together with cam; an axis has a gear or follows a table, so leave one out",
            ));
        }
    }
    Ok(())
}
