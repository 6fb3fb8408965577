//! Parts that the shafts move where these stand as commanded.

use std::fmt::Debug;
use std::sync::Arc;

use cophase_methods::{Scheme, StepError};
use cophase_scene::file::Fidelity;
use serde::Serialize;

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

    /// Tilt of a platform, mrad: the magnitude over both directions. It is 0 by default.
    fn tilt_mrad(&self, _turns: &[f64]) -> f64 {
        0.0
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
    fn pushers(&self) -> &[Pusher] {
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
pub struct Pusher {
    /// Position, m.
    pub place_m: f64,
    /// Acceleration, m/s².
    pub accel_mps2: f64,
}

/// Peak values of an axis's own part, under their names in `report.json`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Peaks {
    /// Largest deviation of the pusher from its law, mm.
    pub off_law_worst_mm: f64,
    /// Largest acceleration of the pusher, m/s².
    pub pusher_accel_worst_mps2: f64,
    /// Largest acceleration of the mass next to the cam, m/s²; for a pusher without a cam, that of
    /// its law.
    pub cam_side_accel_worst_mps2: f64,
    /// Largest deviation of the pusher's acceleration from that of its law, m/s².
    pub off_law_accel_worst_mps2: f64,
}

impl Peaks {
    /// Returns the greater of each pair of values.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            off_law_worst_mm: self.off_law_worst_mm.max(other.off_law_worst_mm),
            pusher_accel_worst_mps2: self
                .pusher_accel_worst_mps2
                .max(other.pusher_accel_worst_mps2),
            cam_side_accel_worst_mps2: self
                .cam_side_accel_worst_mps2
                .max(other.cam_side_accel_worst_mps2),
            off_law_accel_worst_mps2: self
                .off_law_accel_worst_mps2
                .max(other.off_law_accel_worst_mps2),
        }
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
