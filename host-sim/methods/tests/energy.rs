//! Which methods keep the energy of an undamped machine over 10,000 periods.
//!
//! The energy a method keeps is not quite the true one: it ripples around it within each period, by up to hω/2 for symplectic
//! Euler. What must not happen is that it wanders off. So the energy is averaged over 100 periods at the start and at
//! the end ([`Ends`]).

mod support;

use core::f64::consts::TAU;

use cophase_methods::drift::Ends;
use cophase_methods::problems::{Oscillator, Pendulum};
use cophase_methods::{Equations, Needs, Scheme};

const PERIODS: u32 = 10_000;
const WINDOW_PERIODS: u32 = 100;

/// Not whole numbers a period of either machine, so that the ripple is met at all its phases.
const STEPS_PER_RADIAN: f64 = 10.3;

/// Largest relative drift that counts as conserved.
const KEPT: f64 = 1e-6;

/// Relative change of the mean energy; infinite if the state grew beyond `f64`.
fn drift(
    scheme: Scheme,
    machine: &dyn Equations,
    period: f64,
    energy: impl Fn(&[f64]) -> f64,
) -> f64 {
    let step = 1.0 / STEPS_PER_RADIAN;
    let mut method = scheme.prepare(machine, step).unwrap();
    let mut y = [1.0, 0.0];
    let steps = (f64::from(PERIODS) * period / step) as u32;
    let mut ends = Ends::new(steps, steps / (PERIODS / WINDOW_PERIODS));
    for i in 0..steps {
        ends.add(i, energy(&y));
        let t = f64::from(i) * step;
        if method.step(machine, t, &mut y).is_err() {
            return f64::INFINITY;
        }
    }
    let (first, last) = ends.means();
    (last / first - 1.0).abs()
}

fn judge(scheme: Scheme, drift: f64) {
    println!("{:20} {drift:.1e}", scheme.facts().name);
    if scheme.facts().keeps_energy {
        assert!(drift < KEPT, "{scheme}: {drift:e}");
    } else {
        assert!(drift > 10.0 * KEPT, "{scheme}: {drift:e}");
    }
}

/// Were a method wrongly said to keep energy, a machine would run down or up over hours; were one wrongly said not to, the
/// cheaper would be passed over.
#[test]
fn of_an_oscillator() {
    let machine = Oscillator::free(1.0, 0.0);
    for scheme in Scheme::ALL {
        judge(scheme, drift(scheme, &machine, TAU, |y| machine.energy(y)));
    }
}

/// The same where the energy is not quadratic, so that it is no invariant of the midpoint method. The period of a swing
/// of 1 rad is 4 K(sin ½) = 6.6998.
#[test]
fn of_a_pendulum() {
    let machine = Pendulum::FREE;
    for scheme in Scheme::ALL {
        if scheme.facts().needs == Needs::Linear {
            continue;
        }
        judge(
            scheme,
            drift(scheme, &machine, 6.6998, |y| machine.energy(y)),
        );
    }
}
