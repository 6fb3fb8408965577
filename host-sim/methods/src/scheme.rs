//! List of the methods, and their preparation for a machine and a step.

use core::fmt;

use crate::method::Fixed;
use crate::methods::{
    Exact, ExplicitEuler, ImplicitMidpoint, Rk4, Sdirk4, SymplecticEuler, VelocityVerlet,
};
use crate::rule::Rule;
use crate::{Equations, Facts, Method, Refused};

/// Name of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// [`explicit_euler`](crate::methods::explicit_euler)
    ExplicitEuler,
    /// [`symplectic_euler`](crate::methods::symplectic_euler)
    SymplecticEuler,
    /// [`velocity_verlet`](crate::methods::velocity_verlet)
    VelocityVerlet,
    /// [`rk4`](crate::methods::rk4)
    Rk4,
    /// [`implicit_midpoint`](crate::methods::implicit_midpoint)
    ImplicitMidpoint,
    /// [`sdirk4`](crate::methods::sdirk4)
    Sdirk4,
    /// [`exact`](crate::methods::exact)
    Exact,
}

impl Scheme {
    /// All methods, the simplest first.
    pub const ALL: [Self; 7] = [
        Self::ExplicitEuler,
        Self::SymplecticEuler,
        Self::VelocityVerlet,
        Self::Rk4,
        Self::ImplicitMidpoint,
        Self::Sdirk4,
        Self::Exact,
    ];

    /// Properties of the method.
    pub const fn facts(self) -> &'static Facts {
        match self {
            Self::ExplicitEuler => ExplicitEuler::FACTS,
            Self::SymplecticEuler => SymplecticEuler::FACTS,
            Self::VelocityVerlet => VelocityVerlet::FACTS,
            Self::Rk4 => Rk4::FACTS,
            Self::ImplicitMidpoint => ImplicitMidpoint::FACTS,
            Self::Sdirk4 => Sdirk4::FACTS,
            Self::Exact => Exact::FACTS,
        }
    }

    /// Returns true if the equations have the structure that the method requires.
    pub fn suits(self, equations: &dyn Equations) -> bool {
        self.facts().needs.met_by(equations)
    }

    /// Prepares the method for these equations and a step of `step_s`.
    ///
    /// Refuses a step that is not finite and above 0, and equations that lack the required structure. It does not check
    /// whether the step is short enough ([`Scheme::check_step`]).
    pub fn prepare(
        self,
        equations: &dyn Equations,
        step_s: f64,
    ) -> Result<Box<dyn Method>, Refused> {
        match self {
            Self::ExplicitEuler => Fixed::<ExplicitEuler>::prepare(equations, step_s),
            Self::SymplecticEuler => Fixed::<SymplecticEuler>::prepare(equations, step_s),
            Self::VelocityVerlet => Fixed::<VelocityVerlet>::prepare(equations, step_s),
            Self::Rk4 => Fixed::<Rk4>::prepare(equations, step_s),
            Self::ImplicitMidpoint => Fixed::<ImplicitMidpoint>::prepare(equations, step_s),
            Self::Sdirk4 => Fixed::<Sdirk4>::prepare(equations, step_s),
            Self::Exact => Fixed::<Exact>::prepare(equations, step_s),
        }
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.facts().name)
    }
}
