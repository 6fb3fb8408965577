//! Errors of readings, in tolerances, one a turn. Each law has zero mean.

use std::f64::consts::TAU;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use statrs::function::erf::erfc;

/// Standard deviation of normal errors. A tolerance is four of them.
pub const SIGMA: f64 = 0.25;

/// Law of the errors of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// Independent, and uniform within a tolerance either way.
    Uniform,
    /// Normal with a standard deviation of [`SIGMA`]. Errors that are j turns apart have the correlation `correlation`ʲ: AR(1).
    Normal {
        /// Correlation of two readings in a row, 0 to 1.
        correlation: f64,
    },
}

impl Noise {
    /// All laws of the chart.
    pub const ALL: [Self; 3] = [
        Self::Uniform,
        Self::Normal { correlation: 0.0 },
        Self::Normal { correlation: 0.9 },
    ];

    /// Name in the data and the picture.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform within r",
            Self::Normal { correlation: 0.0 } => "normal",
            Self::Normal { .. } => "normal and correlated",
        }
    }

    /// True if errors of different turns are independent.
    pub fn is_independent(self) -> bool {
        self.correlation() == 0.0
    }

    /// Correlation of two readings in a row.
    pub const fn correlation(self) -> f64 {
        match self {
            Self::Uniform => 0.0,
            Self::Normal { correlation } => correlation,
        }
    }

    /// Standard deviation of an error.
    pub fn sigma(self) -> f64 {
        match self {
            Self::Uniform => 1.0 / 3.0_f64.sqrt(),
            Self::Normal { .. } => SIGMA,
        }
    }

    /// Probability of an error above `x`.
    pub fn tail(self, x: f64) -> f64 {
        match self {
            Self::Uniform => (0.5 * (1.0 - x)).clamp(0.0, 1.0),
            Self::Normal { .. } => normal_tail(x / SIGMA),
        }
    }
}

/// Probability that a standard normal variable exceeds `z`.
pub fn normal_tail(z: f64) -> f64 {
    0.5 * erfc(z / 2.0_f64.sqrt())
}

/// Source of errors, one a turn, from its stationary state on.
pub struct Errors {
    rng: ChaCha8Rng,
    noise: Noise,
    last: Option<f64>,
    /// Second of the last pair of normal variables.
    spare: Option<f64>,
}

impl Errors {
    /// Creates the source with number `stream`. Equal numbers yield equal errors.
    pub fn new(noise: Noise, stream: u64) -> Self {
        Self {
            rng: ChaCha8Rng::seed_from_u64(stream),
            noise,
            last: None,
            spare: None,
        }
    }

    /// Draws from 0 to 1, without 1.
    pub fn uniform(&mut self) -> f64 {
        self.rng.random()
    }

    /// Draws a standard normal variable. They are made in pairs (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sine, cosine) = (TAU * self.uniform()).sin_cos();
        self.spare = Some(radius * sine);
        radius * cosine
    }

    /// Draws a standard normal variable that exceeds `min` > 0 (Robert 1995).
    pub fn normal_above(&mut self, min: f64) -> f64 {
        loop {
            let beyond = -(1.0 - self.uniform()).ln() / min;
            if self.uniform() < (-0.5 * beyond * beyond).exp() {
                return min + beyond;
            }
        }
    }

    /// Draws the error of the next turn.
    pub fn draw(&mut self) -> f64 {
        match self.noise {
            Noise::Uniform => 2.0 * self.uniform() - 1.0,
            Noise::Normal { correlation } => {
                let fresh = SIGMA * self.normal();
                let next = match self.last {
                    Some(last) if correlation > 0.0 => {
                        correlation * last + (1.0 - correlation * correlation).sqrt() * fresh
                    }
                    _ => fresh,
                };
                self.last = Some(next);
                next
            }
        }
    }
}
