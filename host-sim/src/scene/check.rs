//! A scene whose numbers have been checked, and what it asks of the core.
//!
//! `numbers` checks what the core does not know of, `settings` turns the scene's words into the
//! core's, `cam` makes a crank of a cam for it, and `program` lays its program out; what the core refuses is said at the key that stands in
//! the file.

mod cam;
mod correction;
mod faults;
mod numbers;
mod program;
mod settings;

use cophase_core::controller::Controller;
use cophase_core::profile::{Profile, SliderCrank};
use cophase_core::program::EntrySettings;
use cophase_core::settings::{
    AxisSettings, DriftSettings, MachineSettings, Settings, SettingsError,
};
use cophase_core::setup::Setup;

use super::SceneError;
use super::file::{AxisApart, Fidelity, Scene};
use crate::fidelity::{self, Choice};
use crate::machine::{Chosen, Machine, PullOut, RESOLUTION};
use crate::with_axes;

pub use cam::Follower;
pub use correction::plant;

/// A scene whose numbers have been checked, each by itself and against the others.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The scene.
    pub scene: Scene,
    /// What the core is told of it: on a board, in a blob, the very same.
    pub setup: Setup,
    /// Crank radius over rod length, however it was given; of a cam, that of the crank which the core is told.
    pub lambda: f64,
    /// The cam shafts with their followers, where there are no cranks.
    pub cam: Option<Follower>,
    /// The rung of the ladder, `auto` resolved.
    pub fidelity: Fidelity,
    /// What chose it, if the scene left that open.
    pub choice: Option<Choice>,
    /// By how much what swings in the machine may be off by the method's step, of itself.
    pub resolution: f64,
}

impl Checked {
    /// Checks a scene.
    ///
    /// # Errors
    /// The first thing that is wrong, by key, with what would be right. The error has no origin yet.
    pub fn new(mut scene: Scene) -> Result<Self, SceneError> {
        faults::fill(&mut scene);
        let Mechanism {
            machine,
            drift,
            cam,
        } = mechanism(&scene)?;
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
        faults::check(&scene)?;
        numbers::check_torque(&scene)?;
        numbers::check_bands(&scene.limits)?;
        numbers::check_questions(&scene.questions)?;
        let program = program::flat(&scene.program)?;
        let mut checked = Self {
            lambda: machine.lambda,
            setup: settings::setup(
                &scene,
                machine,
                drift,
                correction::correction(&scene, &machine)?,
                program.into_iter().map(|(entry, _)| entry),
            ),
            fidelity: scene.fidelity,
            choice: None,
            resolution: RESOLUTION,
            cam,
            scene,
        };
        // Made once to be checked; it is cheap, and nothing else knows all that the core refuses.
        with_axes!(checked.scene.axes.count, N => checked.controller::<N>().map(|_| ()))?;
        numbers::check_pull_out(&checked.scene)?;
        if checked.scene.questions.ground_percent.is_some() && checked.scene.frame.is_none() {
            return Err(SceneError::at(
                "questions.ground_percent",
                "asks what the ground feels, and only a frame on springs hands that on: give [frame], or leave the question out",
            ));
        }
        if checked.fidelity == Fidelity::Auto {
            let choice = fidelity::choose(&checked)?;
            checked.fidelity = choice.rung;
            checked.resolution = choice.resolution;
            checked.choice = Some(choice);
        }
        // The machine as well: what its rung needs is known there.
        let rung = checked.fidelity;
        checked.on(rung)
    }

    /// The same on a rung.
    ///
    /// # Errors
    /// What the rung needs and the scene does not say.
    pub fn on(&self, rung: Fidelity) -> Result<Self, SceneError> {
        let mut other = self.clone();
        other.fidelity = rung;
        if let Some(follower) = &self.cam {
            cam::check_rung(rung, follower)?;
        } else if rung == Fidelity::QuasiStatic && other.scene.axes.pull_out.is_empty() {
            return Err(SceneError::at(
                "axes.pull_out",
                "missing; fidelity = \"quasi-static\" compares torques, so give the motors' pull-out torque \
                 as [[speed_hz, torque_nm], …], or let fidelity be \"kinematic\"",
            ));
        }
        faults::check_rung(&other, rung)?;
        with_axes!(other.scene.axes.count, N => Machine::<N>::new(&other).map(|_| ()))?;
        Ok(other)
    }

