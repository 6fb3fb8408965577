//! The source's design method for a vibration platform on N slider-cranks, steps A to J.
//!
//! A [`Requirement`] (what the platform must do) becomes a [`Design`] (how large it must be, and how
//! strong its motors): [`design`]. [`write_page`] prints it for people; [`Warning`]s say where the method, or
//! its printed form, misleads.
//!
//! The method weighs the load only. Platform, rods, cranks, friction and motor inertia are covered by a
//! safety factor on the torque, as in the source; nothing here estimates them.

pub mod coupling;
mod digits;
mod report;
mod requirement;
mod steps;
mod warning;

pub use report::write_page;
pub use requirement::{OutOfRange, Quantity, Requirement, STANDARD_GRAVITY_MPS2};
pub use steps::{Design, DesignError, design};
pub use warning::Warning;
