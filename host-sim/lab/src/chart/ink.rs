//! Colours and strokes. The colours are those of Okabe and Ito, which colour-blind readers can distinguish. The strokes keep
//! both of two coinciding lines visible.

use cophase_methods::Scheme;

/// Colour, with the name that Okabe and Ito use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Near black.
    Black,
    /// Orange.
    Orange,
    /// Sky blue.
    Sky,
    /// Bluish green.
    Green,
    /// Yellow; thin lines of it are hard to see.
    Yellow,
    /// Blue.
    Blue,
    /// Vermilion.
    Vermilion,
    /// Reddish purple.
    Purple,
    /// Grey, for details.
    Grey,
}

impl Ink {
    /// Returns its form in SVG.
    pub const fn hex(self) -> &'static str {
        match self {
            Self::Black => "#222222",
            Self::Orange => "#E69F00",
            Self::Sky => "#56B4E9",
            Self::Green => "#009E73",
            Self::Yellow => "#F0E442",
            Self::Blue => "#0072B2",
            Self::Vermilion => "#D55E00",
            Self::Purple => "#CC79A7",
            Self::Grey => "#888888",
        }
    }
}

/// Line between points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// Solid line.
    Solid,
    /// Dashed line.
    Dashed,
    /// Dotted line.
    Dotted,
    /// No line.
    None,
}

impl Stroke {
    /// Returns its form in SVG.
    pub const fn dashes(self) -> Option<&'static str> {
        match self {
            Self::Solid | Self::None => None,
            Self::Dashed => Some("7 4"),
            Self::Dotted => Some("2 3"),
        }
    }
}

/// Returns the style of a method, which is the same in all charts.
pub const fn of_scheme(scheme: Scheme) -> (Ink, Stroke) {
    match scheme {
        Scheme::ExplicitEuler => (Ink::Vermilion, Stroke::Solid),
        Scheme::SymplecticEuler => (Ink::Orange, Stroke::Solid),
        Scheme::VelocityVerlet => (Ink::Green, Stroke::Dashed),
        Scheme::Rk4 => (Ink::Blue, Stroke::Solid),
        Scheme::ImplicitMidpoint => (Ink::Purple, Stroke::Solid),
        Scheme::Sdirk4 => (Ink::Sky, Stroke::Dashed),
        Scheme::Exact => (Ink::Black, Stroke::Dashed),
    }
}
