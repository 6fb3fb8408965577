//! How much model a scene gets, and how it is advanced.

use cophase_methods::Scheme;
use serde::{Deserialize, Serialize};

/// How much model a scene gets; the ladder's model levels are in order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fidelity {
    /// The lowest model level that answers the scene's question.
    #[default]
    Auto,
    /// Axes are where commanded; the platform follows from geometry.
    Kinematic,
    /// The torque that motion needs, against the torque that each motor has.
    QuasiStatic,
    /// All cranks on one shaft, moved by the motors' torque.
    Rigid,
    /// Each crank its own rotor, moved by its motor's torque; the platform tilts.
    Phased,
    /// As phased, on a frame that moves on its suspension; for cams, followers that are masses on springs.
    Elastic,
}

impl Fidelity {
    /// As it is written in scenes and reports.
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

    /// Whether torque moves the cranks on this model level.
    pub const fn moves_by_torque(self) -> bool {
        matches!(self, Self::Rigid | Self::Phased | Self::Elastic)
    }
}

/// How a machine that is integrated is advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Method {
    /// Which method.
    pub name: MethodName,
    /// How many steps it makes in a control tick; by default as many as the machine's fastest mode asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps_per_tick: Option<u32>,
}

impl Method {
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A method by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// What is best for the machine: RK4 at a step that follows its fastest mode; exact where it is linear.
    #[default]
    Auto,
    /// Order 1; unstable without damping.
    ExplicitEuler,
    /// Order 1; keeps energy.
    SymplecticEuler,
    /// Order 2; keeps energy.
    VelocityVerlet,
    /// Order 4.
    Rk4,
    /// Order 2, implicit; keeps energy.
    ImplicitMidpoint,
    /// Order 4, implicit; fast modes die away.
    Sdirk4,
    /// Exact but for the curvature of what drives it; of linear machines alone.
    Exact,
}

impl MethodName {
    /// The method; none if it is to be chosen.
    pub const fn scheme(self) -> Option<Scheme> {
        Some(match self {
            Self::Auto => return None,
            Self::ExplicitEuler => Scheme::ExplicitEuler,
            Self::SymplecticEuler => Scheme::SymplecticEuler,
            Self::VelocityVerlet => Scheme::VelocityVerlet,
            Self::Rk4 => Scheme::Rk4,
            Self::ImplicitMidpoint => Scheme::ImplicitMidpoint,
            Self::Sdirk4 => Scheme::Sdirk4,
            Self::Exact => Scheme::Exact,
        })
    }
}
