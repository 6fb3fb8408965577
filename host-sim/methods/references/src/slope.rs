//! Slope of log error against log step: the measured order.

/// Errors of one method at several steps.
#[derive(Clone, Debug, Default)]
pub struct Slope(Vec<(f64, f64)>);

impl Slope {
    /// Adds the error at a step.
    pub fn add(&mut self, step: f64, error: f64) {
        self.0.push((step.ln(), error.ln()));
    }

    /// Slope of the straight line with the least squares.
    pub fn least_squares(&self) -> f64 {
        let count = self.0.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| self.0.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let products = self.0.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>();
        products / self.0.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
    }

    /// Decades of step covered.
    pub fn decades(&self) -> f64 {
        let steps = || self.0.iter().map(|p| p.0);
        let (low, high) = (
            steps().fold(f64::MAX, f64::min),
            steps().fold(f64::MIN, f64::max),
        );
        (high - low) / core::f64::consts::LN_10
    }

    /// Smallest and largest error added.
    pub fn errors(&self) -> (f64, f64) {
        let errors = || self.0.iter().map(|p| p.1.exp());
        (
            errors().fold(f64::MAX, f64::min),
            errors().fold(0.0, f64::max),
        )
    }
}
