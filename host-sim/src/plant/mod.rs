//! Extension point for plants: machines whose shafts move something other than a platform on cranks.
//!
//! The controller, its drives, sensors and faults are the same for all machines. A plant adds the parts that its shafts move:
//! - [`Table`]: its table in a scene file, and the settings of the controller for it;
//! - [`Plant`]: its geometry on the *kinematic* model level, and its equations of motion on the levels above;
//! - [`Record`](crate::dynamics::plant::Record): its figures in the report.
//!
//! To add a plant, write a folder here, add the table to [`Scene`] and to the list of [`table`], and add a built-in scene
//! (`docs/recipes/add-a-machine.md`).

pub mod crusher;
pub mod five_bar;
pub mod screen;

use std::fmt::Debug;
use std::ops::RangeInclusive;
use std::sync::Arc;

use cophase_scene::file::Drift;
use cophase_scene::{Scene, SceneError};

use crate::dynamics::plant::Plant;

/// Table of a scene that describes a plant.
pub trait Table: Debug {
    /// Name of the table in the scene file.
    fn key(&self) -> &'static str;

    /// Its plant's name with the article, for messages: "a screen".
    fn plant_name(&self) -> &'static str;

    /// Supported numbers of axes. The scene's number is checked before [`Self::fill`] and [`Self::make`].
    fn axes(&self) -> RangeInclusive<usize>;

    /// True if the axes follow cam tables, which [`Self::fill`] adds.
    fn axes_follow_tables(&self) -> bool {
        false
    }

    /// Adds the settings that follow from the table: a forbidden band, cam tables, a program. The default adds none.
    ///
    /// # Errors
    /// A number of the table is out of its range, or the scene has a key that the table already determines.
    fn fill(&self, _: &mut Scene) -> Result<(), SceneError> {
        Ok(())
    }

    /// Checks the table and creates the plant.
    ///
    /// # Errors
    /// A number is out of its range, or the scene has a key that has no meaning for this plant.
    fn make(&self, scene: &Scene) -> Result<Made, SceneError>;
}

/// A plant, and what the controller has to know of it.
#[derive(Clone, Debug)]
pub struct Made {
    /// Amplitude over the squared speed of the shafts, m.
    pub length_m: f64,
    /// Plant in the simulation.
    pub plant: Arc<dyn Plant>,
}

impl Made {
    /// Creates a plant whose amplitude is `radius_m` times the squared speed of its shafts.
    ///
    /// # Errors
    /// The radius, which the key of `radius` determines, is outside 0.1 to 500 mm. Or the scene has a key that applies to
    /// platforms only, a shaft that does not turn once with the master, or a drive that takes torque setpoints.
    pub fn square_law(
        scene: &Scene,
        table: &str,
        radius: (&str, f64),
        plant: Arc<dyn Plant>,
    ) -> Result<Self, SceneError> {
        if scene.drift.tilt_limit_mrad != Drift::default().tilt_limit_mrad {
            return Err(SceneError::at(
                "drift.tilt_limit_mrad",
                format!(
                    "is of a platform, and [{table}] has none; drift.warp_limit_deg limits how far shafts may be apart, so leave it out"
                ),
            ));
        }
        let ratio = |i: usize| scene.overrides(i).and_then(|own| own.ratio);
        let turns_on = |&i: &usize| {
            let (shaft, master) = ratio(i).unwrap_or(scene.axes.ratio);
            shaft != master
        };
        if let Some(i) = (0..scene.axes.count).find(turns_on) {
            return Err(SceneError::at(
                "axes.ratio",
                format!(
                    "axis {i} does not turn once with the master, and amplitude, bands and figures of {} are those of the master's speed; for a belt \
                     or gearbox give gear = [motor turns, crank turns], and leave this out",
                    plant.name()
                ),
            ));
        }
        if let Some(i) = (0..scene.axes.count).find(|&i| !scene.drive(i).takes_pulses()) {
            return Err(SceneError::at(
                "axes.drive",
                format!(
                    "axis {i} is a servo with torque setpoints, and the controller knows no torque of {}; give a drive that takes STEP and DIR, such as drive = \"pulse-servo\"",
                    plant.name()
                ),
            ));
        }
        let (key, radius_m) = radius;
        if !(1e-4..=0.5).contains(&radius_m) {
            return Err(SceneError::at(
                key,
                format!(
                    "makes an amplitude of {:.4} mm times the squared speed, outside 0.1 to 500 mm; change it",
                    1e3 * radius_m
                ),
            ));
        }
        Ok(Self {
            length_m: radius_m,
            plant,
        })
    }
}

/// Returns the table of a machine of another kind, if the scene has one.
pub fn table(scene: &Scene) -> Option<Box<dyn Table>> {
    fn boxed<T: Table + Clone + 'static>(table: Option<&T>) -> Option<Box<dyn Table>> {
        table.map(|table| Box::new(table.clone()) as Box<dyn Table>)
    }
    let tables = [
        boxed(scene.screen.as_ref()),
        boxed(scene.crusher.as_ref()),
        boxed(scene.five_bar.as_ref()),
    ];
    tables.into_iter().flatten().next()
}
