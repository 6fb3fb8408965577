//! Detection: whether the cranks are beyond a limit. It needs no name of a fault, only whether a crank has moved: then limits are lower by a
//! reading error.
//!
//! - [`angles`] has what several cranks have in common, and [`modes`] separates it from tilt and warp.
//! - [`limits`] says how far the modes may go, and [`evaluate`] compares them in the ticks after an update.

pub(super) mod angles;
mod evaluate;
pub(super) mod limits;
pub(super) mod modes;
