//! `[screen]`: a box on springs with unbalanced shafts.

use std::sync::Arc;

use cophase_core::mechanism::{MechanismSettings, ScotchYokeSettings};
use cophase_core::settings::{MachineSettings, Platform};
use serde::{Deserialize, Serialize};

use super::Screen;
use crate::plant::{Made, Table};
use crate::scene::file::{Band, Drift};
use crate::scene::{Scene, SceneError, in_range, phase_limits};

/// Table of a vibrating screen.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ScreenTable {
    /// Mass of the box with what lies on it, without the exciter blocks, kg.
    pub box_kg: f64,
    /// Length of the box, mm: its springs are at the ends, and its mass is even.
    pub length_mm: f64,
    /// Mass of the exciter block on each shaft, kg.
    pub block_kg: f64,
    /// Distance of a block's centre of mass from its shaft's axis, mm.
    pub eccentricity_mm: f64,
    /// Place of each shaft along the box from its centre, mm; one an axis.
    pub shafts_mm: Vec<f64>,
    /// Stiffness of all springs together, along and across the deck, N/mm.
    pub stiffness_n_per_mm: f64,
    /// Damping of the box on its springs, as a part of what is critical.
    #[serde(default = "default_zeta")]
    pub zeta: f64,
    /// Gravity, m/s².
    #[serde(default = "standard_gravity")]
    pub gravity_mps2: f64,
}

const fn default_zeta() -> f64 {
    0.07
}
const fn standard_gravity() -> f64 {
    9.80665
}

/// Least load that the controller takes, kg. Its drives take STEP and DIR, so that it gives no torque.
const LOAD_KG: f64 = 1e-3;

impl ScreenTable {
    fn screen(&self, scene: &Scene) -> Result<Screen, SceneError> {
        in_range("screen.box_kg", self.box_kg, 1.0, 1e5)?;
        in_range("screen.length_mm", self.length_mm, 100.0, 20_000.0)?;
        in_range("screen.block_kg", self.block_kg, 0.01, 1e4)?;
        in_range("screen.eccentricity_mm", self.eccentricity_mm, 0.1, 1000.0)?;
        let stiffness = self.stiffness_n_per_mm;
        in_range("screen.stiffness_n_per_mm", stiffness, 0.1, 1e6)?;
        in_range("screen.zeta", self.zeta, 0.001, 0.7)?;
        in_range("screen.gravity_mps2", self.gravity_mps2, 0.0, 20.0)?;
        if self.shafts_mm.len() != scene.axes.count {
            return Err(SceneError::at(
                "screen.shafts_mm",
                format!(
                    "has {} places, and axes.count is {}; give one an axis",
                    self.shafts_mm.len(),
                    scene.axes.count
                ),
            ));
        }
        let half_mm = self.length_mm / 2.0;
        for (i, &place_mm) in self.shafts_mm.iter().enumerate() {
            let key = format!("screen.shafts_mm[{i}]");
            in_range(&key, place_mm, -half_mm, half_mm)?;
        }
        let axes = &scene.axes;
        let length_m = self.length_mm / 1e3;
        let mut screen = Screen {
            box_kg: self.box_kg,
            pitch_kgm2: self.box_kg * length_m * length_m / 12.0,
            block_kg: self.block_kg,
            eccentricity_m: self.eccentricity_mm / 1e3,
            places_m: self.shafts_mm.iter().map(|mm| mm / 1e3).collect(),
            stiffness_n_per_m: self.stiffness_n_per_mm * 1e3,
            zeta: self.zeta,
            springs_m: length_m / 2.0,
            gravity_mps2: self.gravity_mps2,
            motor_nm: None,
        };
        let natural_hz = screen.natural_rad_s() / std::f64::consts::TAU;
        let pull_out = crate::machine::PullOut::new(&axes.pull_out)?;
        screen.motor_nm = if axes.pull_out.is_empty() {
            axes.servo.and_then(|servo| servo.limit_nm)
        } else {
            Some(pull_out.torque_nm(natural_hz))
        };
        Ok(screen)
    }
}

impl Table for ScreenTable {
    fn key(&self) -> &'static str {
        "screen"
    }

    /// Adds the forbidden band of the scene's own resonance.
    fn fill(&self, scene: &mut Scene) -> Result<(), SceneError> {
        let (from_hz, to_hz) = self.screen(scene)?.band_hz();
        let own = Band { from_hz, to_hz };
        let bands = &mut scene.limits.band;
        if !bands.contains(&own) {
            bands.push(own);
            bands.sort_by(|one, other| one.from_hz.total_cmp(&other.from_hz));
        }
        Ok(())
    }

    fn make(&self, scene: &Scene) -> Result<Made, SceneError> {
        let screen = self.screen(scene)?;
        if scene.drift.tilt_limit_mrad != Drift::default().tilt_limit_mrad {
            return Err(SceneError::at(
                "drift.tilt_limit_mrad",
                "is of a platform, and [screen] has none; drift.warp_limit_deg limits how far shafts may be apart, so leave it out",
            ));
        }
        let is_servo = |i: usize| scene.drive(i) == crate::scene::file::Drive::Servo;
        if let Some(i) = (0..scene.axes.count).find(|&i| is_servo(i)) {
            return Err(SceneError::at(
                "axes.drive",
                format!(
                    "axis {i} is a servo with torque setpoints, and the controller knows no torque of a screen; give a drive that takes STEP and DIR"
                ),
            ));
        }
        let throw_m = screen.throw_m();
        in_range("screen.eccentricity_mm", 1e3 * throw_m, 0.1, 500.0).map_err(|_| {
            SceneError::at(
                "screen.eccentricity_mm",
                format!(
                    "makes a throw of {:.4} mm, outside 0.1 to 500 mm; change it, or screen.block_kg",
                    1e3 * throw_m
                ),
            )
        })?;
        let machine = MachineSettings {
            crank_radius_m: throw_m,
            mechanism: MechanismSettings::ScotchYoke(ScotchYokeSettings {}),
            load_kg: LOAD_KG,
            platform: Platform::Above,
            gravity_mps2: 0.0,
            mount_radius_m: (20.0 * throw_m).clamp(0.01, 5.0),
        };
        Ok(Made {
            drift: phase_limits(&scene.drift, &machine),
            machine,
            plant: Arc::new(screen),
        })
    }
}
