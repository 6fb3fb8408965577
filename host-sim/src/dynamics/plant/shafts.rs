//! Torques on the shafts of a plant.

use crate::dynamics::Body;

/// Torques and inertias on the shafts.
#[derive(Clone, Copy, Debug)]
pub struct Shafts<'a> {
    /// Inertia of each rotor, and the machine in the controller's settings.
    pub body: &'a Body,
    /// Torque on each shaft, N·m: of its motor, of dry friction and of resistance, less its additional load.
    pub torques_nm: &'a [f64],
    /// Shafts that are held, whose acceleration is 0.
    pub held: &'a [bool],
}
