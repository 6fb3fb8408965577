//! Rates with what is known of them: Clopper and Pearson's exact bounds, of which at least 95 of 100 hold.

use statrs::function::beta::inv_beta_reg;

/// Of a hundred such intervals so many do not have the rate in them, at most.
pub(super) const OUTSIDE: f64 = 0.05;

/// A rate, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rate {
    /// How many did.
    pub hits: u64,
    /// Of how many.
    pub of: u64,
}

impl Rate {
    /// Counts one more.
    pub fn count(&mut self, hit: bool) {
        self.of += 1;
        self.hits += u64::from(hit);
    }

    /// What part; none of none.
    pub fn part(&self) -> Option<f64> {
        (self.of > 0).then(|| self.hits as f64 / self.of as f64)
    }

    /// The least and the most that the true rate is, 95 % two-sided; all that there is, of none.
    ///
    /// The lower end p has P(at least as many hits | p) = 2.5 %, the upper P(at most as many | p) = 2.5 %: quantiles of beta
    /// distributions.
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

    /// Where all did or none, the bounds have a closed form: p^n = 2.5 %.
    #[test]
    fn all_or_none_have_bounds_that_can_be_written_down() {
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

    /// Bounds are what they say: at them the tail of the binomial is 2.5 %, summed here term by term.
    #[test]
    fn at_the_bounds_the_tails_are_a_fortieth_each() {
        for (hits, of) in [(1_u64, 8_u64), (37, 100), (990, 1000)] {
            let (low, high) = Rate { hits, of }.bounds();
            let above = 1.0 - at_most(hits - 1, of, low);
            let below = at_most(hits, of, high);
            assert!((above - 0.025).abs() < 1e-7, "{hits}/{of}: {above}");
            assert!((below - 0.025).abs() < 1e-7, "{hits}/{of}: {below}");
        }
    }

    /// P(at most `hits` of `of`) at a rate.
    fn at_most(hits: u64, of: u64, rate: f64) -> f64 {
        // Counted from the rarer side: of a thousand misses at a rate near 1 the first term is less than any number.
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
