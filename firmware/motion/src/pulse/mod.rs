//! Step planner: converts one tick of an axis's phase into runs of edges that hardware makes by itself.
//!
//! STEP is a square wave. It rises where the phase crosses a step and falls half a step later. A pulse may therefore
//! lie across the end of a tick without being cut, and is as wide as possible. A [`Run`] is a number of *edges* a period
//! apart. A run without edges is a pause, and only a pause changes DIR. The runs of a tick fill exactly one tick.
//! [`planner`] derives the bound on the edges' times.

pub mod planner;
mod run;
mod runs;
mod sharing;
mod step_rate;
mod steps_per_turn;
mod timing;

pub use planner::{Place, Planner};
pub use run::Run;
pub use runs::{MAX_RUNS, Runs};
pub use sharing::Sharing;
pub use step_rate::StepRates;
pub use steps_per_turn::StepsPerTurn;
pub use timing::PulseTiming;

/// Greatest number of edges in a tick of a stepper axis; checked settings stay within it.
pub const MAX_EDGES: u32 = 4800;
