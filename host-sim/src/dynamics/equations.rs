//! Interface of the equations of motion of a model level.

use std::fmt::Debug;

use super::corners::{FREEDOMS, MAX};
use super::modes::Bound;
use super::{Body, Frame};
use crate::drives::Field;
use crate::pose::Pose;

/// Equations of motion of the shafts of a machine, and of what they move, on one model level.
///
/// Positions are in rad and m. The angles of the shafts come first. State vectors in arguments have the positions `q`, their speeds `v`
/// and their accelerations `a`.
pub trait Dynamics: CloneDynamics + Debug {
    /// Inertia of each rotor, kg·m². The length of the list is the number of axes.
    fn rotors_kgm2(&self) -> &[f64];

    /// Dry friction at an angle, N·m.
    fn friction_nm(&self, angle: usize) -> f64;

    /// Platform that the cranks carry. `None` if they move something else.
    fn body(&self) -> Option<&Body> {
        None
    }

    /// Number of positions, including the angles.
    fn positions(&self) -> usize;

    /// Index of the angle of shaft `i` among the positions. By default each shaft has its own.
    fn angle(&self, i: usize) -> usize {
        i
    }

    /// Number of different angles.
    fn angles(&self) -> usize {
        self.rotors_kgm2().len()
    }

    /// Sets the positions after the angles to those at rest, with the shafts at `alpha_rad`. By default they are 0.
    fn rest(&self, _alpha_rad: &[f64], _positions: &mut [f64]) {}

    /// Computes the accelerations under these torques on the shafts, N·m. Shafts that are `held` do not turn.
    fn accelerations(
        &self,
        q: &[f64],
        v: &[f64],
        torques_nm: &[f64],
        held: &[bool; MAX],
        a: &mut [f64],
    );

    /// Resistance to forward rotation of shaft `i` at these positions, N·m, in addition to dry friction. Like that it only opposes motion.
    /// `None` if there never is any; this is the default.
    fn resistance_nm(&self, _i: usize, _q: &[f64]) -> Option<f64> {
        None
    }

    /// Upper bound of the fastest mode. `rotors` is that of the rotors on their motors.
    fn fastest_mode(&self, rotors: Bound) -> Bound;

    /// The frame, if it moves.
    fn frame(&self) -> Option<&Frame> {
        None
    }

    /// True, by default, if no platform has a position of its own in the equations: a tilt follows from the shafts' angles.
    fn is_geometric(&self) -> bool {
        true
    }

    /// Pose of the part that the shafts move, without their warp. `None`, which is the default, if it follows from the shafts' angles.
    fn pose(&self, _q: &[f64], _v: &[f64], _a: &[f64]) -> Option<Pose> {
        None
    }

    /// Position of the platform. `None` if it follows the shaft, or if there is no platform.
    fn place(&self, _q: &[f64]) -> Option<[f64; FREEDOMS]> {
        None
    }

    /// Kinetic and potential energy, J. It is constant without friction, damping and motors.
    fn energy_j(&self, q: &[f64], v: &[f64]) -> f64;

    /// Starts a control tick of `tick_s`, for a drive law of the machine's own. `fields` are the commands, or `None` if the drives are off.
    fn begin_tick(&mut self, _fields: Option<&[Field]>, _q: &[f64], _v: &[f64], _tick_s: f64) {}

    /// Torques of the machine's own drive law in this tick, N·m. They replace those of the motors. `None` if it has none.
    fn law_nm(&self) -> Option<[f64; MAX]> {
        None
    }
}

/// Copying of boxed [`Dynamics`]. All that are `Clone` implement it.
pub trait CloneDynamics {
    /// Returns a copy.
    fn clone_box(&self) -> Box<dyn Dynamics>;
}

impl<D: Dynamics + Clone + 'static> CloneDynamics for D {
    fn clone_box(&self) -> Box<dyn Dynamics> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Dynamics> {
    fn clone(&self) -> Self {
        (**self).clone_box()
    }
}
