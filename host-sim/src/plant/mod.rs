//! Extension point for plants: machines whose shafts move something other than a platform on cranks.
//!
//! The controller, its drives, sensors and faults are the same for all machines. A plant adds the parts that its shafts move:
//! - [`Table`]: its table in a scene file, and the settings of the controller for it;
//! - [`Plant`]: its geometry on the *kinematic* model level, and its equations of motion on the levels above;
//! - [`Record`]: its figures in the report.
//!
//! To add a plant, write a folder here, add the table to [`Scene`] and to its list `plant_table`, and add a built-in scene
//! (`docs/recipes/add-a-machine.md`).

pub mod crusher;
mod figure;
pub mod five_bar;
mod record;
pub mod screen;
mod shafts;

use std::fmt::Debug;
use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::dynamics::{Body, Field, MOST, Mode, PlaneMotion};
use crate::machine::Pose;
use crate::scene::file::{Drift, Fidelity};
use crate::scene::{Scene, SceneError};

pub use figure::Figure;
pub use record::{Record, Recorder, State, Tick};
pub use shafts::Shafts;

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

/// Values that a drive law keeps from tick to tick.
pub type Memory = [f64; 4];

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

/// A machine whose shafts move something other than a platform on cranks. Positions are in rad and m. The shafts' angles
/// come first, in the order of the axes.
pub trait Plant: Debug + Send + Sync {
    /// Name with its article, for messages: "a screen".
    fn name(&self) -> &'static str;

    /// Drawing with its symbols, as SVG text.
    fn draw(&self) -> String;

    /// Supported model levels, the lowest first.
    fn levels(&self) -> &'static [Fidelity];

    /// Motion that a model level gives the machine, in words.
    fn motion(&self, model_level: Fidelity) -> &'static str;

    /// Effects that a model level omits, in words, for readers of the results.
    fn left_out(&self, model_level: Fidelity) -> String;

    /// Position of the moved part on the kinematic model level. The shafts are at `turns`, and turn at the master's speed,
    /// rad/s, and acceleration, rad/s².
    fn pose(&self, turns: &[f64], omega_rad_s: f64, acceleration_rad_s2: f64) -> Pose;

    /// Acceleration that the program's amax is, in words.
    fn amax_words(&self) -> &'static str;

    /// Part that the shafts move, in a word: "box".
    fn moved_part(&self) -> &'static str;

    /// Part that an axis turns, in a word.
    fn axis_noun(&self) -> &'static str {
        "shaft"
    }

    /// True if the moved part pitches.
    fn pitches(&self) -> bool {
        false
    }

    /// Number of positions in the equations of motion: the shafts and the parts that they move.
    fn positions(&self) -> usize;

    /// Sets the positions after the shafts' angles to their values at rest.
    fn rest(&self, positions: &mut [f64]);

    /// Accelerations of all positions, in rad/s² and m/s².
    fn accelerations(&self, shafts: &Shafts<'_>, q: &[f64], v: &[f64], a: &mut [f64]);

    /// Resistance of the plant to forward rotation of a shaft at these positions, N·m, in addition to dry friction. Like that it
    /// only opposes motion. `None` if the plant never resists; this is the default.
    fn resistance_nm(&self, _shaft: usize, _q: &[f64]) -> Option<f64> {
        None
    }

    /// Computes the torques, N·m, of the plant's own drive law for a control tick. They replace each motor's position loop.
    /// `None` if the plant has no such law. `fields` are the commands, `q` and `v` the state at the start of the tick.
    /// `memory` belongs to the law, and is 0 when the drives are switched on.
    fn drive_law(
        &self,
        _fields: &[Field],
        _q: &[f64],
        _v: &[f64],
        _memory: &mut Memory,
        _tick_s: f64,
    ) -> Option<[f64; MOST]> {
        None
    }

    /// Motion of the part that the shafts move, in a state with these accelerations.
    fn moved(&self, q: &[f64], v: &[f64], a: &[f64]) -> PlaneMotion;

    /// Kinetic and potential energy, J. It is constant without friction, damping and motors.
    fn energy_j(&self, body: &Body, q: &[f64], v: &[f64]) -> f64;

    /// Upper bound of the fastest mode without the motors. By default there is none, and the rotors on their motors are the fastest.
    fn fastest_mode(&self) -> Mode {
        Mode::default()
    }

    /// Creates an empty record for the figures of a run.
    fn record(&self) -> Box<dyn Record>;
}
