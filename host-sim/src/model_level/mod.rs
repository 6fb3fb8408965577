//! Choice of a scene's model level without a run: the lowest whose bounds are within the tolerances of its questions.
//!
//! Terms:
//! - a **model level** is a [`Fidelity`](cophase_scene::file::Fidelity); each computes all that the levels below it compute, and more;
//! - an **output** is a result of a run ([`Output`](crate::output::Output)), such as the largest lag or tilt;
//! - a **question** is an output with a tolerance, from a scene's `[questions]`;
//! - a **bound** limits the difference between an output of a model level and that of the top level, by the effects that the level
//!   neglects.
//!
//! [`choose`] computes bounds from dimensionless numbers ([`Bounds`]): torque over pull-out torque, frequency over that of motor and
//! crank, and the resulting phase errors. That is done for every scene with `fidelity = "auto"`.

mod bounds;
mod choose;

pub use bounds::Bounds;
pub use choose::{LADDER, STEP_PART, available, choose, is_undisturbed, judge, questions};
