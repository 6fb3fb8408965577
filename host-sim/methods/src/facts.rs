//! What is known of a method, and what it needs.

use core::fmt;

use crate::Equations;

/// What is known of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// Name, as in a sentence.
    pub name: &'static str,
    /// Order p: over a fixed time, on smooth equations, the error goes as h^p. Where rates jump (a contact, a kink in a
    /// law) it falls to 1 for whatever method, unless a step ends at the jump.
    pub order: u32,
    /// What the equations must offer.
    pub needs: Needs,
    /// Whether it keeps the energy of an undamped machine for ever, up to a ripple, without gaining or losing.
    pub keeps_energy: bool,
    /// Evaluations of the rates a step; for an implicit method, as many as its iterations need on a linear machine.
    pub evaluations: u32,
}

/// What a method needs of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing but rates.
    Rates,
    /// Positions and velocities as the two halves of the state ([`Equations::is_second_order`]).
    SecondOrder,
    /// A constant matrix ([`Equations::linear`]).
    Linear,
}

impl Needs {
    /// Whether equations offer it.
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
