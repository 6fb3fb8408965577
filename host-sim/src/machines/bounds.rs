//! Bounds on what the lower model levels of a machine leave out.

use std::fmt::Debug;

use cophase_scene::file::Fidelity;

use crate::dynamics::{Driven, Mode};
use crate::output::Output;

/// Bounds on the difference between an output of each model level and that of the machine's top level.
pub trait Bounds: Debug + Send + Sync {
    /// Returns the bound for an output of a model level, in the unit of its tolerance. It is infinite if the level does not compute the
    /// output, or if there is no bound. Levels that the machine lacks count as the nearest one below them.
    fn of(&self, model_level: Fidelity, output: Output) -> f64;

    /// Mode whose oscillation the method's step must resolve. `None` if none is known; this is the default.
    fn mode(&self) -> Option<Mode> {
        None
    }

    /// Largest distance by which the static response that a model level has in place of an oscillation is off, m. `None`, which is the
    /// default, if the level replaces none.
    fn quasi_static_m(&self, _model_level: Fidelity) -> Option<f64> {
        None
    }

    /// Returns a sentence with the numbers from which the bounds follow.
    fn numbers(&self) -> String;
}

/// Duty of a machine on its top model level: the fastest motion that a scene commands, and the motors that have to follow it.
#[derive(Clone, Debug)]
pub struct Duty<'a> {
    /// The top model level.
    pub level: Fidelity,
    /// Shafts with their motors, if torque moves them on this level.
    pub driven: Option<&'a Driven>,
    /// Greatest speed of the master, rad/s.
    pub top_rad_s: f64,
    /// Greatest acceleration of the master, rad/s².
    pub acceleration_rad_s2: f64,
    /// Greatest jerk of the master, rad/s³.
    pub jerk_rad_s3: f64,
    /// Control tick, s.
    pub tick_s: f64,
    /// Shaft turns per master turn, of each axis.
    pub ratios: Vec<f64>,
    /// Phase relative to the master, of each axis, turns.
    pub offsets: Vec<f64>,
    /// True for an axis with torque feed-forward.
    pub has_feed_forward: Vec<bool>,
    /// Largest difference of two shafts' phases at rest, rad.
    pub standing_apart_rad: f64,
    /// True if the scene commands the shafts at different phases.
    pub leads_apart: bool,
    /// Ratio of the greatest load of a motor at a steady speed; 0 if the torque of none is known.
    pub steady_load: f64,
}

/// Machine without bounds on its lower model levels.
#[derive(Clone, Copy, Debug)]
pub struct NoBounds {
    /// The top level, which leaves nothing out.
    pub top: Fidelity,
}

impl Bounds for NoBounds {
    fn of(&self, model_level: Fidelity, _: Output) -> f64 {
        if model_level == self.top {
            0.0
        } else {
            f64::INFINITY
        }
    }

    fn numbers(&self) -> String {
        "there are no bounds for this machine".to_owned()
    }
}
