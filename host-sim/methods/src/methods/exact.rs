//! Exact discretisation of a linear machine y′ = A y + b(t), with first-order hold of the input.
//!
//! y₁ = Φ y + P b(t) + Q b(t + h): the exact solution if b is linear between its values at the start and the end of the step.
//! So it is exact to rounding for any step, without input or with a linear one. For other inputs the error of b is at most
//! h²/8 max|b″|, which gives order 2. It is stable at any step if the machine is stable.
//!
//! Φ, P, Q are computed once, when the method is prepared, from one matrix exponential (C. F. Van Loan, *Computing integrals involving
//! the matrix exponential*, IEEE TAC 23, 1978):
//!
//! ```text
//!     ⎡ hA  hI  0  ⎤     ⎡ Φ  Γ₀  h Γ₁ ⎤
//! exp ⎢ 0   0   hI ⎥  =  ⎢ 0  I   hI   ⎥      P = Γ₀ − Γ₁,  Q = Γ₁.
//!     ⎣ 0   0   0  ⎦     ⎣ 0  0   I    ⎦
//! ```
//!
//! A step is then three products of matrix and vector. The method keeps the matrix A of its preparation: equations
//! whose matrix changes need a new method.

use nalgebra::{DMatrix, DVector, DVectorView, DVectorViewMut};

use crate::exponential::exponential;
use crate::rule::Rule;
use crate::{Equations, Facts, Needs, Refused, StepError};

/// Memory of the exact discretisation.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    transition: DMatrix<f64>,
    from_start: DMatrix<f64>,
    from_end: DMatrix<f64>,
    input: DVector<f64>,
}

impl Rule for Exact {
    const FACTS: &'static Facts = &Facts {
        name: "exact discretisation",
        order: 2,
        needs: Needs::Linear,
        keeps_energy: true,
        evaluations: 2,
    };

    fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused> {
        let n = equations.dimension();
        let Some(linear) = equations.linear() else {
            unreachable!("the structure was checked");
        };
        let mut block = DMatrix::zeros(3 * n, 3 * n);
        block
            .view_mut((0, 0), (n, n))
            .copy_from(&(linear.matrix() * step_s));
        block.view_mut((0, n), (n, n)).fill_diagonal(step_s);
        block.view_mut((n, 2 * n), (n, n)).fill_diagonal(step_s);
        let block = exponential(&block);
        if block.iter().any(|entry| !entry.is_finite()) {
            return Err(Refused::Exponential { step_s });
        }
        let part = |column: usize| block.view((0, column * n), (n, n)).into_owned();
        let from_end = part(2) / step_s;
        Ok(Self {
            transition: part(0),
            from_start: part(1) - &from_end,
            from_end,
            input: DVector::zeros(n),
        })
    }

    fn fit(&mut self, equations: &dyn Equations, t_s: f64, h: f64) -> Result<(), StepError> {
        *self = Self::new(equations, h).map_err(|_| StepError::NotFinite { t_s, component: 0 })?;
        Ok(())
    }

    fn step(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        h: f64,
        y: &[f64],
        next: &mut [f64],
    ) -> Result<(), StepError> {
        let linear = equations
            .linear()
            .expect("the equations are those the method was made for");
        let state = DVectorView::from_slice(y, y.len());
        let mut next = DVectorViewMut::from_slice(next, y.len());
        next.gemv(1.0, &self.transition, &state, 0.0);
        linear.input(t_s, self.input.as_mut_slice());
        next.gemv(1.0, &self.from_start, &self.input, 1.0);
        linear.input(t_s + h, self.input.as_mut_slice());
        next.gemv(1.0, &self.from_end, &self.input, 1.0);
        Ok(())
    }
}
