//! Machines: the shafts that the axes turn, and the parts that these move. One folder for each.
//!
//! The controller, its drives, sensors and faults are the same for all machines. A machine is:
//! - a [`Table`]: its table in a scene file, and the settings of the controller for it;
//! - a [`Machine`]: its name, drawing and model levels;
//! - a [`Follower`], the part that its shafts move where they stand as commanded, and [`Dynamics`], the equations of motion under torque;
//! - [`Bounds`] on what its lower model levels leave out, and a [`Record`], its figures in the report, if it has any.
//!
//! To add one, write a folder here, and add its table to [`Scene`] and to the list of [`tables`] (`docs/recipes/add-a-machine.md`).

mod bounds;
pub mod cam;
pub mod crusher;
mod detached;
pub mod five_bar;
pub mod follower;
pub mod platform;
pub mod screen;
mod table;

pub use bounds::{Bounds, Duty, NoBounds};
pub use detached::DetachedCrank;
pub use table::{Made, Table, given};

use std::fmt::Debug;
use std::sync::Arc;

use cophase_core::settings::{AxisSettings, Settings};
use cophase_scene::file::Fidelity;
use cophase_scene::{Scene, SceneError};

use crate::dynamics::plant::{Plant, PlantRotors, Record};
use crate::dynamics::{Driven, Dynamics, RotorParts};
use crate::mechanism::SquareLaw;
use follower::{Follower, Nothing, Peaks, RunStart, Steady};

