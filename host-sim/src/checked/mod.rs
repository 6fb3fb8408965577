//! Checked scene, and the settings that it gives the core.

mod choice;

pub use choice::{Choice, Judged};

use std::sync::Arc;

use cophase_core::controller::Controller;
use cophase_core::problem::SettingsError;
use cophase_core::program::EntrySettings;
use cophase_core::settings::{AxisSettings, Settings};
use cophase_scene::SceneError;
use cophase_scene::file::{CamTable, Fidelity, Scene};
use cophase_scene::program;

use crate::dynamics::{Chosen, scheme};
use crate::machines::cam::off_law;
use crate::machines::{DetachedCrank, Machine};
use crate::mechanism::SquareLaw;

/// Scene whose values have been checked, alone and in combination.
#[derive(Clone, Debug)]
pub struct Checked {
    /// Scene.
    pub scene: Scene,
    /// Settings of the core, the same as in a settings file for a board.
    pub settings: Settings,
    /// Machine that the axes turn.
    pub machine: Arc<dyn Machine>,
    /// Model level; `auto` is resolved.
    pub fidelity: Fidelity,
    /// Choice of the model level, if the scene leaves it open.
    pub choice: Option<Choice>,
    /// Permitted relative error of oscillations by the method's step.
    pub resolution: f64,
    /// Number of halvings of the step that follows from `resolution`, or that the scene sets.
    pub halvings: u32,
}

impl Checked {
    /// Returns true if torque moves the shafts of its machine on its model level.
    pub fn moves_by_torque(&self) -> bool {
        self.machine.moves_by_torque(self.fidelity)
    }

    /// Returns the limit of the tilt of the platform, mrad; `None` for a machine without one.
    pub fn tilt_limit_mrad(&self) -> Option<f64> {
        self.settings.machine.platform()?;
        Some(self.settings.drift.tilt_limit_mrad)
    }

    /// Returns the law between the speed of the master and the amplitude.
    pub fn law(&self) -> SquareLaw {
        self.machine.law()
    }

    /// Returns true if every axis turns once with the master, so that amplitude and speed of the master are those of every axis.
    pub fn turns_with_master(&self) -> bool {
        let axes = &self.settings.axes;
        axes.iter()
            .all(|axis| axis.follower.constant_ratio() == Some(1.0))
    }

    /// Returns the reason for the model level, as a sentence.
    pub fn why(&self) -> &str {
        let chosen = self.choice.as_ref().map(|choice| choice.why.as_str());
        chosen.unwrap_or("the scene sets it")
    }

