//! Detection: whether the cranks are beyond a limit. It does not need the name of a fault. It only needs to know whether a crank has moved,
//! as limits are then lower by a reading error.
//!
//! - [`angles`] computes the common part of several cranks, and [`modes`] separates it from tilt and warp.
//! - [`limits`] holds the limits on the modes, and [`evaluate`] compares the modes with them in the ticks after an update.

pub(super) mod angles;
mod evaluate;
pub(super) mod limits;
pub(super) mod modes;
