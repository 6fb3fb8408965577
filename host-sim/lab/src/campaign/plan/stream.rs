//! Where a case's numbers are drawn from: a stream of its own for each seed and case number.
//!
//! ChaCha is counted, not walked: stream k of a seed is there at once, so that a case is the same whichever range it is drawn
//! in, and on whichever thread.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// One case's stream.
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// Of a seed and a case number.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(number);
        Self(stream)
    }

    /// Evenly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Evenly between two numbers' logarithms: as many in each octave.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// A whole number below `count`, which is not 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.random_range(0..count)
    }

    /// One of several, none of which is preferred; there is at least one.
    pub fn one_of<T: Copy>(&mut self, several: &[T]) -> T {
        several[self.below(several.len())]
    }

    /// True in so many of a hundred.
    pub fn percent(&mut self, percent: u32) -> bool {
        self.0.random_range(0..100_u32) < percent
    }

    /// Either sign.
    pub fn sign(&mut self) -> f64 {
        if self.percent(50) { 1.0 } else { -1.0 }
    }

    /// A seed for what draws for itself, small enough for a scene file, whose numbers are signed.
    pub fn seed(&mut self) -> u64 {
        u64::from(self.0.random::<u32>())
    }
}

/// To so many decimals: what a scene file shows is all there is.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10.0_f64.powi(decimals);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Were a stream another's, or walked to, cases of one range would not be those of another.
    #[test]
    fn a_stream_is_its_seeds_and_numbers_own() {
        let draw = |seed, number| Stream::new(seed, number).between(0.0, 1.0);
        assert_eq!(draw(7, 1_000_000), draw(7, 1_000_000));
        assert_ne!(draw(7, 1), draw(7, 2));
        assert_ne!(draw(7, 1), draw(8, 1));
    }
}
