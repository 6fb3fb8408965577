//! Torques on the shafts of a plant.

/// Torques and inertias on the shafts.
#[derive(Clone, Copy, Debug)]
pub struct Shafts<'a> {
    /// Inertia of each rotor, kg·m².
    pub rotors_kgm2: &'a [f64],
    /// Torque on each shaft, N·m: of its motor, of dry friction and of resistance, less its additional load.
    pub torques_nm: &'a [f64],
    /// Shafts that are held, whose acceleration is 0.
    pub held: &'a [bool],
}