/// Motion of the part that the axes move, as the page of a run shows it beside amplitude, speed and phase errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shown {
    /// Tilt in two directions, with its limit.
    #[default]
    Tilt,
    /// Mean acceleration of parts of this name, such as "pushers". The amplitude is shown without it then.
    Acceleration(&'static str),
    /// Displacement of the part of this name, such as "jaw".
    Displacement(&'static str),
}

/// Machine of a scene, as it is known before a run. It has no state.
pub trait Machine: Debug + Send + Sync {
    /// Name with its article, for messages: "a screen".
    fn name(&self) -> &'static str;

    /// Part that an axis turns, in a word.
    fn axis_noun(&self) -> &'static str {
        "shaft"
    }

    /// Law between the speed of shafts that turn once with the master, and the amplitude.
    fn law(&self) -> SquareLaw;

    /// Motion of the moved part that the page of a run shows.
    fn shown(&self) -> Shown;

    /// True if the moved part pitches.
    fn pitches(&self) -> bool {
        false
    }

    /// Sentence about the program's amax and the greatest acceleration of the moved part in a run, m/s². `None` if there is nothing to say.
    fn about_amax(&self, _accel_worst_mps2: Option<f64>) -> Option<String> {
        None
    }

    /// Drawing with its symbols, as SVG text. `scene` is the name of the scene.
    fn draw(&self, scene: &str, axes: &[AxisSettings]) -> String;

    /// Model levels, the lowest first. By default those of a [`Plant`].
    fn levels(&self) -> &'static [Fidelity] {
        &[Fidelity::Kinematic, Fidelity::Phased]
    }

    /// Checks that the scene has the data that a model level of this machine needs, beyond those of its equations.
    ///
    /// # Errors
    /// The key that is missing.
    fn check_data(&self, _scene: &Scene, _level: Fidelity) -> Result<(), SceneError> {
        Ok(())
    }

    /// Model level for a scene that asks no question, and the reason as a sentence.
    fn level_without_questions(&self) -> (Fidelity, &'static str) {
        (
            Fidelity::Kinematic,
            "the scene has no question about torque, so only phases and the motion that follows from them are required",
        )
    }

    /// Model levels with which the others are compared, the lowest first: the highest for which the scene has data is the *top* level. By
    /// default it is the highest of all.
    fn top_levels(&self) -> &'static [Fidelity] {
        self.levels().last().map_or(&[], std::slice::from_ref)
    }

    /// Bounds on what the lower model levels leave out. By default there are none.
    fn bounds(&self, duty: &Duty<'_>) -> Box<dyn Bounds> {
        Box::new(NoBounds { top: duty.level })
    }

    /// Motion that a model level gives the machine, in words.
    fn motion(&self, level: Fidelity) -> &'static str;

    /// Effects that a model level omits, in words, for readers of the results.
    fn left_out(&self, level: Fidelity) -> String;

    /// Reason for the method of a model level, in words. `None`, which is the default, if it follows from whether torque moves the axes.
    fn about_method(&self, _level: Fidelity) -> Option<&'static str> {
        None
    }

    /// Causes of a large torque on a shaft besides its drive, in words.
    fn causes_of_torque(&self) -> &'static str {
        "and at its load"
    }

    /// True if torque moves the axes on a model level. Elsewhere they are where commanded.
    fn moves_by_torque(&self, level: Fidelity) -> bool {
        level.moves_by_torque()
    }

    /// True if torque moves the axes on one of the model levels. On the others, and in machines without such a level, they are where
    /// commanded.
    fn has_level_of_torque(&self) -> bool {
        let levels = self.levels().iter();
        levels.copied().any(|level| self.moves_by_torque(level))
    }

    /// Part that the axes move where they stand as commanded, at the start of a run. On levels on which torque moves them it gives the geometry.
    ///
    /// # Errors
    /// The method or its step does not suit it.
    fn follower(self: Arc<Self>, _: &RunStart<'_>) -> Result<Box<dyn Follower>, SceneError> {
        Ok(match self.plant() {
            Some(plant) => Box::new(Steady(plant)),
            None => Box::new(Nothing),
        })
    }

    /// Equations of motion on a model level on which torque moves the axes.
    ///
    /// # Errors
    /// The key that the level lacks, or there is no such level.
    fn dynamics(
        self: Arc<Self>,
        level: Fidelity,
        rotors: RotorParts,
    ) -> Result<Box<dyn Dynamics>, SceneError> {
        let name = self.name();
        let Some(plant) = self.plant() else {
            let problem = format!("\"{}\" moves no axis of {name} by torque", level.name());
            return Err(SceneError::for_key("fidelity", problem));
        };
        let RotorParts {
            inertia_kgm2,
            friction_nm,
        } = rotors;
        Ok(Box::new(PlantRotors::new(inertia_kgm2, friction_nm, plant)))
    }

    /// Checks that the motors can turn the shafts as commanded, on a model level on which torque moves them. `apart` is the key, or the kind
    /// of fault, that sets them apart, if one does. By default they can.
    ///
    /// # Errors
    /// The key that sets the shafts too far apart.
    fn check_driven(
        &self,
        _level: Fidelity,
        _driven: &Driven,
        _settings: &Settings,
        _apart: Option<&str>,
    ) -> Result<(), SceneError> {
        Ok(())
    }

    /// Radius of the circle on which the axes stand, m. Without a platform it is 1 m, which leaves warp as it is.
    fn mount_radius_m(&self) -> f64 {
        1.0
    }

    /// Largest inertia that the moved part adds to a shaft, kg·m². `None` if it is not known.
    fn carried_kgm2(&self) -> Option<f64> {
        None
    }

    /// Sentence about the greatest peak values of the axes' own parts in a run on a model level. `None` if the axes have none.
    fn about_parts(&self, _level: Fidelity, _worst: &Peaks) -> Option<String> {
        None
    }

    /// Empty record for the figures of a run. `None` if the machine has no figures of its own.
    fn record(self: Arc<Self>) -> Option<Box<dyn Record>> {
        self.plant().map(|plant| plant.record())
    }

    /// Equations of the part that the shafts move, if they move one part that is no platform. The defaults of [`Self::follower`],
    /// [`Self::dynamics`] and [`Self::record`] follow from it.
    fn plant(self: Arc<Self>) -> Option<Arc<dyn Plant>> {
        None
    }
}

/// Returns the tables of machines that a scene has: one, if the scene is right.
pub fn tables(scene: &Scene) -> impl Iterator<Item = Box<dyn Table>> {
    fn boxed<T: Table + Clone + 'static>(table: Option<&T>) -> Option<Box<dyn Table>> {
        table.map(|table| Box::new(table.clone()) as Box<dyn Table>)
    }
    let tables = [
        boxed(scene.machine.as_ref()),
        boxed(scene.cam.as_ref()),
        boxed(scene.screen.as_ref()),
        boxed(scene.crusher.as_ref()),
        boxed(scene.five_bar.as_ref()),
    ];
    tables.into_iter().flatten()
}
