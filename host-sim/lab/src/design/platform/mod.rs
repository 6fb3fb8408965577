//! The source's design method for a vibration platform on N slider-cranks, steps A to J.
//!
//! A [`Requirement`] states the task of the platform. [`design`] turns it into a [`Design`]: the size of the
//! platform and the strength of its motors. [`Warning`]s state where the
//! method, or its printed form, misleads.
//!
//! The method considers only the mass of the load. A safety factor on the torque covers platform, rods,
//! cranks, friction and motor inertia, as in the source. Nothing here estimates them.

mod motor;
mod output;
mod page;
mod requirement;
mod scene;
mod steps;
mod warning;

pub use motor::MotorChoice;
pub use output::Platform;
pub use requirement::Requirement;
pub use steps::{Design, DesignError, design};
pub use warning::Warning;
