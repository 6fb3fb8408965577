//! Pulses: one tick of an axis's phase, as runs of edges that the hardware makes by itself.
//!
//! STEP is a square wave. It rises where the phase crosses a step and falls half a step later, so
//! that a pulse may lie across the end of a tick without being cut, and is as wide as can be. A
//! [`Run`] is a number of *edges* a period apart; with no edges it is a pause, and only a pause
//! changes DIR. A tick's runs fill exactly one tick. See [`planner`] for the bound on the
//! edges' times, and how it comes about.

mod pace;
pub mod planner;
mod run;
mod runs;
mod sharing;
mod timing;

pub use pace::Paces;
pub use planner::Planner;
pub use run::Run;
pub use runs::{BLOCK, MAX_RUNS, Runs};
pub use sharing::Sharing;
pub use timing::PulseTiming;

/// Most edges in a tick of a stepper axis; the settings keep to it.
pub const MAX_EDGES: u32 = 4800;
