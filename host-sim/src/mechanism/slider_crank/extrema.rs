//! Turning points of the platform's acceleration over one turn of the crank at constant speed.
//!
//! A short rod (large λ) deforms the lower half of the acceleration curve: the minimum at α = 180 deg splits into two,
//! which are symmetric about it. This happens at λ = 1/4 for the two-term formula. For the exact motion it happens at a
//! slightly larger ratio, [`SliderCrank::LAMBDA_SPLIT_EXACT`].
//!
//! The source prints the value at the two new points as +R ω² (λ + 1/(8λ)). Inserting cos α = −1/(4λ) into its own formula
//! gives the opposite sign, which is used here.

use core::f64::consts::{FRAC_PI_2, PI};

use super::SliderCrank;
use crate::mechanism::Mechanism;

/// Bisection steps on the quarter turn that contains the root. They are enough to reach neighbouring `f64`s.
const BISECTIONS: u32 = 60;

/// A turning point of the acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// Angle, rad, from 0 to π. The curve is even, so 2π minus this angle is a turning point as well.
    pub alpha_rad: f64,
    /// Acceleration, m/s², positive towards the crank axis.
    pub a_mps2: f64,
}

/// All turning points of the acceleration from 0 to π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrema {
    /// Turning point at α = 0: +R ω² (1 + λ), the largest in value and in magnitude.
    pub stretched: Extremum,
    /// Turning point at α = π: −R ω² (1 − λ). It is the minimum if there is no third one, otherwise a small local maximum.
    pub folded: Extremum,
    /// Minimum between the two, if λ is large enough for one.
    pub between: Option<Extremum>,
}

impl Extrema {
    /// Smallest acceleration of the turn.
    pub fn lowest(&self) -> Extremum {
        self.between.unwrap_or(self.folded)
    }
}

impl SliderCrank {
    /// Ratio λ above which the two-term acceleration has a third turning point (source, step F).
    pub const LAMBDA_SPLIT_TWO_TERM: f64 = 0.25;

    /// Ratio λ above which the exact acceleration has a third turning point: (√21 − 3)/6.
    ///
    /// Near α = π, h = λ − 1 + (1 − 4λ + 3λ³) ε²/2 + …. Its curvature vanishes where 3λ³ − 4λ + 1 = (λ − 1)(3λ² + 3λ − 1) = 0.
    pub const LAMBDA_SPLIT_EXACT: f64 = 0.263_762_615_825_973_3;

    /// Turning points of the two-term acceleration at `omega_rad_s`. The third one is at
    /// cos α = −1/(4λ), with a = −R ω² (λ + 1/(8λ)).
    pub fn extrema_two_term(&self, omega_rad_s: f64) -> Extrema {
        let lambda = self.lambda();
        let third = (lambda > Self::LAMBDA_SPLIT_TWO_TERM).then(|| (-0.25 / lambda).acos());
        self.extrema(third, |alpha| self.a_two_term_mps2(alpha, omega_rad_s))
    }

    /// Turning points of the exact acceleration at constant `omega_rad_s`. The angle of the third one is a numerical root,
    /// accurate to rounding.
    pub fn extrema_exact(&self, omega_rad_s: f64) -> Extrema {
        let third = (self.lambda() > Self::LAMBDA_SPLIT_EXACT).then(|| self.exact_third_angle());
        self.extrema(third, |alpha| self.a_exact_mps2(alpha, omega_rad_s, 0.0))
    }

    fn extrema(&self, third: Option<f64>, a_mps2: impl Fn(f64) -> f64) -> Extrema {
        let at = |alpha_rad| Extremum {
            alpha_rad,
            a_mps2: a_mps2(alpha_rad),
        };
        Extrema {
            stretched: at(0.0),
            folded: at(PI),
            between: third.map(at),
        }
    }

    /// Root of (dh/dα) / sin α between π/2, where the value is −1, and π, where it is 4λ − 3λ³ − 1 > 0.
    fn exact_third_angle(&self) -> f64 {
        let (mut low, mut high) = (FRAC_PI_2, PI);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if self.h_slope_over_sin(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Returns (dh/dα) / sin α. The division removes the root that always exists at π. With Q = 1 − λ² sin² α and
    /// P = cos 2α + λ² sin⁴ α the value is −1 + λ cos α (3 λ² P − 4 Q²) / Q^2.5.
    fn h_slope_over_sin(&self, alpha_rad: f64) -> f64 {
        let (sin, cos) = alpha_rad.sin_cos();
        let lambda = self.lambda();
        let q = 1.0 - (lambda * sin).powi(2);
        let p = (2.0 * alpha_rad).cos() + lambda * lambda * sin.powi(4);
        lambda * cos * (3.0 * lambda * lambda * p - 4.0 * q * q) / (q * q * q.sqrt()) - 1.0
    }
}
