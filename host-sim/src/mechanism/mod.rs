//! Mechanisms: from crank angle to platform motion and crank torque, in floating point.
//!
//! [`Mechanism`] is the extension point. An implementation provides the geometry, from which motion and torque follow for
//! all mechanisms. [`Configured`] creates an implementation from a scene's keys. [`AnyMechanism`] is the mechanism that a
//! scene names, and the only one that the machine, its model levels and their bounds use. [`turn_search`] finds the largest
//! value of any function of a crank angle.
//!
//! To add a mechanism, write its file here and add it to the list in `cophase_scene::file`. The tests in `conformance` then cover it too
//! (`docs/recipes/add-a-mechanism.md`).

mod any;
mod configured;
#[cfg(test)]
mod conformance;
pub mod crank_rocker;
mod drawing;
pub mod five_bar;
mod motion;
pub mod scotch_yoke;
pub mod slider_crank;
pub mod turn_search;

pub use any::AnyMechanism;
pub use configured::Configured;
pub use drawing::Mount;
pub use motion::{AtAngle, Load, LoadAtAngle, Mechanism, Platform, SquareLaw};
