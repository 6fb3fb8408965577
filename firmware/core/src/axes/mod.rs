//! From the master's phase to each crank's: ratio, offset, trim.
//!
//! An axis never has a speed of its own. Each tick it is handed the turns that the master made, and
//! makes of them its own, exactly: what a ratio leaves over is kept for the next tick. Its sense of
//! rotation is not part of its phase either. A *reversed* axis counts its phase in its own sense,
//! and only the outputs (DIR, and the signs of a servo's setpoints) are turned round, so that the
//! phases of axes of equal ratio are equal to the count, whichever way round they are mounted.

mod correction;
mod gear;
mod trim;

pub use correction::Correction;
pub use gear::Gear;
pub use trim::Trim;

use crate::settings::{AxisSettings, turns};
use crate::units::{Phase, Turns};

/// One axis: its place behind the master.
#[derive(Clone, Debug)]
pub struct Axis {
    gear: Gear,
    trim: Trim,
    offset: Phase,
}

impl Axis {
    /// At its offset, untrimmed. The settings must have passed [`crate::settings::Settings::check`].
    #[cold]
    pub fn new(settings: &AxisSettings, tick_hz: u32) -> Self {
        Self {
            gear: Gear::new(settings.ratio.0, settings.ratio.1),
            trim: Trim::new(settings, tick_hz),
            offset: Phase::from_turns(turns(settings.offset_turns)),
        }
    }

    /// Where the crank is to be at power-up, in its own sense of rotation.
    pub const fn offset(&self) -> Phase {
        self.offset
    }

    /// How the axis hangs behind the master.
    pub const fn gear(&self) -> &Gear {
        &self.gear
    }

    /// Its correction.
    pub const fn trim(&self) -> &Trim {
        &self.trim
    }

    /// Its correction, to be set.
    pub const fn trim_mut(&mut self) -> &mut Trim {
        &mut self.trim
    }

    /// Moves on with the master, and by a correction, and returns the turns that the axis makes in this tick.
    pub fn advance(&mut self, master: Turns, correction: Turns) -> Turns {
        let trims = self.trim.advance().wrapping_add(correction);
        self.gear.advance(master).wrapping_add(trims)
    }
}
