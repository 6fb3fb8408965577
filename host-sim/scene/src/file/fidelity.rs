//! Model level of a scene, and method of integration.

use serde::{Deserialize, Serialize};

/// Model level of a scene, in the order of the levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fidelity {
    /// Lowest model level that answers the scene's questions.
    #[default]
    Auto,
    /// Cranks are at their commanded phases; the platform follows from geometry.
    Kinematic,
    /// The required torque is compared with that of each motor.
    QuasiStatic,
    /// All cranks are on one shaft, which the motors' torque moves.
    Rigid,
    /// Each crank is a rotor that its motor's torque moves; the platform tilts.
    Phased,
    /// Like phased, with a frame that moves on its suspension; for cams, followers that are masses on springs.
    Elastic,
}

impl Fidelity {
    /// Returns its name in scenes and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Kinematic => "kinematic",
            Self::QuasiStatic => "quasi-static",
            Self::Rigid => "rigid",
            Self::Phased => "phased",
            Self::Elastic => "elastic",
        }
    }

    /// Returns true if torque moves the cranks on this model level.
    pub const fn moves_by_torque(self) -> bool {
        matches!(self, Self::Rigid | Self::Phased | Self::Elastic)
    }
}

/// Method of integration for machines that torque moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Method {
    /// Name of the method.
    pub name: MethodName,
    /// Number of steps in a control tick. The default follows from the machine's fastest mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps_per_tick: Option<u32>,
}

impl Method {
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Name of a method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// Choice by the machine: RK4 with a step that follows its fastest mode; exact for a linear machine.
    #[default]
    Auto,
    /// Order 1; unstable without damping.
    ExplicitEuler,
    /// Order 1; conserves energy.
    SymplecticEuler,
    /// Order 2; conserves energy.
    VelocityVerlet,
    /// Order 4.
    Rk4,
    /// Order 2, implicit; conserves energy.
    ImplicitMidpoint,
    /// Order 4, implicit; fast modes decay.
    Sdirk4,
    /// Exact except for the curvature of the excitation; for linear machines only.
    Exact,
}
