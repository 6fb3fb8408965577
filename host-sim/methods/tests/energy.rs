//! Conservation of the energy of an undamped machine over 10,000 periods, for each method.
//!
//! A method conserves an energy that differs a little from the true one. So the true energy ripples within each period, by up
//! to hω/2 for symplectic Euler. It must not drift over the run. So the energy is averaged over 100 periods at the start and
//! at the end ([`Ends`]).

use core::f64::consts::TAU;

use cophase_methods::drift::Ends;
use cophase_methods::problems::{Oscillator, Pendulum};
use cophase_methods::{Equations, Needs, Scheme};

const PERIODS: u32 = 10_000;
const WINDOW_PERIODS: u32 = 100;

/// Steps per radian. A period of either machine is not a whole number of steps, so the samples cover all phases of the
/// ripple.
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

/// If this fails, a method is wrongly listed as conserving energy, and a machine runs down or up over hours. Or it is wrongly
/// listed as not conserving energy, and a user rejects the cheaper method.
#[test]
fn methods_conserve_oscillator_energy_as_listed() {
    let machine = Oscillator::free(1.0, 0.0);
    for scheme in Scheme::ALL {
        judge(scheme, drift(scheme, &machine, TAU, |y| machine.energy(y)));
    }
}

/// The same for an energy that is not quadratic, and therefore not an invariant of the midpoint method. The period of a swing
/// of 1 rad is 4 K(sin ½) = 6.6998.
#[test]
fn methods_conserve_pendulum_energy_as_listed() {
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
