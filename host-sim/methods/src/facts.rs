//! Properties of a method, and its requirements.

use core::fmt;

use crate::Equations;

/// Properties of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// Name, as within a sentence.
    pub name: &'static str,
    /// Order p: on smooth equations, the error after a fixed time is proportional to h^p. Where rates jump (a contact, a kink in
    /// a law), the order of every method falls to 1, unless a step ends at the jump.
    pub order: u32,
    /// Structure that the equations must have.
    pub needs: Needs,
    /// True if the energy of an undamped machine ripples, but does not grow or fall in the long run.
    pub keeps_energy: bool,
    /// Number of evaluations of the rates per step; for an implicit method, that of its iterations on a linear machine.
    pub evaluations: u32,
}

/// Structure that a method requires of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Rates only.
    Rates,
    /// Positions and velocities as the two halves of the state ([`Equations::is_second_order`]).
    SecondOrder,
    /// A constant matrix ([`Equations::linear`]).
    Linear,
}

impl Needs {
    /// Returns true if the equations have this structure.
    pub fn met_by(self, equations: &dyn Equations) -> bool {
        match self {
            Self::Rates => true,
            Self::SecondOrder => equations.is_second_order(),
            Self::Linear => equations.linear().is_some(),
        }
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rates => "rates",
            Self::SecondOrder => "positions and velocities as the two halves of the state",
            Self::Linear => "a linear system with a constant matrix",
        })
    }
}
