//! Random numbers of a case: one stream for each seed and case number.
//!
//! ChaCha computes stream k of a seed directly from k. So a case is the same in any range of cases and on any thread.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Random stream of one case.
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// Stream for a seed and a case number.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(number);
        Self(stream)
    }

    /// Draws a number between two numbers, with uniform distribution.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Draws a number between two numbers, with uniform distribution of its logarithm: each octave is equally likely.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Draws a whole number below `count`, which is not 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.random_range(0..count)
    }

    /// Draws one of several values, each with equal probability. There must be at least one.
    pub fn one_of<T: Copy>(&mut self, several: &[T]) -> T {
        several[self.below(several.len())]
    }

    /// Returns true in `percent` of 100 cases.
    pub fn percent(&mut self, percent: u32) -> bool {
        self.0.random_range(0..100_u32) < percent
    }

    /// Draws a sign: 1 or -1.
    pub fn sign(&mut self) -> f64 {
        if self.percent(50) { 1.0 } else { -1.0 }
    }

    /// Draws a seed for another generator. It has 32 bits, so that it fits into the signed numbers of a scene file.
    pub fn seed(&mut self) -> u64 {
        u64::from(self.0.random::<u32>())
    }
}

/// Rounds to a number of decimals, so that a scene file shows the complete value.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10.0_f64.powi(decimals);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a case differs between ranges of cases, and a replay simulates another case.
    #[test]
    fn a_stream_depends_only_on_seed_and_number() {
        let draw = |seed, number| Stream::new(seed, number).between(0.0, 1.0);
        assert_eq!(draw(7, 1_000_000), draw(7, 1_000_000));
        assert_ne!(draw(7, 1), draw(7, 2));
        assert_ne!(draw(7, 1), draw(8, 1));
    }
}
