//! The in-line slider-crank: a crank of radius R drives a platform through a rod of length L. The platform moves on the
//! line through the crank's axis.
//!
//! Terms:
//! - **crank angle** α, rad, 0 at the dead centre where crank and rod are stretched out;
//! - **crank/rod ratio** λ = R / L;
//! - **x**, m, the platform's distance from the crank axis along the line of travel;
//! - **a** = −x″, m/s², the acceleration *towards the crank axis*. This is the source's sign convention. It makes a
//!   largest, R ω² (1 + λ), at α = 0;
//! - **two-term**: the source's a = R ω² (cos α + λ cos 2α), the first two harmonics at constant speed;
//! - **exact**: without approximation of the geometry, at any speed and angular acceleration.
//!
//! Files: this one contains the motion. [`Extrema`] are the turning points of a, `torque` has the source's torque formula,
//! and `configured` creates the mechanism from the keys of a scene.
//!
//! Not modelled: clearance, elasticity, an offset line of travel, rod and crank masses.

mod configured;
mod extrema;
mod torque;

pub use extrema::{Extrema, Extremum};

use super::drawing::{self, Link, Mount};
use super::turn_search::{TurnPeak, max_over_turn};
use super::{AtAngle, Mechanism};
use crate::sines::sin_cos;

/// Largest crank/rod ratio that is accepted. The source uses 0.1 to 0.6. Above 0.8 (at 0.85) the exact acceleration becomes
/// largest near 90 deg instead of at α = 0. Then amax = R ω² (1 + λ), on which all speeds here are based, is no longer the
/// maximum.
pub const LAMBDA_MAX: f64 = 0.8;

/// Reason why a pair of lengths is not a valid slider-crank.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SliderCrankError {
    /// The crank radius is not a positive, finite length.
    #[error("crank radius {0} m: must be a finite length above 0")]
    Radius(f64),
    /// The rod length is not a positive, finite length.
    #[error("rod length {0} m: must be a finite length above 0")]
    Rod(f64),
    /// The rod is too short for the crank.
    #[error("crank/rod ratio {0}: must be at most {LAMBDA_MAX}; take a longer rod")]
    Ratio(f64),
}

/// An in-line slider-crank of known size.
///
/// ```
/// use host_sim::mechanism::Mechanism;
/// use host_sim::mechanism::slider_crank::SliderCrank;
/// let mechanism = SliderCrank::new(0.004, 0.040)?;
/// assert!((mechanism.stroke_m() - 0.008).abs() < 1e-15);
/// let omega = mechanism.speed_for_amax_rad_s(500.0);
/// assert!((mechanism.amax_mps2(omega) - 500.0).abs() < 1e-9);
/// # Ok::<(), host_sim::mechanism::slider_crank::SliderCrankError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderCrank {
    crank_radius_m: f64,
    rod_length_m: f64,
    /// Ratio of the two lengths, stored because equations of motion need it at every evaluation.
    lambda: f64,
}

impl SliderCrank {
    /// Creates a mechanism with a crank radius and a rod length, both in m.
    ///
    /// Refuses lengths that are not finite and positive, and ratios above [`LAMBDA_MAX`].
    pub fn new(crank_radius_m: f64, rod_length_m: f64) -> Result<Self, SliderCrankError> {
        let is_length = |v: f64| v.is_finite() && v > 0.0;
        if !is_length(crank_radius_m) {
            return Err(SliderCrankError::Radius(crank_radius_m));
        }
        if !is_length(rod_length_m) {
            return Err(SliderCrankError::Rod(rod_length_m));
        }
        let made = Self::of_lengths(crank_radius_m, rod_length_m);
        if made.lambda() > LAMBDA_MAX {
            return Err(SliderCrankError::Ratio(made.lambda()));
        }
        Ok(made)
    }

    fn of_lengths(crank_radius_m: f64, rod_length_m: f64) -> Self {
        Self {
            crank_radius_m,
            rod_length_m,
            lambda: crank_radius_m / rod_length_m,
        }
    }

    /// Creates the mechanism whose largest acceleration at `omega_rad_s` is `amax_mps2`: R = amax / (ω² (1 + λ)), L = R / λ
    /// (source, steps F and G).
    ///
    /// Refuses the same lengths as [`SliderCrank::new`]. A crank at standstill is refused as well, because no radius is sufficient.
    pub fn for_amax(
        amax_mps2: f64,
        omega_rad_s: f64,
        lambda: f64,
    ) -> Result<Self, SliderCrankError> {
        let crank_radius_m = amax_mps2 / (omega_rad_s * omega_rad_s * (1.0 + lambda));
        Self::new(crank_radius_m, crank_radius_m / lambda)
    }

    /// Rod length L, m.
    pub fn rod_length_m(&self) -> f64 {
        self.rod_length_m
    }

    /// Crank/rod ratio λ = R / L, above 0 up to [`LAMBDA_MAX`].
    pub fn lambda(&self) -> f64 {
        self.lambda
    }

    /// Distance between the platform's two dead centres, m: 2 R.
    pub fn stroke_m(&self) -> f64 {
        2.0 * self.crank_radius_m
    }

    /// Angle β between rod and line of travel, rad: sin β = λ sin α.
    pub fn rod_angle_rad(&self, alpha_rad: f64) -> f64 {
        (self.lambda() * alpha_rad.sin()).asin()
    }

