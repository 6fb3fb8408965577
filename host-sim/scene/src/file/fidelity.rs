//! Model level of a scene, and method of integration.

use super::is_unset;
use cophase_core::settings::key::{optional, or_value};
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

words! {
    /// Model level of a scene, in the order of the levels.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
    pub enum Fidelity {
        /// Lowest model level that answers the scene's questions.
        Auto = "auto",
        /// Cranks are at their commanded phases; the platform follows from geometry.
        Kinematic = "kinematic",
        /// The required torque is compared with that of each motor.
        QuasiStatic = "quasi-static",
        /// All cranks are on one shaft, which the motors' torque moves.
        Rigid = "rigid",
        /// Each crank is a rotor that its motor's torque moves; the platform tilts.
        Phased = "phased",
        /// Like phased, with a frame that moves on its suspension; for cams, followers that are masses on springs.
        Elastic = "elastic",
    }
}

impl Fidelity {
    /// Returns true if torque moves the cranks on this model level.
    pub const fn moves_by_torque(self) -> bool {
        matches!(self, Self::Rigid | Self::Phased | Self::Elastic)
    }
}

keys! {
    /// Method of integration for machines that torque moves.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub struct Method left out if is_unset, {
        /// Name of the method.
        name: MethodName = or_value("auto"),
        /// Number of steps in a control tick. The default follows from the machine's fastest mode.
        steps_per_tick: Option<u32> = optional("4").from(1.0, Method::MAX_STEPS as f64),
    }
}

impl Method {
    /// Largest number of steps in a control tick.
    pub const MAX_STEPS: u32 = 1000;
}

words! {
    /// Name of a method of integration.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum MethodName {
        /// Choice by the machine: RK4 with a step that follows its fastest mode; exact for a linear machine.
        Auto = "auto",
        /// Order 1; unstable without damping.
        ExplicitEuler = "explicit-euler",
        /// Order 1; conserves energy.
        SymplecticEuler = "symplectic-euler",
        /// Order 2; conserves energy.
        VelocityVerlet = "velocity-verlet",
        /// Order 4.
        Rk4 = "rk4",
        /// Order 2, implicit; conserves energy.
        ImplicitMidpoint = "implicit-midpoint",
        /// Order 4, implicit; fast modes decay.
        Sdirk4 = "sdirk4",
        /// Exact except for the curvature of the excitation; for linear machines only.
        Exact = "exact",
    }
}
