//! Axes: conversion of the master's phase to the phase of each crank by its follower, a gear or a cam table.
//!
//! An axis never has a speed of its own. Each tick it converts the turns of the master to its own, exactly: the remainder
//! of a ratio is kept for the next tick. The sense of rotation is not part of the phase either. A *reversed* axis counts
//! its phase in its own sense, and only the outputs (DIR, and the signs of a servo's setpoints) are inverted. So the
//! phases of axes of equal ratio are exactly equal, whatever their sense of rotation.

mod any_follower;
mod bounds;
mod cam_table;
mod cams;
#[cfg(test)]
mod conformance;
mod follower;
mod gear;
mod spline;

pub use any_follower::{AnyFollower, FollowerSettings};
pub use bounds::Bounds;
pub use cam_table::{
    CAM_SHIFT_DEG, CamSettings, CamTable, CamTableSettings, MAX_ACCELERATION_HZ_PER_S,
    MAX_SPEED_HZ, NET_TURNS,
};
pub use cams::{Cams, MAX_CAMS, NO_CAMS};
pub use follower::Follower;
pub use gear::{Gear, GearSettings, RATIO};
pub use spline::{MAX_CAM_POINTS, MIN_CAM_POINTS, Spline};
