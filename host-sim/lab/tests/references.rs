//! Checks of the solutions against which charts measure errors. Two methods of a library, which are not under test, solve each
//! problem again.
//!
//! `cargo test -p cophase-lab --test integration references:: -- --nocapture` prints how far they differ from each other.

use cophase_lab::chart::methods::problems::{self, Problem, STICK_SLIP_S};
use cophase_methods::Equations;
use cophase_methods::friction::{Contact, DryFriction};
use cophase_methods::problems::DenHartog;
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
    let adapter = Adapter(problem.equations[0].as_ref());
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

/// Adapter of an oscillator that slides in one direction, or sticks.
struct Sliding(DenHartog, Contact);

impl ODE<f64, [f64; 2]> for Sliding {
    fn diff(&self, t_s: f64, y: &[f64; 2], rates: &mut [f64; 2]) {
        self.0.rates_with(t_s, y, &[self.1], rates);
    }
}

/// Returns the end state of the problem of dry friction, by both methods. They solve each part of the motion between the formula's
/// moments of change. Each part that slides has to end without speed, which shows that the moment is right.
fn solve_stick_slip() -> [Vec<f64>; 2] {
    let oscillator = DenHartog::STOPPING;
    let phases = oscillator.phases(STICK_SLIP_S, [0.0; 2]);
    let ends = phases[1..]
        .iter()
        .map(|phase| phase.from_s)
        .chain([STICK_SLIP_S]);
    let mut states = [[0.0; 2]; 2];
    let is_last = |end_s: f64| end_s == STICK_SLIP_S;
    for (phase, end_s) in phases.iter().zip(ends) {
        if phase.direction == 0.0 {
            continue;
        }
        let sliding = Sliding(
            oscillator,
            Contact::Free(-phase.direction * oscillator.friction),
        );
        for (state, verner) in states.iter_mut().zip([false, true]) {
            let ivp = IVP::ode(&sliding, phase.from_s, end_s, *state);
            let solved = if verner {
                let method = ExplicitRungeKutta::rkv988e().rtol(TOLERANCE);
                ivp.method(method.atol(1e-3 * TOLERANCE).max_steps(STEPS))
                    .solve()
            } else {
                let method = ExplicitRungeKutta::dop853().rtol(TOLERANCE);
                ivp.method(method.atol(1e-3 * TOLERANCE).max_steps(STEPS))
                    .solve()
            };
            *state = *solved.expect("it is smooth").y.last().unwrap();
            if !is_last(end_s) {
                assert!(state[1].abs() < 1e-12, "{} m/s at {end_s} s", state[1]);
                state[1] = 0.0;
            }
        }
    }
    states.map(Vec::from)
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
            _ if problem.equations[0].friction().is_some() => solve_stick_slip(),
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
        let max = between.max(one).max(other);
        // The stated uncertainty is at least the measured one. It is at most 20 times larger, because otherwise the chart
        // hides visible errors.
        if max > problem.uncertainty || max < 0.05 * problem.uncertainty {
            wrong.push(format!(
                "{}: {max:e}, not {:e}",
                problem.name, problem.uncertainty
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
