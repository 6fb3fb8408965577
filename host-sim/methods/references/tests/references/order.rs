//! Every method has its stated order.
//!
//! If this fails, a coefficient, a stage time or a sign is wrong, and the slope of log error against log step differs from the
//! order. The slope is measured on a damped and driven pendulum, which is far from linear. For all methods, including the exact
//! one, it is also measured on a damped oscillator whose solution is a formula.
//!
//! `cargo test -p cophase-references order:: -- --nocapture` prints the slopes.

use cophase_methods::problems::{Oscillator, Pendulum};
use cophase_methods::{Needs, Scheme};
use cophase_references::reference;
use cophase_references::slope::Slope;

use super::difference;
use super::support::play;

/// Permitted difference between a slope and the order.
const MARGIN: f64 = 0.1;

/// Machine on which the order is measured, from its start to `end_s`, in `coarsest` steps and up to a hundred times as many.
///
/// Over two decades of step, an error of order 4 covers eight decades. At coarser steps, the next term of the error has a share
/// of some per cent. At finer steps, the error falls to rounding, or to the uncertainty of the reference. So the machines for
/// methods of order 4 run for a long time with little damping: the method's error accumulates over the run, and rounding hardly
/// does.
struct Case<M> {
    machine: M,
    end_s: f64,
    coarsest: u32,
}

impl<M> Case<M> {
    /// Step counts of a sweep, six per decade, over two decades.
    fn sweep(&self) -> impl Iterator<Item = u32> + use<M> {
        let coarsest = f64::from(self.coarsest);
        (0..=12).map(move |i| (coarsest * 10_f64.powf(f64::from(i) / 6.0)).round() as u32)
    }
}

/// Errors below this multiple of the reference's error, or below this multiple of rounding, are left out.
const REFERENCE_SHARE: f64 = 10.0;

#[test]
fn methods_have_their_order_on_a_damped_driven_pendulum() {
    let short = |coarsest| Case {
        machine: Pendulum::DRIVEN,
        end_s: 10.0,
        coarsest,
    };
    on_a_pendulum(1, [2.0, 0.0], &short(2000));
    on_a_pendulum(2, [2.0, 0.0], &short(200));
    let long = Case {
        machine: Pendulum {
            damping: 0.02,
            torque: 0.1,
            ..Pendulum::DRIVEN
        },
        end_s: 100.0,
        coarsest: 300,
    };
    on_a_pendulum(4, [1.0, 0.0], &long);
}

fn on_a_pendulum(order: u32, start: [f64; 2], case: &Case<Pendulum>) {
    let (machine, end_s) = (&case.machine, case.end_s);
    let truth = reference::dop853(machine, start, end_s, 1e-14);
    let other = reference::tsit45(machine, start, end_s, 1e-14, 1e-14);
    let bdf = reference::bdf_of_diffsol(machine, start, end_s, 1e-14, 1e-15);
    let uncertainty = difference(&truth, &other);
    println!(
        "DOP853 and TSIT45 differ by {uncertainty:.1e}, DOP853 and BDF by {:.1e}",
        difference(&truth, &bdf)
    );
    for scheme in Scheme::ALL {
        let facts = scheme.facts();
        if facts.needs == Needs::Linear || facts.order != order {
            continue;
        }
        let mut slope = Slope::default();
        for steps in case.sweep() {
            let y = play(scheme, machine, start, end_s, steps).unwrap();
            let error = difference(&y, &truth);
            if error > REFERENCE_SHARE * uncertainty {
                slope.add(end_s / f64::from(steps), error);
            }
        }
        judge(scheme, &slope);
    }
}

#[test]
fn methods_have_their_order_on_a_driven_oscillator() {
    let start = [1.0, 0.0];
    for scheme in Scheme::ALL {
        let (zeta, end_s, coarsest) = match scheme.facts().order {
            1 => (0.1, 4.0, 2000),
            2 => (0.1, 4.0, 200),
            _ => (0.005, 40.0, 400),
        };
        let machine = Oscillator {
            omega_rad_s: 3.0,
            zeta,
            force: 2.0,
            drive_rad_s: 1.3,
        };
        let case = Case {
            machine,
            end_s,
            coarsest,
        };
        let truth = machine.exact(end_s, start);
        let mut slope = Slope::default();
        for steps in case.sweep() {
            let y = play(scheme, &machine, start, end_s, steps).unwrap();
            // Each step rounds a state of some 3 m/s by some ε, in either direction.
            let rounding = 3.0 * f64::EPSILON * f64::from(steps).sqrt();
            let error = difference(&y, &truth);
            if error > REFERENCE_SHARE * rounding {
                slope.add(end_s / f64::from(steps), error);
            }
        }
        judge(scheme, &slope);
    }
}

fn judge(scheme: Scheme, slope: &Slope) {
    let (measured, decades, errors) = (slope.least_squares(), slope.decades(), slope.errors());
    let order = f64::from(scheme.facts().order);
    println!(
        "{:20} slope {measured:.3} over {decades:.2} decades, errors {:.1e} to {:.1e}",
        scheme.facts().name,
        errors.0,
        errors.1
    );
    assert!(
        (measured - order).abs() < MARGIN,
        "{scheme}: slope {measured}, order {order}"
    );
    assert!(decades > 1.99, "{scheme}: only {decades} decades");
}
