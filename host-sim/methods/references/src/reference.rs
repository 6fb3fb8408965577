//! Reference solutions from library solvers: two libraries and five methods, none of them from `cophase_methods`.
//!
//! Each reference solution is solved to its end in one run, at the tightest tolerance that the solver accepts. Its error is
//! taken to be its difference from the other library's solution. Errors below ten times that are not judged.
//!
//! Accuracies: the two explicit methods, DOP853 and TSIT45, agree to 1e-13 at tolerance 1e-14. The error of diffsol's BDF is
//! 1e-12 to 1e-9. BDF of `differential-equations` 0.7 stops at its first step ("step size became too small") on Van der Pol's
//! oscillator at any tolerance. It does the same on HIRES if the absolute tolerance is below 1e-10. Radau IIA of the same
//! library solves Van der Pol's oscillator.

use cophase_methods::Equations;
use differential_equations::interpolate::Interpolation;
use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::prelude::{
    BackwardDifferentiationFormula, ExplicitRungeKutta, IVP, ImplicitRungeKutta, ODE,
};
use diffsol::{
    MatrixCommon, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod,
};
use nalgebra::{DMatrix, DVector};

/// Equations of `cophase_methods`, in the form that `differential-equations` requires.
struct Adapter<'a>(&'a dyn Equations);

impl<const N: usize> ODE<f64, [f64; N]> for Adapter<'_> {
    fn diff(&self, t_s: f64, y: &[f64; N], rates: &mut [f64; N]) {
        self.0.rates(t_s, y, rates);
    }

    fn jacobian(
        &self,
        t_s: f64,
        y: &[f64; N],
        jacobian: &mut differential_equations::linalg::Matrix<f64>,
    ) {
        let own = jacobian_of(self.0, t_s, y);
        for row in 0..N {
            for column in 0..N {
                jacobian[(row, column)] = own[(row, column)];
            }
        }
    }
}

/// Number of steps after which a solver returns an error.
const MAX_STEPS: usize = 1_000_000;

/// DOP853 of `differential-equations`, for equations that are not stiff.
pub fn dop853<const N: usize>(
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    tolerance: f64,
) -> [f64; N] {
    let method = ExplicitRungeKutta::dop853()
        .rtol(tolerance)
        .atol(tolerance)
        .max_steps(MAX_STEPS);
    solved(equations, start, end_s, method)
}

/// BDF of `differential-equations`, for stiff equations.
pub fn bdf<const N: usize>(
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    tolerance: f64,
    absolute: f64,
) -> [f64; N] {
    let method = BackwardDifferentiationFormula::adaptive()
        .rtol(tolerance)
        .atol(absolute)
        .max_steps(MAX_STEPS);
    solved(equations, start, end_s, method)
}

/// Radau IIA of order 5 of `differential-equations`, for stiff equations.
pub fn radau5<const N: usize>(
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    tolerance: f64,
    absolute: f64,
) -> [f64; N] {
    let method = ImplicitRungeKutta::radau5()
        .rtol(tolerance)
        .atol(absolute)
        .max_steps(MAX_STEPS);
    solved(equations, start, end_s, method)
}

/// State at the end, by a method of `differential-equations`.
fn solved<const N: usize>(
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    method: impl OrdinaryNumericalMethod<f64, [f64; N]> + Interpolation<f64, [f64; N]>,
) -> [f64; N] {
    let solution = IVP::ode(&Adapter(equations), 0.0, end_s, start)
        .method(method)
        .solve()
        .expect("a solution");
    assert_eq!(solution.t.last(), Some(&end_s));
    *solution.y.last().unwrap()
}

/// BDF of `diffsol`.
pub fn bdf_of_diffsol<const N: usize>(
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    tolerance: f64,
    absolute: f64,
) -> [f64; N] {
    let problem = builder::<N>(tolerance, absolute)
        .rhs_implicit(
            |y, _, t_s, rates| {
                equations.rates(t_s, y, rates);
            },
            |y, _, t_s, direction, product| {
                let jacobian = jacobian_of(equations, t_s, y);
                let along = jacobian * DVector::from_column_slice(direction);
                product.copy_from_slice(along.as_slice());
            },
        )
        .init(|_, _, y| y.copy_from_slice(&start), N)
        .build()
        .expect("a problem");
    end(problem.bdf::<NalgebraLU<f64>>().expect("BDF"), end_s)
}

/// Tsitouras' explicit method of orders 5 and 4, of `diffsol`, for equations that are not stiff.
pub fn tsit45<const N: usize>(
    equations: &dyn Equations,
    start: [f64; N],
    end_s: f64,
    tolerance: f64,
    absolute: f64,
) -> [f64; N] {
    let problem = builder::<N>(tolerance, absolute)
        .rhs(|y, _, t_s, rates| equations.rates(t_s, y, rates))
        .init(|_, _, y| y.copy_from_slice(&start), N)
        .build()
        .expect("a problem");
    end(problem.tsit45().expect("TSIT45"), end_s)
}

fn builder<const N: usize>(tolerance: f64, absolute: f64) -> OdeBuilder<NalgebraMat<f64>> {
    OdeBuilder::new().rtol(tolerance).atol(vec![absolute; N])
}

/// State at the end, by a method of `diffsol`.
fn end<'a, Eqn, const N: usize>(mut solver: impl OdeSolverMethod<'a, Eqn>, end_s: f64) -> [f64; N]
where
    Eqn: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
{
    let (states, times, _) = solver.solve(end_s).expect("a solution");
    assert_eq!(times.last(), Some(&end_s));
    let last = states.inner().column(times.len() - 1);
    core::array::from_fn(|i| last[i])
}

fn jacobian_of(equations: &dyn Equations, t_s: f64, y: &[f64]) -> DMatrix<f64> {
    let n = equations.dimension();
    let mut jacobian = DMatrix::zeros(n, n);
    equations.jacobian(
        t_s,
        y,
        &mut cophase_methods::Differences::new(n),
        &mut jacobian,
    );
    jacobian
}
