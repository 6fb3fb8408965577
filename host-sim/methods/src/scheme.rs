//! The list of methods, and how one is made for a machine and a step.

use core::fmt;

use crate::methods::{
    Exact, ExplicitEuler, ImplicitMidpoint, Rk4, Sdirk4, SymplecticEuler, VelocityVerlet, exact,
    explicit_euler, implicit_midpoint, rk4, sdirk4, symplectic_euler, velocity_verlet,
};
use crate::{Equations, Facts, Method, Needs, Refused};

/// One of the methods, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// [`explicit_euler`]
    ExplicitEuler,
    /// [`symplectic_euler`]
    SymplecticEuler,
    /// [`velocity_verlet`]
    VelocityVerlet,
    /// [`rk4`]
    Rk4,
    /// [`implicit_midpoint`]
    ImplicitMidpoint,
    /// [`sdirk4`]
    Sdirk4,
    /// [`exact`]
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
            Self::ExplicitEuler => &explicit_euler::FACTS,
            Self::SymplecticEuler => &symplectic_euler::FACTS,
            Self::VelocityVerlet => &velocity_verlet::FACTS,
            Self::Rk4 => &rk4::FACTS,
            Self::ImplicitMidpoint => &implicit_midpoint::FACTS,
            Self::Sdirk4 => &sdirk4::FACTS,
            Self::Exact => &exact::FACTS,
        }
    }

    /// Whether the equations offer what the method needs.
    pub fn suits(self, equations: &dyn Equations) -> bool {
        offers(equations, self.facts().needs)
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
        Ok(match self {
            Self::ExplicitEuler => Box::new(ExplicitEuler::new(equations, step_s)?),
            Self::SymplecticEuler => Box::new(SymplecticEuler::new(equations, step_s)?),
            Self::VelocityVerlet => Box::new(VelocityVerlet::new(equations, step_s)?),
            Self::Rk4 => Box::new(Rk4::new(equations, step_s)?),
            Self::ImplicitMidpoint => Box::new(ImplicitMidpoint::new(equations, step_s)?),
            Self::Sdirk4 => Box::new(Sdirk4::new(equations, step_s)?),
            Self::Exact => Box::new(Exact::new(equations, step_s)?),
        })
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.facts().name)
    }
}

fn offers(equations: &dyn Equations, needs: Needs) -> bool {
    match needs {
        Needs::Rates => true,
        Needs::SecondOrder => equations.is_second_order(),
        Needs::Linear => equations.linear().is_some(),
    }
}

/// The step, if it is one, and if the equations offer what the method needs.
pub(crate) fn checked_step(
    facts: &Facts,
    equations: &dyn Equations,
    step_s: f64,
) -> Result<f64, Refused> {
    if !(step_s.is_finite() && step_s > 0.0) {
        return Err(Refused::Step(step_s));
    }
    if !offers(equations, facts.needs) {
        return Err(Refused::Structure {
            method: facts.name,
            needs: facts.needs,
            instead: "take RK4, or an implicit method if they are stiff",
        });
    }
    Ok(step_s)
}
