//! The cam shaft that the table `[cam]` of a scene describes.
//!
//! A follower shares one property with a slider-crank: its greatest acceleration is κ ω², with κ = R (1 + λ) for the crank, and
//! κ = Ca H/β² for the cam (stroke H over the shorter of rise and return, β rad). So the core gets shafts of the length κ. Strokes are
//! limited to those whose crank of equal κ the core would accept.

use std::ops::RangeInclusive;
use std::sync::Arc;

use cophase_methods::problems::{Cam, Links};
use cophase_scene::file::CamShaft;
use cophase_scene::{Scene, SceneError};

use super::{CamShafts, cam_of, damped};
use crate::drives::keys_of_torque;
use crate::machines::{Made, Table, given};

/// λ of the crank of equal κ: the least that the core accepts.
const LAMBDA: f64 = 0.1;
/// Crank radii that the core accepts, m.
const RADII_M: (f64, f64) = (1e-4, 0.5);

/// Returns the cam shafts that a table describes.
fn cam_shafts(shaft: &CamShaft) -> Result<CamShafts, SceneError> {
    let turn_deg = shaft.rise_deg + shaft.dwell_deg + shaft.return_deg;
    if turn_deg > 360.0 {
        return Err(SceneError::for_key(
            "cam.return_deg",
            format!(
                "{} is too much: with cam.rise_deg and cam.dwell_deg it comes to {turn_deg} of the 360 that a turn has; \
                 give at most {}",
                shaft.return_deg,
                360.0 - shaft.rise_deg - shaft.dwell_deg
            ),
        ));
    }
    let cam = cam_of(shaft);
    let (min_m, max_m) = (
        RADII_M.0 * (1.0 + LAMBDA) / cam.peak_m(),
        RADII_M.1 * (1.0 + LAMBDA) / cam.peak_m(),
    );
    if !(min_m..=max_m).contains(&1.0) {
        return Err(SceneError::for_key(
            "cam.rise_mm",
            format!(
                "{} mm over {}° accelerates as a crank of {:.4} mm does, outside the {} to {} mm that the loop is made \
                 for; over these angles give {:.4} to {:.4} mm",
                shaft.rise_mm,
                shaft.rise_deg.min(shaft.return_deg),
                crank_radius_m(&cam) * 1e3,
                RADII_M.0 * 1e3,
                RADII_M.1 * 1e3,
                // Rounded inwards, so that the suggested value is accepted.
                (shaft.rise_mm * min_m * 1e4).ceil() / 1e4,
                (shaft.rise_mm * max_m * 1e4).floor() / 1e4,
            ),
        ));
    }
    Ok(CamShafts {
        cam,
        links: links(shaft)?.map(|links| (links, damped(shaft.damper))),
        screw_lead_m: shaft.screw_lead_mm.map(|lead_mm| lead_mm / 1e3),
    })
}

/// Checks pushers on screws, if the shaft has them: their axes follow tables.
fn check_screws(shaft: &CamShaft, scene: &Scene) -> Result<(), SceneError> {
    let follows = |number: usize| scene.resolved(number).own.cam.is_some();
    if shaft.screw_lead_mm.is_none() {
        return Ok(());
    }
    if shaft.masses_kg.is_some() {
        return Err(SceneError::for_key(
            "cam.masses_kg",
            "hang on a cam shaft, and with cam.screw_lead_mm there is none; leave it out",
        ));
    }
    if let Some(number) = (0..scene.axes.count).find(|&number| !follows(number)) {
        return Err(SceneError::for_key(
            "cam.screw_lead_mm",
            format!(
                "makes a cam of a table for each axis, and axis {number} has none; give its [[axis]] a cam = \"…\""
            ),
        ));
    }
    match (0..scene.axes.count).find(|&number| !scene.resolved(number).drive.kind().takes_pulses())
    {
        None => Ok(()),
        Some(number) => Err(SceneError::for_key(
            "axes.drive",
            format!(
                "axis {number} is a servo with torque setpoints, and those are for cranks, not for screws; give a drive that takes STEP and DIR, such as drive = \"pulse-servo\""
            ),
        )),
    }
}

