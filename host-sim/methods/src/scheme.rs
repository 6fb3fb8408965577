//! The list of methods, and how one is made for a machine and a step.

use core::fmt;

use crate::method::{Fixed, Rule};
use crate::methods::{
    Exact, ExplicitEuler, ImplicitMidpoint, Rk4, Sdirk4, SymplecticEuler, VelocityVerlet,
};
use crate::{Equations, Facts, Method, Refused};

/// One of the methods, by name.
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
    /// All of them, the simplest first.
    pub const ALL: [Self; 7] = [
        Self::ExplicitEuler,
        Self::SymplecticEuler,
        Self::VelocityVerlet,
        Self::Rk4,
        Self::ImplicitMidpoint,
        Self::Sdirk4,
        Self::Exact,
    ];

    /// What is known of the method.
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

    /// Whether the equations offer what the method needs.
    pub fn suits(self, equations: &dyn Equations) -> bool {
        self.facts().needs.met_by(equations)
    }

    /// Makes the method for these equations and a step of `step_s`.
    ///
    /// Refuses a step that is not finite and above 0, and equations that lack what the method needs. It does not
    /// judge whether the step is short enough: that is [`Scheme::check_step`].
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
