//! Error that a method makes in one radian of an oscillation, and the longest step that keeps it small.
//!
//! The matrix of a step is measured on the code, as in [`crate::stability`]. One of its eigenvalues μ describes the
//! oscillation in a step. Its exact value is exp(z hω) with z = −ζ + i √(1 − ζ²). So |ln μ / hω − z| is the error of phase and
//! logarithm of the amplitude per radian. For RK4 without damping it is (hω)⁴/120.

use num_complex::Complex;

use crate::Scheme;

/// Longest step that is examined: for steps over a radian, the error of a method no longer follows its order.
pub const LONGEST_H_OMEGA: f64 = 1.0;
/// Shortest step that is examined: for shorter ones, rounding errors dominate.
pub const SHORTEST_H_OMEGA: f64 = 1e-3;
/// Relative error of the step that is found.
const TOLERANCE: f64 = 1e-3;

impl Scheme {
    /// Returns the error of the method in one radian of an oscillation with damping ratio `zeta` (0 to below 1), for steps of
    /// hω = `h_omega` up to 1: that of phase and logarithm of the amplitude together. Infinite if it overflows.
    pub fn error_a_radian(self, h_omega: f64, zeta: f64) -> f64 {
        let matrix = self.amplification(h_omega, zeta);
        let (half_trace, determinant) = (0.5 * matrix.trace(), matrix.determinant());
        let root = Complex::from(half_trace * half_trace - determinant).sqrt();
        let truth = Complex::new(-zeta, (1.0 - zeta * zeta).sqrt());
        // The eigenvalue with positive frequency.
        let forward = half_trace + if root.im < 0.0 { -root } else { root };
        let error = (forward.ln() / h_omega - truth).norm();
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// Returns the longest step, as hω, at which the method's error is at most `error` per radian. It is at least
    /// [`SHORTEST_H_OMEGA`], even if the error is larger there, and at most [`LONGEST_H_OMEGA`].
    pub fn step_for(self, zeta: f64, error: f64) -> f64 {
        let (mut low, mut high) = (SHORTEST_H_OMEGA, LONGEST_H_OMEGA);
        if self.error_a_radian(high, zeta) <= error {
            return high;
        }
        while high / low > 1.0 + TOLERANCE {
            let middle = (low * high).sqrt();
            if self.error_a_radian(middle, zeta) <= error {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Leading terms of the undamped oscillation's error, by theory: explicit Euler's amplitude grows by hω/2 per radian,
    /// symplectic Euler's and Verlet's phase leads by (hω)²/24, the midpoint's lags by (hω)²/12, and RK4's by (hω)⁴/120.
    #[test]
    fn errors_match_their_theoretical_leading_terms() {
        let h = 0.02_f64;
        for (scheme, theory) in [
            (Scheme::ExplicitEuler, h / 2.0),
            (Scheme::SymplecticEuler, h * h / 24.0),
            (Scheme::VelocityVerlet, h * h / 24.0),
            (Scheme::ImplicitMidpoint, h * h / 12.0),
            (Scheme::Rk4, h.powi(4) / 120.0),
        ] {
            let error = scheme.error_a_radian(h, 0.0);
            // The next term is smaller by h², or h for explicit Euler, with a factor of the order of 1.
            assert!(
                (error / theory - 1.0).abs() < 2.0 * h,
                "{scheme}: {error:e}"
            );
        }
        assert!(Scheme::Exact.error_a_radian(h, 0.1) < 1e-13);
    }

    #[test]
    fn a_step_is_as_long_as_its_error_allows() {
        for zeta in [0.0, 0.05, 0.5] {
            for scheme in [Scheme::SymplecticEuler, Scheme::Rk4, Scheme::Sdirk4] {
                let step = scheme.step_for(zeta, 2e-3);
                assert!(scheme.error_a_radian(step, zeta) <= 2e-3);
                assert!(
                    step == LONGEST_H_OMEGA || scheme.error_a_radian(1.01 * step, zeta) > 2e-3,
                    "{scheme} at {zeta}: {step}"
                );
            }
        }
        assert_eq!(Scheme::Exact.step_for(0.1, 1e-9), LONGEST_H_OMEGA);
    }
}
