//! Choice of a scene's model level: the lowest that answers its questions within their tolerances.
//!
//! Terms:
//! - a **model level** is a [`Fidelity`](cophase_scene::file::Fidelity); each computes all that the levels below it compute, and more;
//! - an **output** is a result of a run ([`Output`]), such as the largest lag or tilt;
//! - a **question** is an output with a tolerance, from a scene's `[questions]`;
//! - a **bound** limits the difference between an output of a model level and that of the top level, by the effects that the level
//!   neglects.
//!
//! The choice has two steps. [`choose`] computes bounds from dimensionless numbers ([`Bounds`]): torque over pull-out torque, frequency
//! over that of motor and crank, and the resulting phase errors. That needs no run, and is done for every scene with `fidelity =
//! "auto"`. Then [`check`] runs a sample of the scene ([`sample`]) on the top level and on those below, the lowest first. It rejects a
//! level whose difference is too large. As bounds are wide, it takes a level whose difference is well within the tolerance.
//!
//! The report has both the bound and the difference in the sample.

mod answers;
mod check;
mod effort;
pub mod sample;
mod settled;

pub use answers::Answers;
pub use check::{answered, answers, check, compare};
pub use effort::sample_run;
