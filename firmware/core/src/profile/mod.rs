//! From what the platform is to do to how fast the shaft must turn, and back.
//!
//! A profile knows one mechanism. To add a mechanism, add its file and a variant here; what stands
//! before (the program) and behind (the master shaft) does not change.

mod slider_crank;

pub use slider_crank::SliderCrank;

use crate::units::{Amax, Turns};

/// The mechanism between shaft and platform.
#[derive(Clone, Copy, Debug)]
pub enum Profile {
    /// In-line slider-cranks under one platform.
    SliderCrank(SliderCrank),
}

impl Profile {
    /// The steady speed, turns a tick, that gives acceleration amplitude `amax`.
    pub fn speed(&self, amax: Amax) -> Turns {
        match self {
            Self::SliderCrank(crank) => crank.speed(amax),
        }
    }

    /// The acceleration amplitude at the steady speed `speed`, turns a tick, of either sign.
    pub fn amax(&self, speed: Turns) -> Amax {
        match self {
            Self::SliderCrank(crank) => crank.amax(speed),
        }
    }
}
