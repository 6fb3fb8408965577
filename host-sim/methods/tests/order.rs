//! Every method has the order it states.
//!
//! Were a coefficient, a stage time or a sign wrong, the slope of log error against log step would be another one. It is
//! measured on a pendulum, damped and driven, far from linear, and for all methods, the exact one included, on a
//! damped oscillator whose solution is a formula.
//!
//! `cargo test -p cophase-methods --test order -- --nocapture` prints the slopes.

mod support;

use cophase_methods::problems::{Oscillator, Pendulum};
use cophase_methods::{Needs, Scheme};
use support::slope::Slope;
use support::{difference, play, reference};

/// How far a slope may be from the order.
const MARGIN: f64 = 0.1;

/// Steps over the whole time, of the longest step: the first of a sweep over two decades. Coarser, the next term of the
/// error has a share of more than some per cent in it; finer, a method of order 4 reaches rounding before the end.
fn coarsest(order: u32) -> u32 {
    match order {
        1 => 2000,
        2 => 200,
        _ => 30,
    }
}

/// Steps of a sweep, six to the decade, over two decades.
fn sweep(scheme: Scheme) -> impl Iterator<Item = u32> {
    let coarsest = f64::from(coarsest(scheme.facts().order));
    (0..=12).map(move |i| (coarsest * 10_f64.powf(f64::from(i) / 6.0)).round() as u32)
}

/// Errors below this many times the error of the reference are left out.
const REFERENCE_SHARE: f64 = 10.0;

#[test]
fn on_a_damped_and_driven_pendulum() {
    let (start, end_s) = ([2.0, 0.0], 10.0);
    let machine = Pendulum::DRIVEN;
    let truth = reference::dop853(&machine, start, end_s, 1e-14);
    let other = reference::tsit45(&machine, start, end_s, 1e-14, 1e-14);
    let bdf = reference::bdf_of_diffsol(&machine, start, end_s, 1e-14, 1e-15);
    let doubt = difference(&truth, &other).max(difference(&truth, &bdf));
    println!("DOP853, TSIT45 and diffsol's BDF differ by {doubt:.1e}");
    for scheme in Scheme::ALL {
        if scheme.facts().needs == Needs::Linear {
            continue;
        }
        let mut slope = Slope::default();
        for steps in sweep(scheme) {
            let y = play(scheme, &machine, start, end_s, steps).unwrap();
            let error = difference(&y, &truth);
            if error > REFERENCE_SHARE * doubt {
                slope.add(end_s / f64::from(steps), error);
            }
        }
        judge(scheme, &slope);
    }
}

#[test]
fn on_a_driven_oscillator() {
    let machine = Oscillator {
        omega_rad_s: 3.0,
        zeta: 0.1,
        force: 2.0,
        drive_rad_s: 1.3,
    };
    let (start, end_s) = ([1.0, 0.0], 4.0);
    let truth = machine.exact(end_s, start);
    for scheme in Scheme::ALL {
        let mut slope = Slope::default();
        for steps in sweep(scheme) {
            let y = play(scheme, &machine, start, end_s, steps).unwrap();
            // Rounding of as many steps, and of the formula.
            let rounding = f64::EPSILON * f64::from(steps);
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
    // Two decades for orders 1 and 2. Order 4 falls to the doubt of the reference, or to rounding, before their end.
    let least = if order < 4.0 { 1.99 } else { 1.6 };
    assert!(decades > least, "{scheme}: only {decades} decades");
}
