//! Curves of the cam tables of a machine.

use super::spline::Spline;

/// Greatest number of cam tables of a machine.
pub const MAX_CAMS: usize = 2;

/// Curves of all cam tables of a machine.
pub type Cams = [Spline; MAX_CAMS];

/// Curves of a machine without cam tables.
pub const NO_CAMS: Cams = [Spline::NONE; MAX_CAMS];
