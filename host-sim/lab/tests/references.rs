//! Checks of the solutions against which charts measure errors. Two methods of a library, which are not under test, solve each
//! problem again.
//!
//! `cargo test -p cophase-lab --test references -- --nocapture` prints how far they differ from each other.

use cophase_lab::chart::methods::problems::{self, Problem};
use cophase_methods::Equations;
use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};

/// Adapter of this project's equations to `differential-equations`.
struct Adapter<'a>(&'a dyn Equations);

impl<const N: usize> ODE<f64, [f64; N]> for Adapter<'_> {
    fn diff(&self, t_s: f64, y: &[f64; N], rates: &mut [f64; N]) {
        self.0.rates(t_s, y, rates);
    }
}

const TOLERANCE: f64 = 1e-14;
const STEPS: usize = 1_000_000;

/// Returns the end state of a problem of `N` components by DOP853, and by Verner's pair of orders 9 and 8.
fn solve<const N: usize>(problem: &Problem) -> [Vec<f64>; 2] {
    let adapter = Adapter(problem.equations.as_ref());
    let start: [f64; N] = problem.start.clone().try_into().unwrap();
    let ivp = || IVP::ode(&adapter, 0.0, problem.end_s, start);
    let dop853 = ExplicitRungeKutta::dop853()
        .rtol(TOLERANCE)
        .atol(TOLERANCE)
        .max_steps(STEPS);
    let verner = ExplicitRungeKutta::rkv988e()
        .rtol(TOLERANCE)
        .atol(TOLERANCE)
        .max_steps(STEPS);
    let one = ivp().method(dop853).solve().expect("DOP853");
    let other = ivp().method(verner).solve().expect("Verner 9(8)");
    assert_eq!(one.t.last(), Some(&problem.end_s));
    [
        one.y.last().unwrap().to_vec(),
        other.y.last().unwrap().to_vec(),
    ]
}

/// Returns the largest difference in the compared components.
fn differ(a: &[f64], b: &[f64]) -> f64 {
    let each = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    each.fold(0.0, f64::max)
}

/// If this fails, a reference solution is wrong or less accurate than stated. A chart then shows the error of its own
/// reference as the error of a method.
#[test]
fn reference_answers_are_as_accurate_as_stated() {
    let mut wrong = Vec::new();
    for problem in problems::all().unwrap() {
        let [dop853, verner] = match problem.start.len() {
            2 => solve::<2>(&problem),
            4 => solve::<4>(&problem),
            6 => solve::<6>(&problem),
            8 => solve::<8>(&problem),
            14 => solve::<14>(&problem),
            n => panic!("{n} components"),
        };
        let compared = problem.answer.len();
        let between = differ(&dop853[..compared], &verner[..compared]);
        let (one, other) = (
            differ(&dop853, &problem.answer),
            differ(&verner, &problem.answer),
        );
        println!(
            "{}: the two differ by {between:.1e}, from the answer by {one:.1e} and {other:.1e}; {:?}",
            problem.name,
            &dop853[..compared]
        );
        let most = between.max(one).max(other);
        // The stated uncertainty is at least the measured one. It is at most 20 times larger, because otherwise the chart
        // hides visible errors.
        if most > problem.uncertainty || most < 0.05 * problem.uncertainty {
            wrong.push(format!(
                "{}: {most:e}, not {:e}",
                problem.name, problem.uncertainty
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
