//! Mechanisms: from crank angle to platform motion, in floating point.
//!
//! One file a mechanism. Each takes angles in radians and lengths in metres, is validated when it is
//! made, and cannot fail afterwards. [`turn_search`] finds the largest value of anything that depends
//! on a crank angle.

pub mod slider_crank;
pub mod turn_search;
