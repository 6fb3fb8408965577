//! Checks of a scene's numbers, each by itself and against the others.
//!
//! `numbers` checks what the core does not know of, `settings` turns the scene's words into the
//! core's, `machine` makes its mechanism, `cam` makes a crank of a cam for it, and `program` lays its program out; what the core refuses is said at the key that stands in
//! the file.

mod cam;
mod cam_table;
mod correction;
mod faults;
mod level;
mod machine;
mod numbers;
pub(super) mod program;
mod settings;

use std::sync::Arc;

use cophase_core::settings::{DriftSettings, MachineSettings, Problem};

use super::file::{Fidelity, Scene};
use super::{Checked, SceneError, range};
use crate::fidelity;
use crate::machine::{PullOut, RESOLUTION};
use crate::mechanism::{AnyMechanism, Configured};
use crate::plant::Plant;

pub use cam::{Follower, drift as phase_limits};
pub use correction::plant;
pub use machine::machine;
pub use numbers::range as in_range;

impl Checked {
    /// Checks a scene.
    ///
    /// # Errors
    /// The first thing that is wrong, by key, with what would be right. The error has no origin yet.
    pub fn new(mut scene: Scene) -> Result<Self, SceneError> {
        faults::fill(&mut scene);
        if let Some(table) = scene.plant_table() {
            table.fill(&mut scene)?;
        }
        let Kind {
            machine,
            drift,
            cam,
            plant,
        } = kind(&scene)?;
        check_count(&scene, plant.as_deref())?;
        for (entry, overrides) in scene.axis.iter().enumerate() {
            numbers::check_overrides(&scene, entry, overrides)?;
        }
        cam_table::check_axes(&scene)?;
        cam::check_screws(&scene)?;
        PullOut::new(&scene.axes.pull_out)?;
        numbers::check_times(&scene)?;
        faults::check(&scene)?;
        numbers::check_torque(&scene)?;
        numbers::check_bands(&scene.limits)?;
        numbers::check_questions(&scene.questions)?;
        let program = program::flat(&scene.program)?;
        let mut checked = Self {
            settings: settings::settings(
                &scene,
                machine,
                drift,
                correction::correction(&scene, &machine)?,
                cam_table::tables(&scene)?,
                program.into_iter().map(|(entry, _)| entry),
            ),
            fidelity: scene.fidelity,
            choice: None,
            resolution: RESOLUTION,
            halvings: 0,
            mechanism: AnyMechanism::of(&machine.mechanism, machine.crank_radius_m),
            cam,
            plant,
            scene,
        };
        // Made once to be checked; it is cheap, and nothing else knows all that the core refuses.
        checked.controller()?;
        numbers::check_steppers(&checked.scene)?;
        if checked.scene.questions.ground_percent.is_some() && checked.scene.frame.is_none() {
            return Err(SceneError::at(
                "questions.ground_percent",
                "asks what the ground feels, and only a frame on springs hands that on: give [frame], or leave the question out",
            ));
        }
        if checked.fidelity == Fidelity::Auto {
            let choice = fidelity::choose(&checked)?;
            checked.fidelity = choice.model_level;
            checked.resolution = choice.resolution;
            checked.choice = Some(choice);
        }
        // The machine as well: what its model level needs is known there.
        let model_level = checked.fidelity;
        checked.on(model_level)
    }
}

/// What a scene's machine amounts to.
struct Kind {
    /// What the core is given of it.
    machine: MachineSettings,
    /// And of its limits.
    drift: DriftSettings,
    cam: Option<Follower>,
    plant: Option<Arc<dyn Plant>>,
}

/// Checks how many axes the machine has.
fn check_count(scene: &Scene, plant: Option<&dyn Plant>) -> Result<(), SceneError> {
    let (counts, what) = match plant {
        Some(plant) => (plant.axes(), plant.name()),
        None => (2..=6, "one platform"),
    };
    let count = scene.axes.count;
    if counts.contains(&count) {
        return Ok(());
    }
    let (least, most) = counts.into_inner();
    let reason = format!("the motors that {what} has");
    let problem = if least == most {
        format!("{count} is not {least}, {reason}; give {least}")
    } else {
        let problem = Problem::out_of_range(count as f64, least as f64, most as f64);
        range::sentence("axes.count", problem, Some(&reason))
    };
    Err(SceneError::at("axes.count", problem))
}

/// The one machine of a scene.
fn kind(scene: &Scene) -> Result<Kind, SceneError> {
    if let Some(table) = scene.plant_table() {
        let others = [
            ("machine", scene.machine.is_some()),
            ("cam", scene.cam.is_some()),
        ];
        if let Some((key, _)) = others.iter().find(|(_, given)| *given) {
            return Err(SceneError::at(
                *key,
                format!(
                    "given together with [{}]; a scene has one machine: leave one out",
                    table.key()
                ),
            ));
        }
        let made = table.make(scene)?;
        return Ok(Kind {
            machine: made.machine,
            drift: made.drift,
            cam: None,
            plant: Some(made.plant),
        });
    }
    match (&scene.machine, &scene.cam) {
        (Some(machine), None) => Ok(Kind {
            machine: machine::machine(machine)?,
            drift: DriftSettings {
                tilt_limit_mrad: scene.drift.tilt_limit_mrad,
                warp_limit_deg: scene.drift.warp_limit_deg,
                common_limit_deg: scene.drift.common_limit_deg,
                reading_error_deg: scene.drift.reading_error_deg,
                lag_s: scene.drift.lag_us * 1e-6,
            },
            cam: None,
            plant: None,
        }),
        (None, Some(shaft)) => {
            cam::check_useless(scene)?;
            let follower = cam::follower(shaft)?;
            let machine = cam::core_settings(&follower);
            Ok(Kind {
                drift: cam::drift(&scene.drift, &machine),
                machine,
                cam: Some(follower),
                plant: None,
            })
        }
        (Some(_), Some(_)) => Err(SceneError::at(
            "cam",
            "given together with [machine]; a scene has cranks under a platform or cams with followers: leave one out",
        )),
        (None, None) => Err(SceneError::at(
            "machine",
            "missing; give [machine], cranks under a platform, or [cam], a cam shaft with its follower on each axis",
        )),
    }
}
