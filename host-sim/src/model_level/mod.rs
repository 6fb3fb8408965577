//! TODO

mod bounds;
mod choose;
pub use bounds::Bounds;
pub use choose::{LADDER, STEP_PART, available, choose, is_undisturbed, judge, questions};
