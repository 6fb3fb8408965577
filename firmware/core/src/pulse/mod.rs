//! Pulses: one tick of an axis's phase, as runs of edges that the hardware makes by itself.
//!
//! STEP is a square wave. It rises where the phase crosses a step and falls half a step later, so
//! that a pulse may lie across the end of a tick without being cut, and is as wide as can be. A
//! [`Run`] is a number of *edges* a period apart; with no edges it is a pause, and only a pause
//! changes DIR. A tick's runs fill exactly one tick. See [`planner`] for the bound on the
//! edges' times, and how it comes about.

pub mod planner;
mod run;

pub use planner::{Planner, PulseTiming};
pub use run::Run;

/// Most runs in a tick: two for every [`planner::CHUNK`] edges, and what the ends and a
/// change of direction take.
pub const MAX_RUNS: usize = 128;

/// Most edges in a tick that [`MAX_RUNS`] are sure to be enough for.
pub const MAX_EDGES: u32 = 4800;

/// The runs of one axis over one tick, in order.
pub type Runs = heapless::Vec<Run, MAX_RUNS>;
