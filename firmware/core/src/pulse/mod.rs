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
mod timing;

pub use pace::Pace;
pub use planner::Planner;
pub use run::Run;
pub use timing::PulseTiming;

/// Most edges in a tick of a stepper axis; the settings keep to it.
pub const MAX_EDGES: u32 = 4800;

/// Most runs in a tick: one for every [`planner::CHUNK`] edges, and what a change of direction (3), the first edge, the
/// two chunks after it and the last one (which the guards make differ from the others: 1 more each, and the last for
/// being short), and the pause at the end take.
pub const MAX_RUNS: usize = (MAX_EDGES / planner::CHUNK) as usize + 9;

/// The runs of one axis over one tick, in order.
pub type Runs = heapless::Vec<Run, MAX_RUNS>;
