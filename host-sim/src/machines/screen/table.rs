//! The screen that the table `[screen]` of a scene describes.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::sync::Arc;

use cophase_scene::file::{Band, ScreenTable};
use cophase_scene::{Scene, SceneError, in_range};

use super::{Screen, Sufficient};
use crate::drives::{AtCrank, DriveModel, PullOut};
use crate::machines::{Made, Table};

fn screen(table: &ScreenTable, scene: &Scene) -> Result<Screen, SceneError> {
    if table.shafts_mm.len() != scene.axes.count {
        return Err(SceneError::for_key(
            "screen.shafts_mm",
            format!(
                "has {} places, and axes.count is {}; give one an axis",
                table.shafts_mm.len(),
                scene.axes.count
            ),
        ));
    }
    let half_mm = table.length_mm / 2.0;
    for (i, &place_mm) in table.shafts_mm.iter().enumerate() {
        let key = format!("screen.shafts_mm[{i}]");
        in_range(&key, place_mm, -half_mm, half_mm)?;
    }
    let axes = &scene.axes;
    let length_m = table.length_mm / 1e3;
    let mut screen = Screen {
        box_kg: table.box_kg,
        pitch_kgm2: table.box_kg * length_m * length_m / 12.0,
        block_kg: table.block_kg,
        eccentricity_m: table.eccentricity_mm / 1e3,
        places_m: table.shafts_mm.iter().map(|mm| mm / 1e3).collect(),
        stiffness_n_per_m: table.stiffness_n_per_mm * 1e3,
        zeta: table.zeta,
        springs_m: length_m / 2.0,
        gravity_mps2: table.gravity_mps2,
        phases_turns: (0..axes.count)
            .map(|i| scene.resolved(i).offset_deg / 360.0)
            .collect(),
        top_hz: scene.limits.speed_hz,
        common_limit_turns: scene.drift.common_limit_deg / 360.0,
        sufficient: Sufficient::default(),
    };
    PullOut::new(&axes.pull_out)?;
    let motors = (0..axes.count).filter_map(|i| AtCrank::motor(scene, i));
    let motors: Vec<_> = motors.collect();
    // The weakest counts.
    let motor_nm = |speed_hz: f64| {
        let max_nm = motors.iter().map(|motor| motor.max_nm(speed_hz * TAU));
        max_nm.filter(|max_nm| max_nm.is_finite()).reduce(f64::min)
    };
    let needed = screen.resonances().into_iter().map(|resonance| Sufficient {
        enough_nm: resonance.enough_nm,
        motor_nm: motor_nm(resonance.omega_rad_s / TAU),
    });
    // Without a torque of the motors the reserve is 1 over the sufficient torque.
    let reserve = |one: &Sufficient| one.motor_nm.unwrap_or(1.0) / one.enough_nm;
    let critical = needed.min_by(|one, other| reserve(one).total_cmp(&reserve(other)));
    screen.sufficient = critical.unwrap_or_default();
    Ok(screen)
}

/// Refuses motors without sufficient torque at a resonance. Every scene crosses that of the springs, as its band must end below
/// the largest speed.
fn check_torque(table: &ScreenTable, screen: &Screen, scene: &Scene) -> Result<(), SceneError> {
    let enough_nm = screen.sufficient.enough_nm;
    match screen.sufficient.motor_nm {
        Some(motor_nm) if motor_nm < enough_nm && !table.allow_capture => {
            let key = DriveModel::for_drive(scene.axes.drive).torque_key;
            Err(SceneError::for_key(
                key,
                format!(
                    "gives {motor_nm:.1} N·m of each motor at the resonance, and {enough_nm:.1} N·m are enough to turn there: the torque reserve is \
                     {:.1} N·m, and the resonance may capture the shafts; raise the torque or `screen.zeta`, or set `screen.allow_capture = true` \
                     to run it all the same",
                    motor_nm - enough_nm
                ),
            ))
        }
        _ => Ok(()),
    }
}

impl Table for ScreenTable {
    fn key(&self) -> &'static str {
        "screen"
    }

    fn machine_name(&self) -> &'static str {
        super::NAME
    }

    fn axes(&self) -> RangeInclusive<usize> {
        1..=6
    }

    /// Adds the forbidden bands of the screen's resonances.
    fn fill(&self, scene: &mut Scene) -> Result<(), SceneError> {
        let screen = screen(self, scene)?;
        let bands_hz = screen.bands_hz();
        let top_hz = screen.top_hz;
        let covers_top = |(from_hz, to_hz): &&(f64, f64)| (*from_hz..=*to_hz).contains(&top_hz);
        if let Some((from_hz, to_hz)) = bands_hz.iter().find(covers_top) {
            return Err(SceneError::for_key(
                "limits.speed_hz",
                format!(
                    "{top_hz} rev/s lies where the box resonates, at {from_hz:.2} to {to_hz:.2} rev/s; give one below or above{}",
                    if screen.excites_pitch() {
                        ", or place the shafts so that they do not pitch the box (screen.shafts_mm)"
                    } else {
                        ""
                    }
                ),
            ));
        }
        let bands = &mut scene.limits.band;
        // The machine does not reach a resonance above its limit.
        for (from_hz, to_hz) in bands_hz
            .into_iter()
            .filter(|(from_hz, _)| *from_hz < top_hz)
        {
            let own = Band { from_hz, to_hz };
            if !bands.contains(&own) {
                bands.push(own);
            }
        }
        bands.sort_by(|one, other| one.from_hz.total_cmp(&other.from_hz));
        Ok(())
    }

    fn make(&self, scene: &Scene) -> Result<Made, SceneError> {
        let screen = screen(self, scene)?;
        check_torque(self, &screen, scene)?;
        Made::square_law(
            scene,
            self.key(),
            "screen.eccentricity_mm",
            Arc::new(screen),
        )
    }
}
