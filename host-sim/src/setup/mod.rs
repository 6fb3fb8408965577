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

use cophase_core::problem::Problem;
use cophase_link::board;
use cophase_scene::file::{Fidelity, MACHINES, Scene};
use cophase_scene::{SceneError, program, range};

use crate::checked::Checked;
use crate::drives::PullOut;
use crate::dynamics::RESOLUTION;
use crate::machines::{self, Made, Table};
use crate::model_level::choose;

pub use correction::servos;
pub use load::{checked_from_file, checked_from_text};

impl Checked {
    /// Checks a scene.
    ///
    /// # Errors
    /// The errors of entries and tables, or the first error of their combination, with their keys and fixes. They have no origin yet.
    pub fn new(mut scene: Scene) -> Result<Self, SceneError> {
        faults::fill(&mut scene);
        let table = table(&scene)?;
        let program = fill(&*table, &mut scene)?;
        let Made { settings, machine } = table.make(&scene)?;
        let mut checked = Self {
            settings: settings::settings(
                &scene,
                settings,
                correction::correction(&scene, &*machine)?,
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
        numbers::check_drives(&checked.scene, &*checked.machine)?;
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
            SceneError::for_key(key, problem)
        })
    }
}

/// Fills in what follows from the machine's table, and checks what concerns single entries and tables, whether or not the others are right.
/// Returns the entries of the program.
///
/// # Errors
/// All of these that are wrong. What counts the axes is checked only if their number is right.
fn fill(table: &dyn Table, scene: &mut Scene) -> Result<Vec<program::Placed>, SceneError> {
    let mut errors = numbers::check_tables(scene);
    let filled = check_count(table, scene.axes.count).and_then(|()| table.fill(scene));
    let mut entries = Vec::new();
    match filled {
        Ok(()) => {
            errors.extend(numbers::check_overrides(scene));
            errors.extend(cam_table::check_axes(scene, table));
            errors.extend(faults::check(scene));
            errors.extend(numbers::check_bands(&scene.limits).err());
            errors.extend(PullOut::new(&scene.axes.pull_out).err());
            match program::flat(&scene.program) {
                Ok(flat) => entries = flat,
                Err(error) => errors.push(error),
            }
        }
        Err(error) => errors.push(error),
    }
    SceneError::together(errors).map_or(Ok(entries), Err)
}

/// Checks the number of axes.
fn check_count(table: &dyn Table, count: usize) -> Result<(), SceneError> {
    let counts = table.axes();
    if counts.contains(&count) {
        return Ok(());
    }
    let (min, max) = counts.into_inner();
    let reason = format!("the motors that {} has", table.machine_name());
    let problem = if min == max {
        format!("{count} is not {min}, {reason}; give {min}")
    } else {
        let problem = Problem::out_of_range(count as f64, min as f64, max as f64);
        range::sentence("axes.count", problem, Some(&reason))
    };
    Err(SceneError::for_key("axes.count", problem))
}

/// Returns the table of the scene's machine. The reader refuses a second one.
fn table(scene: &Scene) -> Result<Box<dyn Table>, SceneError> {
    machines::tables(scene).next().ok_or_else(|| {
        let listed = MACHINES.map(|key| format!("[{key}]")).join(" or ");
        let problem = format!("missing; a scene has one machine: give {listed}");
        SceneError::for_key("machine", problem)
    })
}
