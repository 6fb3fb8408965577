//! Parts that the shafts move where these stand as commanded.

use std::fmt::Debug;
use std::sync::Arc;

use cophase_methods::{Scheme, StepError};
use cophase_scene::file::Fidelity;
use serde::{Serialize, Serializer};

use crate::drives::SimulatedAxis;
use crate::dynamics::Chosen;
use crate::dynamics::plant::Plant;
use crate::mechanism::LoadAtAngle;
use crate::pose::Pose;

/// Part that the shafts move, by geometry or by equations of its own. It does not turn the shafts.
///
/// On a model level on which torque moves the shafts, the equations of motion replace its pose where they have one.
pub trait Follower: CloneFollower + Debug {
    /// Plays a tick. By default nothing changes: the pose follows from the shafts alone.
    fn play(&mut self, _: &ShaftTick<'_>) {}

    /// Pose of the part, without the shafts' warp. The shafts are at `turns`, and turn at the master's speed, rad/s, and acceleration, rad/s².
    fn pose(&self, turns: &[f64], omega_rad_s: f64, acceleration_rad_s2: f64) -> Pose;

    /// Tilt of the part, mrad: the magnitude over both directions. `None`, which is the default, if it does not tilt.
    fn tilt_mrad(&self, _turns: &[f64]) -> Option<f64> {
        None
    }

    /// Returns false if [`Self::tilt_mrad`] is certainly not above `mrad`. This check is faster than the tilt itself.
    fn may_tilt_beyond(&self, _mrad: f64, _turns: &[f64]) -> bool {
        false
    }

    /// Load on all shafts together, with all of them at one angle. By default there is none.
    fn load_at(&self, _alpha_rad: f64) -> LoadAtAngle {
        LoadAtAngle::NONE
    }

    /// Accelerations at each sample within the last tick, m/s², its end included. By default there are none beside that of the pose.
    fn within_mps2(&self) -> &[f64] {
        &[]
    }

    /// Motion of each axis's own part at the end of the tick. Empty, which is the default, if the axes have none.
    fn parts(&self) -> &[PartMotion] {
        &[]
    }

    /// Peak values of each axis's own part in the tick. Empty, which is the default, if the axes have none.
    fn peaks(&self) -> &[Peaks] {
        &[]
    }

    /// Integration method and its steps per tick. `None`, which is the default, if nothing is integrated.
    fn method(&self) -> Option<(Scheme, u32)> {
        None
    }

    /// Reason why the equations could not be advanced further, if there is one.
    fn broken(&self) -> Option<StepError> {
        None
    }
}

/// Copying of a boxed [`Follower`]. Every follower that is `Clone` implements it.
pub trait CloneFollower {
    /// Returns a copy.
    fn clone_box(&self) -> Box<dyn Follower>;
}

impl<F: Follower + Clone + 'static> CloneFollower for F {
    fn clone_box(&self) -> Box<dyn Follower> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Follower> {
    fn clone(&self) -> Self {
        (**self).clone_box()
    }
}

/// Run for which a follower is made.
#[derive(Clone, Debug)]
pub struct RunStart<'a> {
    /// Model level.
    pub level: Fidelity,
    /// Control tick, s.
    pub tick_s: f64,
    /// Method and step of integration.
    pub chosen: Chosen,
    /// Positions of the shafts at power-up, turns.
    pub turns: &'a [f64],
    /// Phase of each axis's cam table at the master's phase 0, turns.
    pub shifts_turns: Vec<f64>,
}

/// Motion of the shafts in a tick.
#[derive(Clone, Copy, Debug)]
pub struct ShaftTick<'a> {
    /// Axes, at the end of the tick.
    pub axes: &'a [SimulatedAxis],
    /// True if the drives are on. Shafts stand while they are off.
    pub drives_enabled: bool,
    /// Commanded speed of the master at the end of the tick, rad/s.
    pub omega_rad_s: f64,
    /// Commanded acceleration of the master, rad/s².
    pub acceleration_rad_s2: f64,
    /// Travel of the master, turns.
    pub master_turns: f64,
    /// Commanded positions at the end of the tick, turns.
    pub command_turns: &'a [f64],
}

/// Motion of an axis's own part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PartMotion {
    /// Position, m.
    pub place_m: f64,
    /// Acceleration, m/s².
    pub accel_mps2: f64,
}

/// Greatest values of an axis's own part over some time, each under its name in `report.json`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks([(&'static str, f64); Self::COUNT]);

impl Peaks {
    /// Number of values.
    pub const COUNT: usize = 4;

    /// Creates the peaks of these names and values.
    pub const fn new(values: [(&'static str, f64); Self::COUNT]) -> Self {
        Self(values)
    }

    /// Returns the value of a name.
    pub fn of(&self, name: &str) -> Option<f64> {
        let value = self.0.iter().find(|(own, _)| *own == name);
        value.map(|(_, value)| *value)
    }

    /// Returns the greater of each pair of values, of the same part.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        if self.0[0].0.is_empty() {
            return other;
        }
        Self(std::array::from_fn(|i| {
            let (name, value) = self.0[i];
            (name, value.max(other.0[i].1))
        }))
    }
}

impl Serialize for Peaks {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = self.0.iter().filter(|(name, _)| !name.is_empty());
        serializer.collect_map(values.copied())
    }
}

/// Nothing: the shafts are free.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nothing;

impl Follower for Nothing {
    fn pose(&self, _: &[f64], _: f64, _: f64) -> Pose {
        Pose::default()
    }
}

/// Part of a plant at its steady pose.
#[derive(Clone, Debug)]
pub(super) struct Steady(pub Arc<dyn Plant>);

impl Follower for Steady {
    fn pose(&self, turns: &[f64], omega_rad_s: f64, acceleration_rad_s2: f64) -> Pose {
        self.0.pose(turns, omega_rad_s, acceleration_rad_s2)
    }
}
