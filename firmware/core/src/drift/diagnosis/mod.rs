//! Diagnosis: what a fault is called.
//!
//! - [`events`] names what moved one crank, by its last events; [`attribution`] finds the crank that moved.
//! - [`findings`] reports a fault once, and again when it has a better name.
//! - [`alternatives`] has the causes that the sensors cannot distinguish.

pub mod alternatives;
mod attribution;
pub(super) mod events;
pub(super) mod findings;
