//! Drift of a rippling quantity over a run, such as the energy that a method should conserve.
//!
//! A method conserves an energy that differs a little from the true one, so the true energy ripples within each period. Both ends of
//! the run are therefore averaged over a Hann window. Its spectrum falls as the cube of the frequency: with 200 ripples in the
//! window, less than 1e-6 of the ripple remains.

use core::f64::consts::TAU;

/// Means at both ends of a run, accumulated value by value.
#[derive(Clone, Debug)]
pub struct Ends {
    values: u32,
    window: u32,
    first: Mean,
    last: Mean,
}

impl Ends {
    /// Creates the means of a run with `values` values, over its first and its last `window` values.
    pub fn new(values: u32, window: u32) -> Self {
        Self {
            values,
            window,
            first: Mean::default(),
            last: Mean::default(),
        }
    }

    /// Adds value `i`, counted from 0.
    pub fn add(&mut self, i: u32, value: f64) {
        let from_end = self.values - self.window;
        if i < self.window {
            self.first.add(i, self.window, value);
        } else if i >= from_end {
            self.last.add(i - from_end, self.window, value);
        }
    }

    /// Means at the beginning and at the end; NaN where no value was added.
    pub fn means(&self) -> (f64, f64) {
        (self.first.value(), self.last.value())
    }
}

/// Mean with the weights of a Hann window.
#[derive(Clone, Debug, Default)]
struct Mean {
    sum: f64,
    weights: f64,
}

impl Mean {
    fn add(&mut self, i: u32, of: u32, value: f64) {
        let weight = 1.0 - (TAU * f64::from(i) / f64::from(of)).cos();
        self.sum += weight * value;
        self.weights += weight;
    }

    fn value(&self) -> f64 {
        self.sum / self.weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, ripple counts as drift, or drift is not measured.
    #[test]
    fn ripple_is_left_out_and_drift_is_not() {
        let (values, window) = (100_000, 10_000);
        let mut ends = Ends::new(values, window);
        for i in 0..values {
            // 200.3 ripples in the window, and a slow rise by 1 over the run.
            let ripple = (TAU * 200.3 * f64::from(i) / f64::from(window)).sin();
            ends.add(i, ripple + f64::from(i) / f64::from(values));
        }
        let (first, last) = ends.means();
        assert!((first - 0.05).abs() < 1e-5, "{first}");
        assert!((last - 0.95).abs() < 1e-5, "{last}");
    }
}
