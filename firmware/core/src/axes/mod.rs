//! Axes: conversion of the master's phase to the phase of each crank by ratio, offset and trim.
//!
//! An axis never has a speed of its own. Each tick it converts the turns of the master to its own, exactly: the remainder
//! of a ratio is kept for the next tick. The sense of rotation is not part of the phase either. A *reversed* axis counts
//! its phase in its own sense, and only the outputs (DIR, and the signs of a servo's setpoints) are inverted. So the
//! phases of axes of equal ratio are exactly equal, whatever their sense of rotation.

mod correction;
mod gear;
mod trim;

pub use correction::Correction;
pub use gear::Gear;
pub use trim::Trim;

use crate::settings::{AxisSettings, turns};
use crate::units::{Phase, Turns};

/// One axis: a follower of the master.
#[derive(Clone, Debug)]
pub struct Axis {
    gear: Gear,
    trim: Trim,
    offset: Phase,
}

impl Axis {
    /// Axis at its offset, without trim. The settings must have passed [`crate::settings::Settings::check`].
    #[cold]
    pub fn new(settings: &AxisSettings, tick_hz: u32) -> Self {
        Self {
            gear: Gear::new(settings.ratio.0, settings.ratio.1),
            trim: Trim::new(settings, tick_hz),
            offset: Phase::from_turns(turns(settings.offset_turns)),
        }
    }

    /// Commanded phase of the crank at power-up, in its own sense of rotation.
    pub const fn offset(&self) -> Phase {
        self.offset
    }

    /// Gear between master and axis.
    pub const fn gear(&self) -> &Gear {
        &self.gear
    }

    /// Trim of the axis.
    pub const fn trim(&self) -> &Trim {
        &self.trim
    }

    /// Trim of the axis, for changes.
    pub const fn trim_mut(&mut self) -> &mut Trim {
        &mut self.trim
    }

    /// Advances with the master and by a correction; returns the axis's own turns in this tick.
    pub fn advance(&mut self, master: Turns, correction: Turns) -> Turns {
        let trims = self.trim.advance().wrapping_add(correction);
        self.gear.advance(master).wrapping_add(trims)
    }
}
