//! The Cophase control loop in virtual time against simulated machines.
#![forbid(unsafe_code)]

pub mod design;
pub mod mechanism;
pub mod trace;
