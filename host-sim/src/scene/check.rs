//! A scene whose numbers have been checked, and what it asks of the core.
//!
//! `numbers` checks what the core does not know of, `settings` turns the scene's words into the
//! core's, and `program` builds its program; what the core refuses is said at the key that stands in
//! the file.

mod numbers;
mod program;
mod settings;

use cophase_core::controller::Controller;
use cophase_core::settings::SettingsError;

use super::SceneError;
use super::file::{AxisApart, Fidelity, Scene};
use crate::machine::PullOut;
use crate::with_axes;

/// A scene whose numbers have been checked, each by itself and against the others.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The scene.
    pub scene: Scene,
    /// Crank radius over rod length, however it was given.
    pub lambda: f64,
    /// The rung of the ladder, `auto` resolved.
    pub fidelity: Fidelity,
    /// Why that rung, in a sentence.
    pub why: String,
}

impl Checked {
    /// Checks a scene.
    ///
    /// # Errors
    /// The first thing that is wrong, by key, with what would be right. The error has no origin yet.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        let lambda = numbers::lambda(&scene.machine)?;
        if !(2..=6).contains(&scene.axes.count) {
            return Err(SceneError::at(
                "axes.count",
                format!(
                    "{} is outside 2 to 6, the motors that one platform has",
                    scene.axes.count
                ),
            ));
        }
        for (entry, apart) in scene.axis.iter().enumerate() {
            numbers::check_apart(&scene, entry, apart)?;
        }
        PullOut::new(&scene.axes.pull_out)?;
        numbers::check_times(&scene)?;
        numbers::check_bands(&scene.limits)?;
        let (fidelity, why) = rung(&scene)?;
        let checked = Self {
            scene,
            lambda,
            fidelity,
            why,
        };
        // Made once to be checked; it is cheap, and nothing else knows all that the core refuses.
        with_axes!(checked.scene.axes.count, N => checked.controller::<N>().map(|_| ()))?;
        numbers::check_pull_out(&checked.scene)?;
        Ok(checked)
    }

    /// The loop that this scene asks for; `N` is the scene's number of axes.
    ///
    /// # Errors
    /// Settings or a program that the core refuses.
    pub fn controller<const N: usize>(&self) -> Result<Controller<N>, SceneError> {
        let settings = self.settings::<N>();
        let placed = |error| self.placed(error);
        settings.check().map_err(placed)?;
        let mut builder = settings.program_builder();
        program::append(&mut builder, &self.scene.program, "program", 0)?;
        let program = builder.build().map_err(placed)?;
        let mut controller = Controller::new(&settings, program).map_err(placed)?;
        for (entry, apart) in self.scene.axis.iter().enumerate() {
            let turns = fixed::types::I16F48::saturating_from_num(apart.trim_deg / 360.0);
            if !controller.set_trim(apart.number, turns) {
                let limit = self.scene.axes.trim_limit_deg;
                return Err(SceneError::at(
                    format!("axis[{entry}].trim_deg"),
                    format!(
                        "{}° is outside -{limit} to {limit}°; trim less, or raise axes.trim_limit_deg",
                        apart.trim_deg
                    ),
                ));
            }
        }
        Ok(controller)
    }

    /// The core's error at the key that stands in the file: an axis may have apart what most have in common.
    fn placed(&self, error: SettingsError) -> SceneError {
        let SceneError { key, problem, .. } = error.into();
        let Some((axis, name)) = error.entry.zip(key.strip_prefix("axes.")) else {
            return SceneError::at(key, problem);
        };
        let entry = self.scene.axis.iter().position(|a| a.number == axis);
        match entry.map(|entry| (entry, &self.scene.axis[entry])) {
            Some((entry, apart)) if apart.has(name) => {
                SceneError::at(format!("axis[{entry}].{name}"), problem)
            }
            _ => SceneError::at(key, problem),
        }
    }

    /// Whether axis `number` has an index sensor.
    pub fn has_index(&self, number: usize) -> bool {
        self.apart(number)
            .and_then(|apart| apart.index)
            .unwrap_or(self.scene.axes.index)
    }

    /// What axis `number` has apart from the others.
    pub fn apart(&self, number: usize) -> Option<&AxisApart> {
        self.scene.axis.iter().find(|apart| apart.number == number)
    }
}

impl AxisApart {
    /// Whether a key of [`file::Axes`] is given for this axis apart.
    fn has(&self, name: &str) -> bool {
        match name {
            "drive" => self.drive.is_some(),
            "steps_per_turn" => self.steps_per_turn.is_some(),
            "ratio" => self.ratio.is_some(),
            "offset_deg" => self.offset_deg.is_some(),
            "index_deg" => self.index_deg.is_some(),
            _ => false,
        }
    }
}

/// The lowest rung that answers what the scene asks.
fn rung(scene: &Scene) -> Result<(Fidelity, String), SceneError> {
    let has_torque = !scene.axes.pull_out.is_empty();
    match scene.fidelity {
        Fidelity::QuasiStatic if !has_torque => Err(SceneError::at(
            "axes.pull_out",
            "missing; fidelity = \"quasi-static\" compares torques, so give the motors' pull-out torque \
             as [[speed_hz, torque_nm], …], or let fidelity be \"kinematic\"",
        )),
        Fidelity::Auto if has_torque => Ok((
            Fidelity::QuasiStatic,
            "the scene gives the motors' pull-out torque, so whether they keep in step is asked"
                .to_owned(),
        )),
        Fidelity::Auto => Ok((
            Fidelity::Kinematic,
            "the scene says nothing of torque, so only phases and what follows from them are asked"
                .to_owned(),
        )),
        chosen => Ok((chosen, "the scene asks for it".to_owned())),
    }
}
