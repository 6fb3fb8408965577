//! `[[program]]`: the program amax(t).

use cophase_core::program::{AMAX_G, HOLD_S, RAMP_S, REPEAT};
use cophase_core::settings::key::optional;
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

keys! {
    /// Entry of the program: a level and the transition to it, or a repeated block.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct Segment {
        /// Level of amax, in units of 9.80665 m/s².
        amax_g: Option<f64> = AMAX_G,
        /// Duration of the transition, s.
        ramp_s: Option<f64> = RAMP_S,
        /// Duration of the hold, s.
        hold_s: Option<f64> = HOLD_S,
        /// Shape of the transition.
        shape: Option<Shape> = optional("linear"),
        /// Number of times that `segments` are played.
        repeat: Option<u32> = REPEAT,
        /// Repeated block; blocks may contain blocks.
        segments: Option<Vec<Segment>> = optional("[{ amax_g = 20, ramp_s = 2, hold_s = 2 }]"),
    }
}

words! {
    /// Shape of the transition to a level.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Shape {
        /// Linear in time.
        Linear = "linear",
        /// Smooth, with a continuous second derivative.
        Smooth = "smooth",
    }
}
