//! Axes: conversion of the master's phase to the phase of each crank by gear and phase offset.
//!
//! An axis never has a speed of its own. Each tick it converts the turns of the master to its own, exactly: the remainder
//! of a ratio is kept for the next tick. The sense of rotation is not part of the phase either. A *reversed* axis counts
//! its phase in its own sense, and only the outputs (DIR, and the signs of a servo's setpoints) are inverted. So the
//! phases of axes of equal ratio are exactly equal, whatever their sense of rotation.

mod correction;
mod gear;
mod phase_offset;

pub use gear::Gear;
pub use phase_offset::{OffsetMotion, PhaseOffsets};
