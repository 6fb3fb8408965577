//! In-line slider-crank: amax = R ω² (1 + λ), reached at crank phase 0.
//!
//! R is the crank radius, λ the crank radius over the rod length. The formula is the patent's (two terms of the
//! kinematics). It is exact at phase 0, where the acceleration is greatest. With α the crank phase and β the angle of the
//! rod (sin β = λ sin α), per unit radius
//!
//! - slope s(α) = sin α + λ sin α cos α / cos β,
//! - curvature h(α) = cos α + λ (cos 2α + λ² sin⁴ α) / cos³ β.
//!
//! These are the exact kinematics, not the patent's two terms.

use core::hash::{Hash, Hasher};

use super::{Kinematics, Mechanism, SquareLaw};
use crate::functions::{ONE_Q30, inverse_root_of_one_minus, multiply_q30, sine_cosine};
use crate::problem::SettingsError;
use crate::units::{Amax, Turns};
use cophase_motion::settings::key::{Key, optional};

/// `machine.lambda`
pub const LAMBDA: Key = optional("0.25")
    .from(0.1, 0.6)
    .because("the ratios of crank radius to rod length that this mechanism is built with");

/// Settings of the slider-crank.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct SliderCrankSettings {
    /// Crank radius over rod length, in the range of [`LAMBDA`].
    pub lambda: f64,
}

impl SliderCrankSettings {
    /// Settings for tests of all mechanisms, those of the middle first.
    pub(super) const SAMPLES: &[Self] = &[
        Self { lambda: 0.3 },
        Self { lambda: 0.1 },
        Self { lambda: 0.25 },
        Self { lambda: 0.6 },
    ];

    /// Checks every number.
    ///
    /// # Errors
    /// λ is out of its range.
    #[cold]
    pub fn check(&self) -> Result<(), SettingsError> {
        LAMBDA.check("machine.lambda", self.lambda)?;
        Ok(())
    }
}

/// Coefficients of one slider-crank at one tick rate.
#[derive(Clone, Copy, Debug)]
pub struct SliderCrank {
    law: SquareLaw,
    /// λ and λ², 30 fraction bits.
    lambda: i32,
    lambda_squared: i32,
}

impl SliderCrank {
    /// Coefficients for a crank radius of 0.1 mm to 0.5 m and a tick rate of 500 to 10,000 Hz.
    #[cold]
    pub fn new(settings: &SliderCrankSettings, crank_radius_m: f64, tick_hz: u32) -> Self {
        let lambda = settings.lambda;
        let fixed = |value: f64| libm::round(value * f64::from(ONE_Q30)) as i32;
        Self {
            law: SquareLaw::new(crank_radius_m * (1.0 + lambda), tick_hz),
            lambda: fixed(lambda),
            lambda_squared: fixed(lambda * lambda),
        }
    }
}

impl Mechanism for SliderCrank {
    fn speed(&self, amax: Amax) -> Turns {
        self.law.speed(amax)
    }

    fn amax(&self, speed: Turns) -> Amax {
        self.law.amax(speed)
    }

    #[inline(always)]
    fn hash_half(&self, second: bool, hasher: &mut impl Hasher) {
        let Self {
            law,
            lambda,
            lambda_squared,
        } = self;
        if second {
            (lambda, lambda_squared).hash(hasher);
        } else {
            law.hash(hasher);
        }
    }

    fn kinematics(&self, angle: u32) -> Kinematics {
        let turn = sine_cosine(angle);
        let (sine, cosine) = (turn.sine, turn.cosine);
        let sine_squared = multiply_q30(sine, sine);
        let obliquity = multiply_q30(self.lambda_squared, sine_squared); // sin² β
        let secant = inverse_root_of_one_minus(obliquity); // 1 / cos β
        let slope = sine
            + multiply_q30(
                multiply_q30(self.lambda, sine),
                multiply_q30(cosine, secant),
            );
        let cosine_double = ONE_Q30 - sine_squared - sine_squared;
        let bracket = cosine_double + multiply_q30(obliquity, sine_squared);
        let secant_cubed = multiply_q30(multiply_q30(secant, secant), secant);
        let curvature = cosine + multiply_q30(self.lambda, multiply_q30(bracket, secant_cubed));
        Kinematics { slope, curvature }
    }
}
