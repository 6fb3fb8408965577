//! Failures are typed errors and leave the state unchanged.

use cophase_methods::problems::{Andrews, Hires, Oscillator};
use cophase_methods::{Equations, Needs, Refused, Scheme, StepError};

/// Rates that are not a number from y = 1 on.
struct Edge;

impl Equations for Edge {
    fn dimension(&self) -> usize {
        1
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        rates[0] = 1.0 + (1.0 - y[0]).sqrt();
    }
}

/// y′ = 1 + y². A stage with hγ = c has to solve w = y + c (1 + w²), which has no real solution for c above 1/2.
struct Runaway;

impl Equations for Runaway {
    fn dimension(&self) -> usize {
        1
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        rates[0] = 1.0 + y[0] * y[0];
    }
}

/// y′ = y: I − hγJ is singular at hγ = 1.
struct Growth;

impl Equations for Growth {
    fn dimension(&self) -> usize {
        1
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        rates[0] = y[0];
    }

    fn jacobian(
        &self,
        _: f64,
        _: &[f64],
        _: &mut cophase_methods::Differences,
        jacobian: &mut nalgebra::DMatrix<f64>,
    ) {
        jacobian[(0, 0)] = 1.0;
    }
}

/// A rotor behind a speed loop whose torque saturates within 0.06 rad/s: ω′ = push − rate · tanh(ω/0.06), in rad/s².
struct Saturating {
    push: f64,
    rate: f64,
}

impl Equations for Saturating {
    fn dimension(&self) -> usize {
        1
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        rates[0] = self.push - self.rate * (y[0] / 0.06).tanh();
    }
}

/// If this fails, corrections are not damped. They jump from one saturated side to the other, and a strong loop cannot bring its rotor
/// to rest.
#[test]
fn a_saturating_loop_brings_a_rotor_to_rest() {
    for scheme in [Scheme::ImplicitMidpoint, Scheme::Sdirk4] {
        for rate in [10.0, 100.0, 1e3, 1e4, 1e5] {
            for part in [-0.9, 0.0, 0.3, 0.9] {
                let rotor = Saturating {
                    push: part * rate,
                    rate,
                };
                for speed in [-40.0_f64, -0.7, 0.01, 3.0, 20.0] {
                    let mut method = scheme.prepare(&rotor, 5e-4).unwrap();
                    let mut y = [speed];
                    // Twice the stopping time with a tenth of the torque: that much remains at the largest push.
                    let steps = 2.0 * speed.abs() / (rate * 0.1 * 5e-4) + 100.0;
                    for step in 0..(steps as u32).min(5_000) {
                        let stepped = method.step(&rotor, f64::from(step) * 5e-4, &mut y);
                        assert_eq!(
                            stepped,
                            Ok(()),
                            "{scheme}, {rate} from {speed}, step {step}"
                        );
                    }
                    if scheme == Scheme::Sdirk4 && (1e3..=1e4).contains(&rate) {
                        let at_rest = 0.06 * f64::atanh(part);
                        assert!(
                            (y[0] - at_rest).abs() < 1e-6,
                            "{rate} from {speed}: {}",
                            y[0]
                        );
                    }
                }
            }
        }
    }
}

/// If this fails, NaN is passed on or half a step is kept, and the machine has a state that it never reached.
#[test]
fn a_non_finite_value_is_reported_and_state_kept() {
    for scheme in Scheme::ALL {
        if !scheme.suits(&Edge) {
            continue;
        }
        let mut method = scheme.prepare(&Edge, 0.75).unwrap();
        let mut y = [0.5];
        let mut last = y;
        let error = loop {
            match method.step(&Edge, 0.0, &mut y) {
                Ok(()) => last = y,
                Err(error) => break error,
            }
        };
        assert_eq!(y, last, "{scheme}");
        assert!(y[0].is_finite(), "{scheme}");
        assert!(
            matches!(error, StepError::NotFinite { component: 0, .. }),
            "{scheme}: {error}"
        );
    }
}

/// If this fails, the iteration does not stop at its limit, or the limit is not reported and the state has an error of any
/// size.
#[test]
fn an_equation_without_solution_is_reported() {
    for scheme in [Scheme::ImplicitMidpoint, Scheme::Sdirk4] {
        let mut method = scheme.prepare(&Runaway, 8.0).unwrap();
        let mut y = [0.1];
        let error = method.step(&Runaway, 2.0, &mut y).unwrap_err();
        assert!(
            matches!(error, StepError::NotConverged { t_s: 2.0, .. }),
            "{scheme}: {error}"
        );
        assert_eq!(y, [0.1]);
        assert!(
            error.to_string().ends_with("take a shorter step"),
            "{error}"
        );
    }
}

/// If this fails, the solver divides by a zero pivot, and the stage is infinite.
#[test]
fn a_singular_matrix_is_reported() {
    let mut midpoint = Scheme::ImplicitMidpoint.prepare(&Growth, 2.0).unwrap();
    let mut y = [1.0];
    assert_eq!(
        midpoint.step(&Growth, 0.0, &mut y),
        Err(StepError::Singular { t_s: 0.0 })
    );
    assert_eq!(y, [1.0]);
}

/// If this fails, a method is prepared for equations without the structure that it requires, and gives a wrong result
/// without an error.
#[test]
fn structure_and_step_are_checked_on_preparation() {
    for step_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for scheme in Scheme::ALL {
            let refused = scheme
                .prepare(&Oscillator::free(1.0, 0.0), step_s)
                .unwrap_err();
            assert!(matches!(refused, Refused::Step(_)), "{scheme}: {refused}");
        }
    }
    for scheme in Scheme::ALL {
        let made = scheme.prepare(&Hires, 1.0);
        assert_eq!(
            made.is_ok(),
            scheme.facts().needs == Needs::Rates,
            "{scheme}"
        );
        let made = scheme.prepare(&Andrews, 1.0);
        assert_eq!(
            made.is_ok(),
            scheme.facts().needs != Needs::Linear,
            "{scheme}"
        );
        assert_eq!(made.is_ok(), scheme.suits(&Andrews));
    }
    let refused = Scheme::Exact.prepare(&Hires, 1.0).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "exact discretisation needs a linear system with a constant matrix, which these equations do not offer: take RK4, or an implicit method if they are stiff"
    );
}
