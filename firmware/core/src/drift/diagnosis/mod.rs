//! Diagnosis: the names of faults.
//!
//! - [`events`] names the motion of one crank, by its last events; [`attribution`] finds the crank that moved.
//! - [`findings`] reports a fault once, and again when it has a better name.
//! - [`alternatives`] lists the causes that the sensors cannot distinguish.

pub mod alternatives;
mod attribution;
pub(super) mod events;
pub(super) mod findings;