/// Returns the elastic links between cam and pusher; `None` if the scene has none.
///
/// # Errors
/// Part of their numbers is missing, or given twice.
pub fn links(shaft: &CamShaft) -> Result<Option<Links>, SceneError> {
    let (masses, stiffness) = match (shaft.masses_kg, shaft.stiffness_n_per_mm) {
        (None, None) => {
            let useless = [
                ("cam.dampers_ns_per_m", shaft.dampers_ns_per_m.is_some()),
                ("cam.zeta", shaft.zeta.is_some()),
            ];
            return match useless.iter().find(|(_, given)| *given) {
                Some((key, _)) => Err(SceneError::for_key(
                    *key,
                    "damps nothing: give cam.masses_kg and cam.stiffness_n_per_mm as well, or leave it out",
                )),
                None => Ok(None),
            };
        }
        (Some(masses), Some(stiffness)) => (masses, stiffness),
        (Some(_), None) => return Err(missing("cam.stiffness_n_per_mm", "cam.masses_kg")),
        (None, Some(_)) => return Err(missing("cam.masses_kg", "cam.stiffness_n_per_mm")),
    };
    let stiffness_n_m = stiffness.map(|n_per_mm| n_per_mm * 1e3);
    match (shaft.dampers_ns_per_m, shaft.zeta) {
        (Some(dampers), None) => Ok(Some(Links {
            mass_kg: masses,
            stiffness_n_m,
            damping_n_s_m: dampers,
        })),
        (None, Some(zeta)) => Ok(Some(Links::damped(masses, stiffness_n_m, zeta))),
        (Some(_), Some(_)) => Err(SceneError::for_key(
            "cam.zeta",
            "given together with cam.dampers_ns_per_m, which has the same meaning; leave one out",
        )),
        (None, None) => Err(SceneError::for_key(
            "cam.zeta",
            "missing; give the damping factor of the links, such as 0.1, or cam.dampers_ns_per_m",
        )),
    }
}

fn missing(key: &str, beside: &str) -> SceneError {
    SceneError::for_key(
        key,
        format!("missing beside {beside}; give three, from the shaft to the pusher, or neither"),
    )
}

/// Returns the radius of the crank of equal κ, m.
fn crank_radius_m(cam: &Cam) -> f64 {
    cam.peak_m() / (1.0 + LAMBDA)
}

/// Refuses keys of torque, which have no effect in a scene with cams.
fn check_torque(scene: &Scene) -> Result<(), SceneError> {
    let axes = &scene.axes;
    let friction = (axes.friction_nm != 0.0).then_some("axes.friction_nm");
    match friction.into_iter().chain(keys_of_torque(axes)).next() {
        Some(key) => Err(SceneError::for_key(
            key,
            "concerns torque, but cams turn as commanded, and no model level of [cam] uses it; leave it out",
        )),
        None => Ok(()),
    }
}

impl Table for CamShaft {
    fn key(&self) -> &'static str {
        "cam"
    }

    fn machine_name(&self) -> &'static str {
        super::NAME
    }

    fn list_name(&self) -> &'static str {
        match self.screw_lead_mm {
            Some(_) => "electronic cam",
            None => "cam shaft",
        }
    }

    fn simulation_keys(&self, _: &Scene) -> Vec<&'static str> {
        let keys = [
            ("cam.masses_kg", self.masses_kg.is_some()),
            ("cam.stiffness_n_per_mm", self.stiffness_n_per_mm.is_some()),
            ("cam.dampers_ns_per_m", self.dampers_ns_per_m.is_some()),
            ("cam.zeta", self.zeta.is_some()),
        ];
        given(&keys).collect()
    }

    fn axes(&self) -> RangeInclusive<usize> {
        2..=6
    }

    fn axes_follow_tables(&self) -> bool {
        self.screw_lead_mm.is_some()
    }

    fn make(&self, scene: &Scene) -> Result<Made, SceneError> {
        check_torque(scene)?;
        let shafts = cam_shafts(self)?;
        check_screws(self, scene)?;
        Made::shafts(scene, self.key(), Arc::new(shafts))
    }
}
