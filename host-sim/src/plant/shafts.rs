//! Motors and rotors on the shafts of a plant.

use crate::dynamics::Body;

/// Torques and inertias on the shafts.
#[derive(Clone, Copy, Debug)]
pub struct Shafts<'a> {
    /// Inertia and friction of each rotor, and the machine in the controller's settings.
    pub body: &'a Body,
    /// Torque of each motor less its additional load, N·m.
    pub torques_nm: &'a [f64],
    /// Locked shafts, whose acceleration is 0.
    pub held: &'a [bool],
}

impl Shafts<'_> {
    /// Torque of motor, additional load and dry friction on shaft `i`, N·m, at its speed in rad/s.
    pub fn net_nm(&self, i: usize, omega_rad_s: f64) -> f64 {
        self.torques_nm[i] + self.body.drag_nm(i, omega_rad_s)
    }
}
