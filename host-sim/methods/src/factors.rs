//! Factors of a square matrix, P M = L U, computed and used repeatedly without allocation.
//!
//! nalgebra's own `LU` allocates its permutation for each matrix. The steps below are its arithmetic in place:
//! Gaussian elimination with partial pivoting, right-looking.

use nalgebra::{DMatrix, DVector};

/// L below the diagonal (its own diagonal is 1), U on and above the diagonal, and the row of each pivot.
#[derive(Clone, Debug)]
pub(crate) struct Factors {
    matrix: DMatrix<f64>,
    pivots: Vec<usize>,
}

impl Factors {
    /// Allocates memory for a matrix of `dimension`. It has no factors yet.
    pub fn new(dimension: usize) -> Self {
        Self {
            matrix: DMatrix::identity(dimension, dimension),
            pivots: (0..dimension).collect(),
        }
    }

    /// Factors the matrix that `fill` writes. Returns false if it is singular, or has an entry that is not finite.
    pub fn factor(&mut self, fill: impl FnOnce(&mut DMatrix<f64>)) -> bool {
        fill(&mut self.matrix);
        let n = self.pivots.len();
        for k in 0..n {
            let pivot = k + self.matrix.view_range(k.., k).icamax();
            self.pivots[k] = pivot;
            self.matrix.swap_rows(k, pivot);
            let diagonal = self.matrix[(k, k)];
            if diagonal == 0.0 || !diagonal.is_finite() {
                return false;
            }
            for row in k + 1..n {
                self.matrix[(row, k)] /= diagonal;
            }
            for column in k + 1..n {
                let factor = self.matrix[(k, column)];
                for row in k + 1..n {
                    let below = self.matrix[(row, k)];
                    self.matrix[(row, column)] -= factor * below;
                }
            }
        }
        true
    }

    /// Replaces the right-hand side r by the solution x of M x = r.
    pub fn solve(&self, r: &mut DVector<f64>) {
        for (k, &pivot) in self.pivots.iter().enumerate() {
            r.swap_rows(k, pivot);
        }
        let regular = self
            .matrix
            .solve_lower_triangular_with_diag_mut(r, 1.0)
            .then(|| self.matrix.solve_upper_triangular_mut(r));
        debug_assert_eq!(regular, Some(true), "factor() refuses a zero pivot");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// If this fails, a swap or an elimination is wrong: the matrix times the solution is not the right-hand side. The
        /// bound is that of backward stability: n² ε times the size of the factors, with 10 for growth.
        #[test]
        fn factors_solve_the_linear_system(
            entries in prop::collection::vec(-1.0..1.0_f64, 49),
            right in prop::collection::vec(-1.0..1.0_f64, 7),
        ) {
            let matrix = DMatrix::from_vec(7, 7, entries);
            let right = DVector::from_vec(right);
            let mut factors = Factors::new(7);
            prop_assert!(factors.factor(|m| m.copy_from(&matrix)));
            let mut x = right.clone();
            factors.solve(&mut x);
            let left_over = (&matrix * &x - &right).amax();
            prop_assert!(left_over <= 490.0 * f64::EPSILON * (x.amax() + 1.0), "{left_over:e}");
        }
    }

    /// If this fails, a zero pivot gives an infinite solution, or a regular matrix with a zero in its first entry counts as
    /// singular.
    #[test]
    fn singular_matrices_are_distinguished_from_regular_ones() {
        let mut factors = Factors::new(2);
        assert!(!factors.factor(|m| m.copy_from_slice(&[1.0, 2.0, 2.0, 4.0])));
        assert!(!factors.factor(|m| m.copy_from_slice(&[f64::NAN, 2.0, 2.0, 4.0])));
        assert!(factors.factor(|m| m.copy_from_slice(&[0.0, 1.0, 1.0, 0.0])));
    }
}
