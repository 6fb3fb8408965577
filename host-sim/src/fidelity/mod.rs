//! Choice of a scene's model level by sample runs, where bounds are too wide.
//!
//! [`check`] runs a sample of the scene ([`sample`]) on the top model level and on those below, the lowest first. It rejects a level
//! whose difference is too large. As bounds ([`model_level`](crate::model_level)) are wide, it takes a level whose difference is well
//! within the tolerance. The report has both the bound and the difference in the sample.

mod answers;
mod check;
mod effort;
pub mod sample;
mod settled;

pub use answers::Answers;
pub use check::{answered, answers, check, compare};
pub use effort::sample_run;
