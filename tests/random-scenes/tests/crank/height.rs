//! The platform's height over time, and what follows from it alone: strokes, their frequency, and the greatest acceleration of a stroke.
//!
//! The height is coarse, as the motors' steps place it. So it is not differentiated from row to row: a Fourier series is fitted by least
//! squares, and its second derivative is taken.

use std::f64::consts::TAU;

/// Harmonics of the series. A crank-rocker has a thousandth of its acceleration beyond.
const HARMONICS: usize = 16;
const UNKNOWNS: usize = 2 * HARMONICS + 1;
/// Part of the stroke by which the height must pass its middle to count.
const HYSTERESIS: f64 = 0.2;
/// Points of a stroke at which the acceleration is compared.
const POINTS: usize = 3600;

/// Rows of a fit at most; others between them are left out.
const ROWS: usize = 1500;

pub struct Height<'a> {
    t_s: &'a [f64],
    z_m: &'a [f64],
}

impl<'a> Height<'a> {
    pub fn new(t_s: &'a [f64], z_m: &'a [f64]) -> Self {
        Self { t_s, z_m }
    }

    /// Times at which the height passes its middle upwards, s.
    fn rises(&self) -> Vec<f64> {
        let low = self.z_m.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.z_m.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (middle, margin) = (f64::midpoint(low, high), HYSTERESIS * (high - low));
        let (mut rises, mut passed, mut is_low) = (Vec::new(), None, false);
        for i in 1..self.z_m.len() {
            let (before, now) = (self.z_m[i - 1], self.z_m[i]);
            is_low |= now < middle - margin;
            if before < middle && now >= middle {
                let part = (middle - before) / (now - before);
                passed = Some(self.t_s[i - 1] + part * (self.t_s[i] - self.t_s[i - 1]));
            }
            if is_low && now > middle + margin {
                rises.extend(passed);
                is_low = false;
            }
        }
        rises
    }

    /// Strokes so far, to a stroke or so.
    pub fn strokes(&self) -> f64 {
        self.rises().len() as f64
    }

    /// Strokes a second, of a motion of constant speed.
    pub fn frequency_hz(&self) -> Option<f64> {
        let rises = self.rises();
        let (first, last) = (rises.first()?, rises.last()?);
        if rises.len() < 4 {
            return None;
        }
        let near_hz = (rises.len() - 1) as f64 / (last - first);
        // The frequency of the best fit, by golden section.
        let (mut low, mut high) = (0.99 * near_hz, 1.01 * near_hz);
        for _ in 0..24 {
            let part = 0.381_966 * (high - low);
            let (one, other) = (low + part, high - part);
            if self.residual(one) < self.residual(other) {
                high = other;
            } else {
                low = one;
            }
        }
        Some(f64::midpoint(low, high))
    }

    /// Greatest magnitude of the second derivative over a stroke, m/s².
    pub fn amax_mps2(&self, frequency_hz: f64) -> f64 {
        let series = self.fit(frequency_hz);
        let omega = TAU * frequency_hz;
        let at = |point: usize| {
            let angle = TAU * point as f64 / POINTS as f64;
            let harmonic = |k: usize| {
                let (sin, cos) = (k as f64 * angle).sin_cos();
                let square = (k as f64 * omega).powi(2);
                -square * (series[2 * k - 1] * cos + series[2 * k] * sin)
            };
            (1..=HARMONICS).map(harmonic).sum::<f64>().abs()
        };
        (0..POINTS).map(at).fold(0.0, f64::max)
    }

    fn rows(&self) -> impl Iterator<Item = usize> {
        let count = self.z_m.len();
        (0..count).step_by(count.div_ceil(ROWS))
    }

    fn terms(&self, row: usize, frequency_hz: f64) -> [f64; UNKNOWNS] {
        let angle = TAU * frequency_hz * (self.t_s[row] - self.t_s[0]);
        let mut terms = [1.0; UNKNOWNS];
        for k in 1..=HARMONICS {
            (terms[2 * k], terms[2 * k - 1]) = (k as f64 * angle).sin_cos();
        }
        terms
    }

    fn residual(&self, frequency_hz: f64) -> f64 {
        let series = self.fit(frequency_hz);
        let off = |row: usize| {
            let terms = self.terms(row, frequency_hz);
            let fitted: f64 = terms.iter().zip(&series).map(|(a, b)| a * b).sum();
            (fitted - self.z_m[row]).powi(2)
        };
        self.rows().map(off).sum()
    }

    /// Coefficients of the series: the mean, then cosine and sine of each harmonic. They solve the normal equations, by elimination.
    fn fit(&self, frequency_hz: f64) -> [f64; UNKNOWNS] {
        let mut equations = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
        for row in self.rows() {
            let terms = self.terms(row, frequency_hz);
            for (equation, own) in equations.iter_mut().zip(terms) {
                for (sum, other) in equation.iter_mut().zip(terms) {
                    *sum += own * other;
                }
                equation[UNKNOWNS] += own * self.z_m[row];
            }
        }
        for pivot in 0..UNKNOWNS {
            let head = equations[pivot];
            for equation in equations.iter_mut().skip(pivot + 1) {
                let factor = equation[pivot] / head[pivot];
                for (value, above) in equation.iter_mut().zip(head) {
                    *value -= factor * above;
                }
            }
        }
        let mut series = [0.0; UNKNOWNS];
        for row in (0..UNKNOWNS).rev() {
            let known: f64 = (row + 1..UNKNOWNS)
                .map(|i| equations[row][i] * series[i])
                .sum();
            series[row] = (equations[row][UNKNOWNS] - known) / equations[row][row];
        }
        series
    }
}