    /// Returns the key that commands shafts at different phases, if there is one.
    pub fn commanded_apart(&self) -> Option<&'static str> {
        let axes = &self.settings.axes;
        let trims = &self.settings.trims_turns;
        let differ = |one: fn(&AxisSettings) -> f64| {
            axes.windows(2).any(|pair| one(&pair[0]) != one(&pair[1]))
        };
        let ratio = |axis: &AxisSettings| axis.follower.constant_ratio();
        if axes.iter().any(|axis| ratio(axis).is_none()) {
            Some("cam")
        } else if axes
            .windows(2)
            .any(|pair| ratio(&pair[0]) != ratio(&pair[1]))
        {
            Some("ratio")
        } else if differ(|axis| axis.offset_turns) {
            Some("offset_deg")
        } else if trims.windows(2).any(|pair| pair[0] != pair[1]) {
            Some("trim_deg")
        } else {
            None
        }
    }

    /// Returns the key, or the kind of fault, that puts shafts out of phase, if there is one.
    pub fn cranks_apart(&self) -> Option<&'static str> {
        let axes = &self.settings.axes;
        let starts = |i: usize| self.scene.resolved(i).own.start_deg;
        let commanded = self.commanded_apart();
        if commanded.is_some() {
            commanded
        } else if (1..axes.len()).any(|i| starts(i) != starts(0)) {
            Some("start_deg")
        } else if self.scene.has_wrong_drive() {
            Some("drive_steps_per_turn")
        } else if let Some(fault) = self.scene.moving_fault() {
            Some(self.scene.fault[fault].kind.name())
        } else {
            None
        }
    }

    /// Returns a drawing of its machine with its symbols, as SVG text.
    pub fn draw(&self) -> String {
        self.machine.draw(&self.scene.name, &self.settings.axes)
    }

    /// Returns each cam table with the largest difference of its acceleration from its law's, relative to the law's peak. A table of points
    /// has no law.
    pub fn cam_tables(&self) -> impl Iterator<Item = (&CamTable, usize, Option<f64>)> {
        let tables = self.scene.cam_table.iter().zip(&self.settings.cams);
        tables.map(|(table, cam)| {
            let points = &cam.points_turns;
            (table, points.len(), off_law(table, points))
        })
    }

    /// Returns method and step as the scene sets them, and the accuracy for those that it leaves open.
    pub fn chosen(&self) -> Chosen {
        let method = &self.scene.method;
        Chosen {
            scheme: scheme(method.name),
            steps_per_tick: method.steps_per_tick,
            resolution: self.resolution,
            halvings: self.halvings,
        }
    }

    /// Returns the speed of the program's highest level, at most the limit, rev/s.
    pub fn top_speed_hz(&self) -> f64 {
        let levels = self.settings.program.iter().map(|entry| match entry {
            EntrySettings::Segment(segment) => segment.amax_mps2,
            EntrySettings::Repeat { .. } => 0.0,
        });
        self.speed_hz(levels.fold(0.0, f64::max))
    }

    /// Returns the speed at a level of the program, m/s², at most the limit, rev/s.
    pub fn speed_hz(&self, amax_mps2: f64) -> f64 {
        let omega = self.law().speed_for_amax_rad_s(amax_mps2);
        let limits = &self.scene.limits;
        (omega / std::f64::consts::TAU)
            .clamp(limits.homing_speed_hz.min(limits.speed_hz), limits.speed_hz)
    }

    /// Returns the machine of bring-up: the crank of one axis, with its rod detached, and no program. Its index sensor stays.
    #[must_use]
    pub fn only_axis(&self, number: usize) -> Self {
        let mut one = self.clone();
        let renumber = |own: Option<usize>| own.filter(|&own| own == number).map(|_| 0);
        let scene = &mut one.scene;
        scene.axes.count = 1;
        scene.axis.retain(|own| own.number == number);
        scene.axis.iter_mut().for_each(|own| own.number = 0);
        // A fault of another axis, or of two, is none of this crank.
        scene
            .fault
            .retain(|fault| fault.with.is_none() && fault.axis.is_none_or(|axis| axis == number));
        for fault in &mut scene.fault {
            fault.axis = renumber(fault.axis);
        }
        one.settings.keep_axis(number);
        one.fidelity = Fidelity::Kinematic;
        one.machine = Arc::new(DetachedCrank { law: self.law() });
        one.choice = None;
        one
    }

    /// Creates the controller of this scene.
    ///
    /// # Errors
    /// The core refuses the settings or the program.
    pub fn controller(&self) -> Result<Controller, SceneError> {
        self.settings
            .controller()
            .map_err(|error| self.placed(error))
    }

    /// Returns the core's error at the key in the file: under `[[axis]]` if the axis has its own value, else under `[axes]`.
    fn placed(&self, error: SettingsError) -> SceneError {
        if let Some(error) = program::placed(&self.scene.program, &error) {
            return error;
        }
        let SceneError { key, problem, .. } = error.into();
        let Some((axis, name)) = error.entry.zip(key.strip_prefix("axes.")) else {
            return SceneError::for_key(key, problem);
        };
        let entry = self.scene.axis.iter().position(|a| a.number == axis);
        match entry.map(|entry| (entry, &self.scene.axis[entry])) {
            Some((entry, apart)) if apart.has(name) => {
                SceneError::for_key(format!("axis[{entry}].{name}"), problem)
            }
            _ => SceneError::for_key(key, problem),
        }
    }

    /// Returns an error of a key under `[axes]` at the first `[[axis]]` that has its own value, if one has.
    pub fn at_own_entry(&self, mut error: SceneError) -> SceneError {
        if let Some(name) = error.key.strip_prefix("axes.")
            && let Some(entry) = self.scene.axis.iter().position(|axis| axis.has(name))
        {
            error.key = format!("axis[{entry}].{name}");
        }
        error
    }

    /// Returns true if axis `number` has an index sensor.
    pub fn has_index(&self, number: usize) -> bool {
        self.settings
            .axes
            .get(number)
            .is_some_and(|axis| axis.index_turns.is_some())
    }
}
