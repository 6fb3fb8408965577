//! Counted rates with Clopper and Pearson's exact confidence bounds. At least 95 of 100 such intervals contain the true rate.

use statrs::function::beta::inv_beta_reg;

/// Largest probability that an interval does not contain the true rate.
pub(super) const OUTSIDE: f64 = 0.05;

/// Counted rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rate {
    /// Number of trials with the event.
    pub hits: u64,
    /// Number of all trials.
    pub of: u64,
}

impl Rate {
    /// Counts one more trial.
    pub fn count(&mut self, hit: bool) {
        self.of += 1;
        self.hits += u64::from(hit);
    }

    /// Returns the fraction of trials with the event, or none without trials.
    pub fn part(&self) -> Option<f64> {
        (self.of > 0).then(|| self.hits as f64 / self.of as f64)
    }

    /// Returns the lower and the upper end of the two-sided 95 % interval of the true rate; 0 and 1 without trials.
    ///
    /// At the lower end p, P(at least as many hits | p) = 2.5 %. At the upper end, P(at most as many | p) = 2.5 %. Both are quantiles of
    /// beta distributions.
    pub fn bounds(&self) -> (f64, f64) {
        let (hits, misses) = (self.hits as f64, (self.of - self.hits) as f64);
        let low = if self.hits == 0 {
            0.0
        } else {
            inv_beta_reg(hits, misses + 1.0, OUTSIDE / 2.0)
        };
        let high = if self.hits == self.of {
            1.0
        } else {
            inv_beta_reg(hits + 1.0, misses, 1.0 - OUTSIDE / 2.0)
        };
        (low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the bounds are wrong where all trials have the event, or none. They have a closed form there: p^n = 2.5 %.
    #[test]
    fn bounds_have_closed_form_for_all_or_no_hits() {
        for of in [1_u64, 10, 1000, 100_000] {
            let edge = 0.025_f64.powf(1.0 / of as f64);
            let (low, high) = Rate { hits: of, of }.bounds();
            assert!((low - edge).abs() < 1e-9, "{of}: {low}, not {edge}");
            assert_eq!(high, 1.0);
            let (low, high) = Rate { hits: 0, of }.bounds();
            assert_eq!(low, 0.0);
            assert!((high - (1.0 - edge)).abs() < 1e-9, "{of}: {high}");
        }
    }

    /// If this fails, the stated bounds do not hold with 95 %. At each bound the tail of the binomial is 2.5 %, summed here term by term.
    #[test]
    fn each_bound_has_a_tail_of_a_fortieth() {
        for (hits, of) in [(1_u64, 8_u64), (37, 100), (990, 1000)] {
            let (low, high) = Rate { hits, of }.bounds();
            let above = 1.0 - at_most(hits - 1, of, low);
            let below = at_most(hits, of, high);
            assert!((above - 0.025).abs() < 1e-7, "{hits}/{of}: {above}");
            assert!((below - 0.025).abs() < 1e-7, "{hits}/{of}: {below}");
        }
    }

    /// Probability of at most `hits` events in `of` trials at a rate.
    fn at_most(hits: u64, of: u64, rate: f64) -> f64 {
        // The sum begins at the rarer side. The first term of a thousand misses at a rate near 1 would be below the smallest number.
        if rate > 0.5 {
            return if hits == of {
                1.0
            } else {
                1.0 - at_most(of - hits - 1, of, 1.0 - rate)
            };
        }
        let mut term = (of as f64 * (1.0 - rate).ln()).exp();
        let mut sum = term;
        for k in 0..hits {
            term *= (of - k) as f64 / (k + 1) as f64 * rate / (1.0 - rate);
            sum += term;
        }
        sum
    }
}
