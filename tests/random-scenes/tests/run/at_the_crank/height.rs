//! The platform's height as a function of the cranks' angle, by least squares, and its second derivative.
//!
//! The function is a Fourier series with the period of one turn. Its coefficients come from rows of a trace alone: no equation of a
//! mechanism enters. At a steady speed of ω the platform's acceleration is ω² z″, with z″ the second derivative over the angle.

use std::f64::consts::TAU;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Numbers of harmonics, largest first. The largest that the angles in a trace can resolve is used.
const HARMONICS: [usize; 5] = [30, 24, 18, 12, 8];

/// Angles per turn at which the second derivative is evaluated for its largest value.
const ANGLES: usize = 4096;

/// Standard deviations of a coefficient's noise that are allowed for.
const DEVIATIONS: f64 = 6.0;

/// A height z(α), m, over the angle of the cranks, turns.
pub struct Height {
    coefficients: DVector<f64>,
    factors: Cholesky<f64, Dyn>,
    /// Largest difference between a row and the series, m, and the mean square of it.
    pub residual_m: f64,
    variance_m2: f64,
    /// Difference of the largest and the lowest height, m.
    pub range_m: f64,
}

/// Largest magnitude of a second derivative per squared rad, m, and its error.
#[derive(Clone, Copy, Debug)]
pub struct Peak {
    pub m: f64,
    pub error_m: f64,
}

/// Sine and cosine terms of an angle, from the constant on: their values, or their second derivatives.
fn terms(turns: f64, harmonics: usize, derived: bool) -> DVector<f64> {
    DVector::from_fn(2 * harmonics + 1, |i, _| {
        let k = i.div_ceil(2) as f64;
        let angle = k * turns.rem_euclid(1.0) * TAU;
        let value = if i % 2 == 0 { angle.cos() } else { angle.sin() };
        if derived { -k * k * value } else { value }
    })
}

impl Height {
    /// The series through heights at angles, with as many harmonics as the angles can resolve. It returns none if they are too far apart.
    pub fn fit(angles: &[f64], heights_m: &[f64]) -> Option<(Self, Peak)> {
        let mut sorted: Vec<f64> = angles.iter().map(|turns| turns.rem_euclid(1.0)).collect();
        sorted.sort_by(f64::total_cmp);
        let around = sorted.first()? + 1.0 - sorted.last()?;
        let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
        let gap = gaps.fold(around, f64::max);
        let resolved =
            |&&harmonics: &&usize| gap <= 0.4 / harmonics as f64 && angles.len() >= 6 * harmonics;
        let harmonics = *HARMONICS.iter().find(resolved)?;
        let finer = Self::with(harmonics, angles, heights_m)?;
        let coarser = Self::with(harmonics * 2 / 3, angles, heights_m)?;
        let (fine, coarse) = (finer.peak(), coarser.peak());
        // The harmonics of a smooth function fall off, so those left out change less than those between both series.
        let error_m = fine.error_m + (fine.m - coarse.m).abs();
        Some((finer, Peak { error_m, ..fine }))
    }

    fn with(harmonics: usize, angles: &[f64], heights_m: &[f64]) -> Option<Self> {
        let size = 2 * harmonics + 1;
        let (mut products, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for (turns, z_m) in angles.iter().zip(heights_m) {
            let row = terms(*turns, harmonics, false);
            products.ger(1.0, &row, &row, 1.0);
            right.axpy(*z_m, &row, 1.0);
        }
        let factors = Cholesky::new(products)?;
        let coefficients = factors.solve(&right);
        let residuals: Vec<f64> = angles
            .iter()
            .zip(heights_m)
            .map(|(turns, z_m)| z_m - terms(*turns, harmonics, false).dot(&coefficients))
            .collect();
        let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
        let (low, high) = heights_m
            .iter()
            .fold((f64::MAX, f64::MIN), |(low, high), z| {
                (low.min(*z), high.max(*z))
            });
        Some(Self {
            coefficients,
            factors,
            residual_m: residuals.iter().fold(0.0, |max, one| one.abs().max(max)),
            variance_m2: squares / (angles.len() - size) as f64,
            range_m: high - low,
        })
    }

    /// Second derivative at an angle, per squared rad, m.
    pub fn second_m(&self, turns: f64) -> f64 {
        let harmonics = self.coefficients.len() / 2;
        terms(turns, harmonics, true).dot(&self.coefficients)
    }

    fn peak(&self) -> Peak {
        let angles = (0..ANGLES).map(|i| i as f64 / ANGLES as f64);
        let at = angles
            .max_by(|one, other| {
                let magnitude = |turns: f64| self.second_m(turns).abs();
                magnitude(*one).total_cmp(&magnitude(*other))
            })
            .unwrap_or_default();
        let gradient = terms(at, self.coefficients.len() / 2, true);
        let variance = self.variance_m2 * gradient.dot(&self.factors.solve(&gradient));
        Peak {
            m: self.second_m(at).abs(),
            error_m: DEVIATIONS * variance.sqrt(),
        }
    }
}
