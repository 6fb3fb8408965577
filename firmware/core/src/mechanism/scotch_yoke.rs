//! Scotch yoke: a pin on the crank slides in a slot of the platform, which moves as the cosine of the crank angle.
//!
//! With R the crank radius, amax = R ω², reached at crank phases 0 and ½. Per unit radius the slope is sin α and the
//! curvature cos α. It is the limit of a slider-crank with an endless rod, and has no second harmonic.

use core::hash::{Hash, Hasher};

use super::{Kinematics, Mechanism, SquareLaw};
use crate::functions::sine_cosine;
use crate::problem::SettingsError;
use crate::units::{Amax, Turns};

/// Settings of the Scotch yoke. It has none beside its crank radius.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct ScotchYokeSettings {}

impl ScotchYokeSettings {
    /// Settings for tests of all mechanisms, those of the middle first.
    pub(super) const SAMPLES: &[Self] = &[Self {}];

    /// Accepts all settings.
    ///
    /// # Errors
    /// None.
    pub const fn check(&self) -> Result<(), SettingsError> {
        Ok(())
    }
}

/// Coefficients of one Scotch yoke at one tick rate.
#[derive(Clone, Copy, Debug)]
pub struct ScotchYoke {
    law: SquareLaw,
}

impl ScotchYoke {
    pub(super) const STANDSTILL: Self = Self {
        law: SquareLaw::STANDSTILL,
    };

    /// Coefficients for a crank radius of 0.1 mm to 0.5 m and a tick rate of 500 to 10,000 Hz.
    #[cold]
    pub fn new(_: &ScotchYokeSettings, crank_radius_m: f64, tick_hz: u32) -> Self {
        Self {
            law: SquareLaw::new(crank_radius_m, tick_hz),
        }
    }
}

impl Mechanism for ScotchYoke {
    fn speed(&self, amax: Amax) -> Turns {
        self.law.speed(amax)
    }

    fn amax(&self, speed: Turns) -> Amax {
        self.law.amax(speed)
    }

    #[inline(always)]
    fn hash_half(&self, second: bool, hasher: &mut impl Hasher) {
        let Self { law } = self;
        if !second {
            law.hash(hasher);
        }
    }

    fn kinematics(&self, angle: u32) -> Kinematics {
        let turn = sine_cosine(angle);
        Kinematics {
            slope: turn.sine,
            curvature: turn.cosine,
        }
    }
}
