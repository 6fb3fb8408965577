//! Table of a scene that describes a machine, and what follows from it.

use std::fmt::Debug;
use std::ops::RangeInclusive;
use std::sync::Arc;

use cophase_core::settings::{MachineSettings, ShaftSettings};
use cophase_scene::file::Drift;
use cophase_scene::{Scene, SceneError};

use super::Machine;

/// Table of a scene that describes a machine.
pub trait Table: Debug {
    /// Name of the table in the scene file.
    fn key(&self) -> &'static str;

    /// Its machine's name with the article, for messages: "a screen".
    fn machine_name(&self) -> &'static str;

    /// Name of the machine in lists of scenes. By default it is that of the table.
    fn list_name(&self) -> &'static str {
        self.key()
    }

    /// Keys of its machine that the scene gives, and that concern the simulation alone. By default there are none.
    fn simulation_keys(&self, _: &Scene) -> Vec<&'static str> {
        Vec::new()
    }

    /// Supported numbers of axes. The scene's number is checked before [`Self::fill`] and [`Self::make`].
    fn axes(&self) -> RangeInclusive<usize>;

    /// True if the axes follow cam tables.
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

    /// Checks the table and creates the machine.
    ///
    /// # Errors
    /// A number is out of its range, or the scene has a key that has no meaning for this machine.
    fn make(&self, scene: &Scene) -> Result<Made, SceneError>;
}

/// A machine, and what the controller has to know of it.
#[derive(Clone, Debug)]
pub struct Made {
    /// Machine for the controller.
    pub settings: MachineSettings,
    /// Machine in the simulation.
    pub machine: Arc<dyn Machine>,
}

impl Made {
    /// Creates the machine of a table whose shafts move something other than a platform.
    ///
    /// # Errors
    /// The scene has a key that applies to platforms only.
    pub fn shafts(
        scene: &Scene,
        table: &str,
        machine: Arc<dyn Machine>,
    ) -> Result<Self, SceneError> {
        check_keys_of_platforms(scene, table, machine.axis_noun())?;
        let length_m = machine.law().length_m();
        Ok(Self {
            settings: MachineSettings::Shafts(ShaftSettings { length_m }),
            machine,
        })
    }

    /// Creates the machine of a table whose shafts turn with the master.
    ///
    /// # Errors
    /// Its amplitude over squared speed, which `length_key` determines, is outside 0.1 to 500 mm. Or the scene has a key that applies to
    /// platforms only, a shaft that does not turn once with the master, or a drive that takes torque setpoints.
    pub fn square_law(
        scene: &Scene,
        table: &str,
        length_key: &str,
        machine: Arc<dyn Machine>,
    ) -> Result<Self, SceneError> {
        let made = Self::shafts(scene, table, machine)?;
        let machine = &made.machine;
        let turns_on = |&i: &usize| {
            let (shaft, master) = scene.resolved(i).ratio;
            shaft != master
        };
        if let Some(i) = (0..scene.axes.count).find(turns_on) {
            return Err(SceneError::for_key(
                "axes.ratio",
                format!(
                    "axis {i} does not turn once with the master, and amplitude, bands and figures of {} are those of the master's speed; for a belt \
                     or gearbox give gear = [motor turns, crank turns], and leave this out",
                    machine.name()
                ),
            ));
        }
        if let Some(i) =
            (0..scene.axes.count).find(|&i| !scene.resolved(i).drive.kind().takes_pulses())
        {
            return Err(SceneError::for_key(
                "axes.drive",
                format!(
                    "axis {i} is a servo with torque setpoints, and the controller knows no torque of {}; give a drive that takes STEP and DIR, such as drive = \"pulse-servo\"",
                    machine.name()
                ),
            ));
        }
        let length_m = machine.law().length_m();
        if !(1e-4..=0.5).contains(&length_m) {
            return Err(SceneError::for_key(
                length_key,
                format!(
                    "makes an amplitude of {:.4} mm times the squared speed, outside 0.1 to 500 mm; change it",
                    1e3 * length_m
                ),
            ));
        }
        Ok(made)
    }
}

/// Refuses keys that only a platform has, in the scene of another machine.
fn check_keys_of_platforms(scene: &Scene, table: &str, axis_noun: &str) -> Result<(), SceneError> {
    let of_platform = |key: &str, so: &str| {
        let problem = format!("is of a platform, and [{table}] has none; {so}leave it out");
        Err(SceneError::for_key(key, problem))
    };
    if scene.drift.tilt_limit_mrad != Drift::default().tilt_limit_mrad {
        let so = format!("drift.warp_limit_deg limits how far {axis_noun}s may be apart, so ");
        return of_platform("drift.tilt_limit_mrad", &so);
    }
    let others = [
        ("frame", scene.frame.is_some()),
        ("questions.tilt_mrad", scene.questions.tilt_mrad.is_some()),
        (
            "questions.ground_percent",
            scene.questions.ground_percent.is_some(),
        ),
    ];
    given(&others).try_for_each(|key| of_platform(key, ""))
}

/// Returns the keys that a table gives, of keys with whether it does.
pub fn given(keys: &[(&'static str, bool)]) -> impl Iterator<Item = &'static str> {
    let given = keys.iter().filter(|(_, is_given)| *is_given);
    given.map(|(key, _)| *key)
}
