//! The Cophase control loop in virtual time against simulated machines.
//!
//! The loop itself is [`cophase_core`]'s: the same function that runs on the controller, tick for tick and bit for bit. This crate adds
//! its clock ([`virtual_time`]) and its machine ([`simulated_machine`], [`sim`]). [`machines`] and [`mechanism`] are the mathematics of the
//! machines. The task is a [scene](cophase_scene). `files/` writes traces and reports, `lab/` has design methods, charts and campaigns, and
//! `command/` has the `cophase` command.
#![forbid(unsafe_code)]

pub mod axes;
pub mod checked;
mod drawing;
pub mod drives;
pub mod dynamics;
pub mod faults;
pub mod fidelity;
pub mod live;
pub mod machines;
pub mod mechanism;
pub mod model_level;
pub mod operating_range;
pub mod output;
pub mod pose;
pub mod setup;
pub mod sim;
pub mod simulated_machine;
mod sines;
pub mod style;
pub mod virtual_time;