    /// Two-term approximation of [`SliderCrank::h`]: cos α + λ cos 2α (source, step F).
    pub fn h_two_term(&self, alpha_rad: f64) -> f64 {
        alpha_rad.cos() + self.lambda() * (2.0 * alpha_rad).cos()
    }

    /// Two-term acceleration a = R ω² (cos α + λ cos 2α), m/s², towards the crank axis, at constant speed (source, step F).
    /// [`SliderCrank::two_term_error`] returns its error.
    pub fn a_two_term_mps2(&self, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        self.crank_radius_m * omega_rad_s * omega_rad_s * self.h_two_term(alpha_rad)
    }

    /// Difference in height between two cranks' sides of the platform, m, for a phase difference of `phase_error_rad` about
    /// a mean angle of `alpha_rad`: |x(α + ε/2) − x(α − ε/2)|.
    pub fn height_mismatch_m(&self, alpha_rad: f64, phase_error_rad: f64) -> f64 {
        let half = 0.5 * phase_error_rad;
        (self.x_m(alpha_rad + half) - self.x_m(alpha_rad - half)).abs()
    }

    /// Largest [`SliderCrank::height_mismatch_m`] of a turn, in m, and its angle. For small errors it is R ε max|s|.
    pub fn worst_height_mismatch(&self, phase_error_rad: f64) -> TurnPeak {
        max_over_turn(|alpha| self.height_mismatch_m(alpha, phase_error_rad))
    }

    /// Largest error of the two-term acceleration, as a fraction of amax, and its angle. It depends on λ only:
    /// λ (1/√(1 − λ²) − 1) / (1 + λ), at 90 and 270 deg.
    pub fn two_term_error(&self) -> TurnPeak {
        let scale = 1.0 / (1.0 + self.lambda());
        max_over_turn(|alpha| (self.h_two_term(alpha) - self.h(alpha)).abs() * scale)
    }
}

impl Mechanism for SliderCrank {
    fn crank_radius_m(&self) -> f64 {
        self.crank_radius_m
    }

    /// Distance x of the platform from the crank axis, m: R cos α + L cos β.
    fn x_m(&self, alpha_rad: f64) -> f64 {
        let shorter = self.lambda() * alpha_rad.sin();
        self.crank_radius_m * alpha_rad.cos() + self.rod_length_m * (1.0 - shorter * shorter).sqrt()
    }

    /// Speed coefficient s(α) = sin α + λ sin α cos α / √(1 − λ² sin² α), dimensionless: dx/dα = −R s. It equals sin(α + β)
    /// / cos β in the source's torque formula.
    fn s(&self, alpha_rad: f64) -> f64 {
        self.s_and_h(alpha_rad).0
    }

    /// Acceleration coefficient h(α) = cos α + λ (cos 2α + λ² sin⁴ α) / (1 − λ² sin² α)^1.5,
    /// dimensionless: d²x/dα² = −R h. It is ds/dα.
    fn h(&self, alpha_rad: f64) -> f64 {
        self.s_and_h(alpha_rad).1
    }

    #[inline(always)] // so that `s` and `h` alone compute no more than they need
    fn s_and_h(&self, alpha_rad: f64) -> (f64, f64) {
        let (sin, cos) = alpha_rad.sin_cos();
        let lambda = self.lambda();
        let under_root = 1.0 - (lambda * sin).powi(2);
        let root = under_root.sqrt();
        let above = (2.0 * alpha_rad).cos() + lambda * lambda * sin.powi(4);
        (
            sin + lambda * sin * cos / root,
            cos + lambda * above / (under_root * root),
        )
    }

    /// Returns x, s and h together, with one sine and one root for each angle.
    #[inline(always)] // so that its loop is unrolled and vectorised
    fn at_each<const N: usize>(&self, alpha_rad: &[f64; N]) -> [AtAngle; N] {
        let (sines, cosines) = sin_cos(alpha_rad);
        let lambda = self.lambda();
        let (mut x_m, mut s, mut h) = ([0.0; N], [0.0; N], [0.0; N]);
        for i in 0..N {
            let (sin, cos) = (sines[i], cosines[i]);
            let shorter = lambda * sin;
            let under_root = 1.0 - shorter * shorter;
            let root = under_root.sqrt();
            let over_root = root.recip();
            let above = 1.0 + (shorter * shorter - 2.0) * sin * sin;
            x_m[i] = self.crank_radius_m * cos + self.rod_length_m * root;
            s[i] = sin + lambda * sin * cos * over_root;
            h[i] = cos + lambda * above * over_root * over_root * over_root;
        }
        std::array::from_fn(|i| AtAngle {
            x_m: x_m[i],
            s: s[i],
            h: h[i],
        })
    }

    /// Upper bound 1 + λ/2: the sum of the peaks of both sines of the two-term s.
    fn max_s(&self) -> f64 {
        1.0 + 0.5 * self.lambda()
    }

    /// Largest |h|, 1 + λ, for exact and two-term kinematics.
    fn max_h(&self) -> f64 {
        1.0 + self.lambda()
    }

    /// Two-term value (1 + 4 λ)/(1 + λ). The exact one is smaller by 3 λ³/(1 + λ).
    fn peak_sharpness(&self) -> f64 {
        let lambda = self.lambda();
        (1.0 + 4.0 * lambda) / (1.0 + lambda)
    }

    fn links(&self) -> &'static str {
        "rods"
    }

    fn draw(&self, mount: &Mount) -> String {
        drawing::cranks(self, Link::Rod(self.rod_length_m), mount)
    }
}

#[cfg(test)]
mod tests;
