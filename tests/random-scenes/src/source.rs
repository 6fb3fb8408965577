//! The source of drawn numbers: a stream of its own for each seed.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Stream of draws.
pub struct Source(ChaCha8Rng);

/// Percentage of numbers that are drawn at one end of their range.
const AT_AN_END: u32 = 3;

impl Source {
    /// Begins the stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// A whole number below `count`, which is not 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.random_range(0..count)
    }

    /// One of several values. There must be at least one.
    pub fn one_of<T: Copy>(&mut self, several: &[T]) -> T {
        several[self.below(several.len())]
    }

    /// True with a probability of `percent`.
    pub fn percent(&mut self, percent: u32) -> bool {
        self.0.random_range(0..100_u32) < percent
    }

    /// A value that `draw` gives, with a probability of `percent`.
    pub fn maybe<T>(&mut self, percent: u32, draw: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.percent(percent).then(|| draw(self))
    }

    /// A number drawn evenly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        within(low + (high - low) * self.0.random::<f64>(), low, high)
    }

    /// A number drawn evenly between the logarithms of two numbers above 0.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        within(
            (low.ln() + (high / low).ln() * self.0.random::<f64>()).exp(),
            low,
            high,
        )
    }

    /// A number of a range, drawn evenly over its logarithm, and in some cases at one of its ends. In a range from 0 the
    /// logarithm starts at a millionth of its upper end. A range with negative numbers gives either sign.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        if low == high || self.percent(AT_AN_END) {
            return low;
        }
        if self.percent(AT_AN_END) {
            return high;
        }
        if low < 0.0 {
            let max = if self.percent(50) { low } else { high };
            return max.signum() * self.log_between(1e-6 * max.abs(), max.abs());
        }
        self.log_between(low.max(1e-6 * high), high)
    }

    /// A usual number in most scenes, and a number of the whole range in some.
    pub fn usual(&mut self, usual: (f64, f64), range: (f64, f64)) -> f64 {
        if self.percent(90) {
            let (low, high) = (usual.0.max(range.0), usual.1.min(range.1));
            if low < high {
                return self.log_between(low, high);
            }
        }
        self.number(range.0, range.1)
    }

    /// The default in half of all scenes, and a number of the whole range in the others.
    pub fn or_default(&mut self, default: f64, low: f64, high: f64) -> f64 {
        if self.percent(50) {
            default
        } else {
            self.number(low, high)
        }
    }

    /// A seed that a scene file can hold. Its numbers are signed.
    pub fn seed(&mut self) -> u64 {
        if self.percent(10) {
            i64::MAX as u64
        } else {
            u64::from(self.0.random::<u32>())
        }
    }
}

/// Rounds to five digits, as a person writes a number, and keeps the number within a range.
fn within(value: f64, low: f64, high: f64) -> f64 {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    rounded.clamp(low.min(high), high.max(low))
}

/// Rounds down to five digits, for a number that must not pass a limit.
pub fn at_most(value: f64) -> f64 {
    let nearest = within(value, f64::MIN, f64::MAX);
    if nearest <= value {
        return nearest;
    }
    within(value * (1.0 - 1e-4), f64::MIN, f64::MAX)
}
