//! Checks of a scene's values, alone and in combination.
//!
//! `numbers` checks values that the core does not have, and `settings` converts the scene's units into the core's. The scene's
//! machine comes from its own [table](crate::machines::Table). An error of the core is reported at the key in the file.

mod cam_table;
mod correction;
mod faults;
mod load;
mod numbers;
mod settings;

use cophase_core::problem::{Problem, SettingsError};
use cophase_link::board;
use cophase_scene::file::{Fidelity, Scene};
use cophase_scene::{SceneError, program, range};

use crate::checked::Checked;
use crate::drives::PullOut;
use crate::dynamics::RESOLUTION;
use crate::machines::{self, Made, Table};
use crate::model_level::choose;

pub use correction::servos;
pub use load::{checked_from_file, checked_from_text, runnable};

impl Checked {
    /// Checks a scene.
    ///
    /// # Errors
    /// First error, with its key and the fix. It has no origin yet.
    pub fn new(mut scene: Scene) -> Result<Self, SceneError> {
        faults::fill(&mut scene);
        // All others count the axes.
        let table = table(&scene)?;
        check_first(&*table, &scene)?;
        numbers::check_gears(&scene)?;
        table.fill(&mut scene)?;
        for (entry, overrides) in scene.axis.iter().enumerate() {
            numbers::check_overrides(&scene, entry, overrides)?;
        }
        cam_table::check_axes(&scene, &*table)?;
        let Made { settings, machine } = table.make(&scene)?;
        PullOut::new(&scene.axes.pull_out)?;
        numbers::check_times(&scene)?;
        faults::check(&scene)?;
        numbers::check_bands(&scene.limits)?;
        let program = program::flat(&scene.program)?;
        let mut checked = Self {
            settings: settings::settings(
                &scene,
                settings,
                correction::correction(&scene, &settings)?,
                cam_table::tables(&scene)?,
                program.into_iter().map(|(entry, _)| entry),
            ),
            fidelity: scene.fidelity,
            choice: None,
            resolution: RESOLUTION,
            halvings: 0,
            machine,
            scene,
        };
        // A controller is created as a check, because only this runs all checks of the core.
        checked.controller()?;
        numbers::check_drives(&checked.scene)?;
        if checked.scene.questions.ground_percent.is_some() && checked.scene.frame.is_none() {
            return Err(SceneError::at(
                "questions.ground_percent",
                "requests the force on the ground, which needs a frame on springs: give [frame], or leave the question out",
            ));
        }
        if checked.fidelity == Fidelity::Auto {
            let choice = choose(&checked)?;
            checked.fidelity = choice.model_level;
            checked.resolution = choice.resolution;
            checked.choice = Some(choice);
        }
        // The machine is created, too, because this checks the data that its model level needs.
        let model_level = checked.fidelity;
        checked.on(model_level)
    }

    /// Checks that a board keeps the tick rate, if one can run the machine.
    ///
    /// # Errors
    /// The key, and the highest rate that a board keeps.
    pub fn check_rate(&self) -> Result<(), SceneError> {
        board::check_rate(&self.settings).map_err(|unfit| {
            let sentence = unfit.to_string();
            let (key, problem) = sentence.split_once(": ").unwrap_or_default();
            SceneError::at(key, problem)
        })
    }
}

/// Checks the number of axes, and the numbers of the limits that depend on no other table.
///
/// # Errors
/// All of these that are wrong.
fn check_first(table: &dyn Table, scene: &Scene) -> Result<(), SceneError> {
    let tick_hz = f64::from(scene.control.tick_hz);
    let ramps = settings::limits(&scene.limits).check_ramps(tick_hz);
    let ramps = ramps.unwrap_or_else(|error| [Err(error), Ok(0.0)]);
    let ramps = ramps.into_iter().filter_map(Result::err);
    let ramps = ramps.map(SettingsError::from).map(SceneError::from);
    let errors = ramps.chain(check_count(table, scene.axes.count).err());
    SceneError::together(errors.collect()).map_or(Ok(()), Err)
}

/// Checks the number of axes.
fn check_count(table: &dyn Table, count: usize) -> Result<(), SceneError> {
    let counts = table.axes();
    if counts.contains(&count) {
        return Ok(());
    }
    let (least, most) = counts.into_inner();
    let reason = format!("the motors that {} has", table.machine_name());
    let problem = if least == most {
        format!("{count} is not {least}, {reason}; give {least}")
    } else {
        let problem = Problem::out_of_range(count as f64, least as f64, most as f64);
        range::sentence("axes.count", problem, Some(&reason))
    };
    Err(SceneError::at("axes.count", problem))
}

/// Returns the table of the scene's one machine.
fn table(scene: &Scene) -> Result<Box<dyn Table>, SceneError> {
    let mut tables = machines::tables(scene);
    let Some(table) = tables.next() else {
        return Err(SceneError::at(
            "machine",
            "missing; give [machine], cranks under a platform, or [cam], a cam shaft with its follower on each axis, or [screen], [crusher] or [five_bar]",
        ));
    };
    match tables.next() {
        None => Ok(table),
        Some(other) => Err(SceneError::at(
            other.key(),
            format!(
                "given together with [{}]; a scene has one machine: leave one out",
                table.key()
            ),
        )),
    }
}
