//! A scene whose numbers have been checked, and what it asks of the core.

use std::sync::Arc;

use cophase_core::controller::Controller;
use cophase_core::program::EntrySettings;
use cophase_core::settings::{AxisSettings, Settings, SettingsError};

use super::SceneError;
use super::check::{Follower, program};
use super::file::{AxisOverrides, Drive, Fidelity, Scene};
use crate::fidelity::Choice;
use crate::machine::{self, Chosen};
use crate::mechanism::{AnyMechanism, Mechanism, Mount, Platform};
use crate::plant::{Plant, Table};

/// A scene whose numbers have been checked, each by itself and against the others.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The scene.
    pub scene: Scene,
    /// What the core is given of it: on a board, in a settings file, the very same.
    pub settings: Settings,
    /// The mechanism of the machine; for cams, the crank that stands for them in the settings.
    pub mechanism: AnyMechanism,
    /// The cam shafts with their followers, where there are no cranks.
    pub cam: Option<Follower>,
    /// The machine of its own kind, where there is neither platform nor cam.
    pub plant: Option<Arc<dyn Plant>>,
    /// The model level of the ladder, `auto` resolved.
    pub fidelity: Fidelity,
    /// What chose it, if the scene left that open.
    pub choice: Option<Choice>,
    /// By how much what swings in the machine may be off by the method's step, of itself.
    pub resolution: f64,
    /// How often the step is halved that follows from it, or that the scene asks for.
    pub halvings: u32,
}

impl Checked {
    /// Whether the cranks carry a platform, which tilts where they are out of phase.
    pub fn has_platform(&self) -> bool {
        self.cam.is_none() && self.plant.is_none()
    }

    /// Why this model level, in a sentence.
    pub fn why(&self) -> &str {
        let chosen = self.choice.as_ref().map(|choice| choice.why.as_str());
        chosen.unwrap_or("the scene asks for it")
    }

    /// The key, or the kind of fault, that has cranks stand, or turn, apart from each other, if one does.
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
        } else if let Some(fault) = self.scene.moving_fault() {
            Some(self.scene.fault[fault].kind.name())
        } else {
            None
        }
    }

    /// Drawing of its machine with its symbols, as SVG text.
    pub fn draw(&self) -> String {
        match (&self.plant, &self.cam) {
            (Some(plant), _) => plant.draw(),
            (None, Some(follower)) => machine::draw_follower(follower),
            (None, None) => self.mechanism.draw(&self.mount()),
        }
    }

    /// How the mechanisms stand around their platform.
    fn mount(&self) -> Mount {
        let machine = &self.settings.machine;
        Mount {
            name: self.scene.name.clone(),
            reversed: self
                .settings
                .axes
                .iter()
                .map(|axis| axis.reversed)
                .collect(),
            is_below: machine.platform == Platform::Below,
            radius_m: machine.mount_radius_m,
            load_kg: machine.load_kg,
        }
    }

    /// Method and step: what the scene asks for, and how well what it leaves open must do.
    pub fn chosen(&self) -> Chosen {
        let method = &self.scene.method;
        Chosen {
            scheme: method.name.scheme(),
            steps_per_tick: method.steps_per_tick,
            resolution: self.resolution,
            halvings: self.halvings,
        }
    }

    /// The speed that the program's highest level asks for, at most the limit, rev/s.
    pub fn top_speed_hz(&self) -> f64 {
        let levels = self.settings.program.iter().map(|entry| match entry {
            EntrySettings::Segment(segment) => segment.amax_mps2,
            EntrySettings::Repeat { .. } => 0.0,
        });
        let omega = self
            .mechanism
            .speed_for_amax_rad_s(levels.fold(0.0, f64::max));
        let limits = &self.scene.limits;
        (omega / std::f64::consts::TAU)
            .clamp(limits.homing_speed_hz.min(limits.speed_hz), limits.speed_hz)
    }

    /// The loop that this scene asks for.
    ///
    /// # Errors
    /// Settings or a program that the core refuses.
    pub fn controller(&self) -> Result<Controller, SceneError> {
        self.settings
            .controller()
            .map_err(|error| self.placed(error))
    }

    /// The core's error at the key that stands in the file: an axis may have apart what most have in common.
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

    /// Whether axis `number` has an index sensor.
    pub fn has_index(&self, number: usize) -> bool {
        self.settings
            .axes
            .get(number)
            .is_some_and(|axis| axis.index_turns.is_some())
    }

    /// What axis `number` has apart from the others.
    pub fn overrides(&self, number: usize) -> Option<&AxisOverrides> {
        self.scene.overrides(number)
    }
}

impl Scene {
    /// Table of the machine of its own kind that the scene describes, if it describes one.
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

    /// What axis `number` has apart from the others.
    pub fn overrides(&self, number: usize) -> Option<&AxisOverrides> {
        self.axis.iter().find(|own| own.number == number)
    }

    /// Sensors from which the controller reads phases, for lists: `index`, `encoder`, both, or `none`.
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

    /// How the controller corrects phase errors, for lists: `trim` in each turn, `coupling` in each tick, both, or `none`.
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

    /// How axis `number` is driven.
    pub fn drive(&self, number: usize) -> Drive {
        let own = self.overrides(number).and_then(|own| own.drive);
        own.unwrap_or(self.axes.drive)
    }
}

impl AxisOverrides {
    /// Whether a key of [`file::Axes`] is given for this axis apart.
    fn has(&self, name: &str) -> bool {
        match name {
            "drive" => self.drive.is_some(),
            "steps_per_turn" => self.steps_per_turn.is_some(),
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
