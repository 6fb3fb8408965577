//! How much model a scene needs: the lowest model level of the ladder that answers what it asks, as well as it asks.
//!
//! Words:
//! - a **model level** is a [`Fidelity`](crate::scene::file::Fidelity); each knows all that those below it know, and more;
//! - an **output** is a number that a run comes to ([`Output`]): the largest lag, the largest tilt …;
//! - a **question** is an output with a tolerance, from a scene's `[questions]`;
//! - a **bound** says by how much a model level's output may be off what the top model level has, for what the model level leaves out.
//!
//! It goes in two steps. [`choose`] computes bounds from dimensionless numbers: torque over pull-out torque, frequency over
//! that of motor and crank, and the phase errors that come of them ([`Bounds`]). That needs no run, and is done with every
//! scene that leaves its fidelity to be chosen. Then [`check`] runs a sample of the scene ([`sample`]) on the model level and on the one
//! above, and on those below: a model level whose measured difference is too large is left for the next, and one below whose
//! measured difference is well within tolerance is taken, as bounds are wide.
//!
//! What the sample does not show, the bound has to: both are reported, side by side.

mod answers;
mod bounds;
mod check;
mod choice;
mod choose;
mod effort;
mod output;
pub mod sample;
mod settled;

pub use answers::Answers;
pub use bounds::Bounds;
pub use check::{answered, answers, check, compare};
pub use choice::{Choice, Judged};
pub use choose::{LADDER, available, choose, judge, questions};
pub use effort::{SampleRuns, sample_runs};
pub use output::Output;
