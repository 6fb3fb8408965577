//! The source's design method for a vibration platform on N slider-cranks, steps A to J.
//!
//! A [`Requirement`] (what the platform must do) becomes a [`Design`] (how large it must be, and how
//! strong its motors): [`design`]. [`write_page`] prints it for people; [`Warning`]s say where the method, or
//! its printed form, misleads.
//!
//! The method weighs the load only. Platform, rods, cranks, friction and motor inertia are covered by a
//! safety factor on the torque, as in the source; nothing here estimates them.

mod report;
mod requirement;
mod scene;
mod steps;
mod warning;

pub use report::write_page;
pub use requirement::Requirement;
pub use steps::{Design, DesignError, design};
pub use warning::Warning;
