//! Checked scene, and the settings that it gives the core.

use std::sync::Arc;

use cophase_core::controller::Controller;
use cophase_core::program::EntrySettings;
use cophase_core::settings::{
    AxisSettings, MachineSettings, PlatformSettings, Settings, SettingsError, Transmission,
};

use super::SceneError;
use super::check::{Follower, off_law, program};
use super::file::{AxisOverrides, CamTable, Drive, Fidelity, Scene};
use crate::fidelity::Choice;
use crate::machine::{self, Chosen};
use crate::mechanism::{AnyMechanism, Mechanism, Mount, Platform};
use crate::plant::{Plant, Table};

/// Scene whose values have been checked, alone and in combination.
#[derive(Clone, Debug)]
pub struct Checked {
    /// Scene.
    pub scene: Scene,
    /// Settings of the core, the same as in a settings file for a board.
    pub settings: Settings,
    /// Mechanism of the machine; for cams, the equivalent crank in the settings.
    pub mechanism: AnyMechanism,
    /// Cam shaft with its follower, for machines without cranks.
    pub cam: Option<Follower>,
    /// Machine of another kind, without platform and cam.
    pub plant: Option<Arc<dyn Plant>>,
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
    /// Returns true if the cranks carry a platform, which tilts when they are out of phase.
    pub fn has_platform(&self) -> bool {
        matches!(self.settings.machine, MachineSettings::Platform(_))
    }

    /// Returns the part that an axis of this machine turns, in a word, for sentences: "crank".
    pub fn axis_noun(&self) -> &'static str {
        match (&self.plant, &self.cam) {
            (Some(plant), _) => plant.axis_noun(),
            (None, Some(_)) => "cam",
            (None, None) => "crank",
        }
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

    /// Returns the key, or the kind of fault, that puts cranks out of phase, if there is one.
    pub fn cranks_apart(&self) -> Option<&'static str> {
        let axes = &self.settings.axes;
        let trims = &self.settings.trims_turns;
        let starts = |i: usize| self.overrides(i).map_or(0.0, |own| own.start_deg);
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
        match (&self.settings.machine, &self.plant, &self.cam) {
            (MachineSettings::Platform(platform), ..) => self.mechanism.draw(&self.mount(platform)),
            (_, Some(plant), _) => plant.draw(),
            (_, None, Some(follower)) => machine::draw_follower(follower),
            (_, None, None) => String::new(),
        }
    }

    /// Returns the arrangement of the mechanisms around their platform.
    fn mount(&self, platform: &PlatformSettings) -> Mount {
        Mount {
            name: self.scene.name.clone(),
            reversed: self
                .settings
                .axes
                .iter()
                .map(|axis| axis.reversed)
                .collect(),
            is_below: platform.platform == Platform::Below,
            radius_m: platform.mount_radius_m,
            load_kg: platform.load_kg,
        }
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
            scheme: method.name.scheme(),
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
        let omega = self.mechanism.speed_for_amax_rad_s(amax_mps2);
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
        (one.cam, one.plant, one.choice) = (None, None, None);
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

    /// Returns true if axis `number` has an index sensor.
    pub fn has_index(&self, number: usize) -> bool {
        self.settings
            .axes
            .get(number)
            .is_some_and(|axis| axis.index_turns.is_some())
    }

    /// Returns the values of axis `number` that differ from those of all axes.
    pub fn overrides(&self, number: usize) -> Option<&AxisOverrides> {
        self.scene.overrides(number)
    }
}

impl Scene {
    /// Returns the table of a machine of another kind, if the scene has one.
    pub(crate) fn plant_table(&self) -> Option<Box<dyn Table>> {
        fn boxed<T: Table + Clone + 'static>(table: Option<&T>) -> Option<Box<dyn Table>> {
            table.map(|table| Box::new(table.clone()) as Box<dyn Table>)
        }
        let tables = [
            boxed(self.screen.as_ref()),
            boxed(self.crusher.as_ref()),
            boxed(self.five_bar.as_ref()),
        ];
        tables.into_iter().flatten().next()
    }

    /// Returns the values of axis `number` that differ from those of all axes.
    pub fn overrides(&self, number: usize) -> Option<&AxisOverrides> {
        self.axis.iter().find(|own| own.number == number)
    }

    /// Returns the sensors from which the controller reads phases, for lists: `index`, `encoder`, both, or `none`.
    pub fn sensors(&self) -> String {
        let axes = &self.axes;
        let has_index = |number: &usize| {
            let own = self.overrides(*number).and_then(|own| own.index);
            own.unwrap_or(axes.index)
        };
        let sensing = (0..axes.count).filter(has_index).count();
        let index = match sensing {
            0 => None,
            _ if sensing == axes.count => Some("index".to_owned()),
            _ => Some(format!("{sensing} index")),
        };
        let encoder = axes.encoder.then(|| "encoder".to_owned());
        let all: Vec<String> = index.into_iter().chain(encoder).collect();
        if all.is_empty() {
            "none".to_owned()
        } else {
            all.join(", ")
        }
    }

    /// Returns the corrections of phase errors, for lists: `trim` in each turn, `coupling` in each tick, both, or `none`.
    pub fn corrects(&self) -> String {
        let given = &self.correction;
        let is_coupled = given.couple
            || [given.coupling, given.coupling_per_s]
                .into_iter()
                .flatten()
                .any(|gain| gain != 0.0);
        let all: Vec<&str> = [("trim", given.gain != 0.0), ("coupling", is_coupled)]
            .into_iter()
            .filter_map(|(name, is_on)| is_on.then_some(name))
            .collect();
        if all.is_empty() {
            "none".to_owned()
        } else {
            all.join(", ")
        }
    }

    /// Returns the steps, or encoder counts, per turn of the motor of axis `number`.
    pub fn steps_per_turn(&self, number: usize) -> u32 {
        let own = self.overrides(number).and_then(|own| own.steps_per_turn);
        own.unwrap_or(self.axes.steps_per_turn)
    }

    /// Returns the steps, or encoder counts, per turn of the crank of axis `number`.
    pub fn steps_per_crank_turn(&self, number: usize) -> f64 {
        f64::from(self.steps_per_turn(number)) * self.gear(number).ratio()
    }

    /// Returns the belt or gearbox of axis `number`.
    pub fn gear(&self, number: usize) -> Transmission {
        let own = self.overrides(number).and_then(|own| own.gear);
        let (motor_turns, crank_turns) = own.unwrap_or(self.axes.gear);
        Transmission {
            motor_turns,
            crank_turns,
        }
    }

    /// Returns the drive of axis `number`.
    pub fn drive(&self, number: usize) -> Drive {
        let own = self.overrides(number).and_then(|own| own.drive);
        own.unwrap_or(self.axes.drive)
    }
}

impl AxisOverrides {
    /// Returns true if an `[[axis]]` entry of this axis has its own value for a key of [`file::Axes`].
    fn has(&self, name: &str) -> bool {
        match name {
            "drive" => self.drive.is_some(),
            "steps_per_turn" => self.steps_per_turn.is_some(),
            "gear" => self.gear.is_some(),
            "ratio" => self.ratio.is_some(),
            "offset_deg" => self.offset_deg.is_some(),
            "index" => self.index.is_some(),
            "cam" | "cam_shift_deg" => self.cam.is_some(),
            "index_deg" => self.index_deg.is_some(),
            "trim_deg" => true, // nothing else trims
            _ => false,
        }
    }
}
