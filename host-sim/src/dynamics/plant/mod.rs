//! Machines whose shafts move something other than a platform on cranks: their equations, and their figures.

mod figure;
mod plant_rotors;
mod record;
mod shafts;

pub use figure::Figure;
pub use plant_rotors::PlantRotors;
pub use record::{CloneRecord, Record, State, Tick};
pub use shafts::Shafts;

use std::fmt::Debug;

use super::{MAX, Mode, PlaneMotion};
use crate::drives::Field;
use crate::pose::Pose;

/// Values that a drive law keeps from tick to tick.
pub type Memory = [f64; 4];

/// A machine whose shafts move something other than a platform on cranks. Positions are in rad and m. The shafts' angles
/// come first, in the order of the axes.
pub trait Plant: Debug + Send + Sync {
    /// Position of the moved part on the kinematic model level. The shafts are at `turns`, and turn at the master's speed,
    /// rad/s, and acceleration, rad/s².
    fn pose(&self, turns: &[f64], omega_rad_s: f64, acceleration_rad_s2: f64) -> Pose;

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
    ) -> Option<[f64; MAX]> {
        None
    }

    /// Motion of the part that the shafts move, in a state with these accelerations.
    fn moved(&self, q: &[f64], v: &[f64], a: &[f64]) -> PlaneMotion;

    /// Kinetic and potential energy, J, with rotors of these inertias, kg·m². It is constant without friction, damping and motors.
    fn energy_j(&self, rotors_kgm2: &[f64], q: &[f64], v: &[f64]) -> f64;

    /// Upper bound of the fastest mode without the motors. By default there is none, and the rotors on their motors are the fastest.
    fn fastest_mode(&self) -> Mode {
        Mode::default()
    }

    /// Creates an empty record for the figures of a run.
    fn record(&self) -> Box<dyn Record>;
}
