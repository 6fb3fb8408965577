//! What a quantity that ripples has wandered from the beginning of a run to its end: energy that a method is to keep.
//!
//! The energy that a method keeps is not quite the true one: it ripples around it within each period. So it is averaged over
//! a window at either end, under Hann's bell, whose spectrum falls as the cube of the frequency: of a ripple that comes 200 times in
//! the window less than 1e-6 gets through.

use core::f64::consts::TAU;

/// Means at both ends of a run, gathered value by value.
#[derive(Clone, Debug)]
pub struct Ends {
    values: u32,
    window: u32,
    first: Mean,
    last: Mean,
}

impl Ends {
    /// Of a run of so many values, of which the first and the last `window` count.
    pub fn new(values: u32, window: u32) -> Self {
        Self {
            values,
            window,
            first: Mean::default(),
            last: Mean::default(),
        }
    }

    /// Takes in value `i`, counted from 0.
    pub fn add(&mut self, i: u32, value: f64) {
        let from_end = self.values - self.window;
        if i < self.window {
            self.first.add(i, self.window, value);
        } else if i >= from_end {
            self.last.add(i - from_end, self.window, value);
        }
    }

    /// The means at the beginning and at the end; NaN where nothing was taken in.
    pub fn means(&self) -> (f64, f64) {
        (self.first.value(), self.last.value())
    }
}

/// A mean under Hann's bell.
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

    /// Were it wrong, ripple would be taken for drift, or drift be lost.
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
