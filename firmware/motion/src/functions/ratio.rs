//! Multiplication of a stream of distances by an exact ratio.

use core::hash::Hash;

use super::divide::Divisor;
use super::multiply::multiply_long;

/// Ratio of two integers by which distances are multiplied one after the other. The remainder of each division is carried to the next.
///
/// So the sum of the results is the product of the ratio and the sum of the distances, rounded down once, however many there are.
///
/// ```
/// use cophase_motion::functions::Ratio;
/// let mut third = Ratio::new(1, 3);
/// assert_eq!([1, 1, 1, -2].map(|distance| third.advance(distance)), [0, 0, 1, -1]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio {
    numerator: u32,
    denominator: u32,
    divisor: Divisor,
    /// Remainder of the divisions so far, 0 ≤ rest < denominator.
    rest: u32,
}

impl Ratio {
    /// Ratio of a numerator and a denominator, which is at least 1, without a remainder.
    pub const fn new(numerator: u32, denominator: u32) -> Self {
        Self {
            numerator,
            denominator,
            divisor: Divisor::new(denominator),
            rest: 0,
        }
    }

    /// Product with the next distance. The distance times the numerator must be below 2⁶³ in magnitude.
    #[inline]
    pub const fn advance(&mut self, distance: i64) -> i64 {
        let all = multiply_long(distance.unsigned_abs(), self.numerator);
        if distance >= 0 {
            let (product, rest) = self.divisor.divide(all + self.rest as u64);
            self.rest = rest;
            return product as i64;
        }
        // In reverse the remainder is missing from the next unit.
        let missing = self.denominator - 1 - self.rest;
        let (product, missing) = self.divisor.divide(all + missing as u64);
        self.rest = self.denominator - 1 - missing;
        -(product as i64)
    }

    /// Product with a distance alone, rounded towards zero; the remainder is neither used nor changed.
    pub const fn product(&self, distance: i64) -> i64 {
        let all = multiply_long(distance.unsigned_abs(), self.numerator);
        let product = self.divisor.divide(all).0 as i64;
        if distance < 0 { -product } else { product }
    }

    /// True if the ratio is 1.
    pub const fn is_one(&self) -> bool {
        self.numerator == self.denominator
    }

    /// Constants: all but the remainder.
    #[inline(always)]
    pub fn constants(&self) -> impl Hash + use<> {
        let Self {
            numerator,
            denominator,
            divisor,
            rest: _,
        } = *self;
        (numerator, denominator, divisor)
    }

    /// The ratio as one number.
    pub fn to_f64(&self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }
}