    /// Why this rung, in a sentence.
    pub fn why(&self) -> &str {
        let chosen = self.choice.as_ref().map(|choice| choice.why.as_str());
        chosen.unwrap_or("the scene asks for it")
    }

    /// The key, or the kind of fault, that has cranks stand, or turn, apart from each other, if one does.
    pub fn cranks_apart(&self) -> Option<&'static str> {
        let axes = &self.setup.axes;
        let trims = &self.setup.trims_turns;
        let starts = |i: usize| self.apart(i).map_or(0.0, |apart| apart.start_deg);
        let differ = |one: fn(&AxisSettings) -> f64| {
            axes.windows(2).any(|pair| one(&pair[0]) != one(&pair[1]))
        };
        if differ(|axis| f64::from(axis.ratio.0) / f64::from(axis.ratio.1)) {
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

    /// Method and step: what the scene asks for, and how well what it leaves open must do.
    pub fn chosen(&self) -> Chosen {
        let method = &self.scene.method;
        Chosen {
            scheme: method.name.scheme(),
            steps_per_tick: method.steps_per_tick,
            resolution: self.resolution,
        }
    }

    /// The speed that the program's highest level asks for, at most the limit, rev/s.
    pub fn top_speed_hz(&self) -> f64 {
        let levels = self.setup.program.iter().map(|entry| match entry {
            EntrySettings::Segment(segment) => segment.amax_mps2,
            EntrySettings::Repeat { .. } => 0.0,
        });
        let machine = &self.setup.machine;
        let crank_m = machine.crank_radius_m * (1.0 + machine.lambda);
        let omega = (levels.fold(0.0, f64::max) / crank_m).sqrt();
        let limits = &self.scene.limits;
        (omega / std::f64::consts::TAU).clamp(limits.creep_hz.min(limits.speed_hz), limits.speed_hz)
    }

    /// The loop that this scene asks for; `N` is the scene's number of axes.
    ///
    /// # Errors
    /// Settings or a program that the core refuses.
    pub fn controller<const N: usize>(&self) -> Result<Controller<N>, SceneError> {
        self.setup.controller().map_err(|error| self.placed(error))
    }

    /// The core's settings; `N` is the scene's number of axes.
    ///
    /// # Errors
    /// `N` is another number.
    pub fn settings<const N: usize>(&self) -> Result<Settings<N>, SceneError> {
        self.setup.settings().map_err(|error| self.placed(error))
    }

    /// The profile of this scene's machine.
    pub fn profile(&self) -> Profile {
        let Setup {
            machine, tick_hz, ..
        } = &self.setup;
        Profile::SliderCrank(SliderCrank::new(
            machine.crank_radius_m,
            machine.lambda,
            *tick_hz,
        ))
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
        self.setup
            .axes
            .get(number)
            .is_some_and(|axis| axis.index_turns.is_some())
    }

    /// What axis `number` has apart from the others.
    pub fn apart(&self, number: usize) -> Option<&AxisApart> {
        self.scene.apart(number)
    }
}

impl Scene {
    /// What axis `number` has apart from the others.
    pub fn apart(&self, number: usize) -> Option<&AxisApart> {
        self.axis.iter().find(|apart| apart.number == number)
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
            "trim_deg" => true, // nothing else trims
            _ => false,
        }
    }
}

/// What a scene's mechanism amounts to.
struct Mechanism {
    /// What the core is told of it.
    machine: MachineSettings,
    /// And of its limits.
    drift: DriftSettings,
    cam: Option<Follower>,
}

/// The one mechanism of a scene.
fn mechanism(scene: &Scene) -> Result<Mechanism, SceneError> {
    match (&scene.machine, &scene.cam) {
        (Some(machine), None) => Ok(Mechanism {
            machine: numbers::crank(machine)?,
            drift: DriftSettings {
                tilt_limit_mrad: scene.drift.tilt_limit_mrad,
                warp_limit_deg: scene.drift.warp_limit_deg,
                common_limit_deg: scene.drift.common_limit_deg,
                reading_deg: scene.drift.reading_deg,
                lag_s: scene.drift.lag_us * 1e-6,
            },
            cam: None,
        }),
        (None, Some(shaft)) => {
            cam::check_useless(scene)?;
            let follower = cam::follower(shaft)?;
            let machine = cam::told(&follower);
            Ok(Mechanism {
                drift: cam::drift(&scene.drift, &machine)?,
                machine,
                cam: Some(follower),
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
