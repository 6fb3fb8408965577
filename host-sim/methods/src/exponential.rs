//! Exponential of a square matrix, by scaling and squaring of its Taylor series.
//!
//! exp(A) = exp(A / 2ˢ)^(2ˢ), where s makes the 1-norm of A / 2ˢ at most 1/2. There the series has 17 terms: what follows has a norm below
//! 0.5¹⁷/17! · 1.03 = 2.3e-20, and the result has one of at least e^(−1/2). Squaring s times doubles the relative error each time (N. J. Higham, *Functions of Matrices*, 2008, §10.3).
//! nalgebra's own exponential needs its feature `std`, and with it crates for which a first build would wait.

use nalgebra::DMatrix;

/// Terms of the series after that of the unit matrix.
const TERMS: i32 = 16;

/// exp of `matrix`. Entries that are not finite, or whose exponential is beyond `f64`, give entries that are not finite.
pub(crate) fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let column_sums = matrix
        .column_iter()
        .map(|column| column.iter().map(|x| x.abs()).sum());
    let norm = column_sums.fold(0.0, f64::max);
    // A finite norm is below 2¹⁰²⁴.
    let squarings = (norm.log2() + 1.0).ceil().clamp(0.0, 1025.0) as i32;
    let scaled = matrix * 0.5_f64.powi(squarings);
    let unit = DMatrix::identity(matrix.nrows(), matrix.ncols());
    // Horner's form: 1 + A (1 + A/2 (1 + A/3 (…))).
    let mut power = unit.clone();
    for term in (1..=TERMS).rev() {
        power = &unit + (&scaled * power) / f64::from(term);
    }
    for _ in 0..squarings {
        power = &power * &power;
    }
    power
}
