//! Motors and rotors on the shafts of a machine of its own kind.

use crate::dynamics::Body;

/// What acts on the shafts.
#[derive(Clone, Copy, Debug)]
pub struct Shafts<'a> {
    /// Inertia and friction of each rotor, and what the controller is given for the machine.
    pub body: &'a Body,
    /// Torque of each motor less its additional load, N·m.
    pub torques_nm: &'a [f64],
    /// Shafts that are held fast: their acceleration is 0.
    pub held: &'a [bool],
}

impl Shafts<'_> {
    /// Torque of motor, additional load and dry friction on shaft `i`, N·m, at its speed in rad/s.
    pub fn net_nm(&self, i: usize, omega_rad_s: f64) -> f64 {
        self.torques_nm[i] + self.body.drag_nm(i, omega_rad_s)
    }
}
