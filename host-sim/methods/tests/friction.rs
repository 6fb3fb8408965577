//! Dry friction: every method sticks and slips alike, and keeps its order.

use cophase_methods::friction::{self, Contact, Contacts, DryFriction};
use cophase_methods::problems::DenHartog;
use cophase_methods::problems::den_hartog::Phase;
use cophase_methods::{Equations, Scheme, advance};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Advances a machine from rest.
fn advanced(scheme: Scheme, machine: &DenHartog, end_s: f64, steps: u32) -> [f64; 2] {
    let mut y = [0.0; 2];
    let mut method = scheme.prepare(machine, end_s / f64::from(steps)).unwrap();
    advance(method.as_mut(), machine, 0.0, steps, &mut y).unwrap();
    y
}

/// If this fails, friction has another size than the published one, or acts at another moment. Den Hartog's amplitude is that of the
/// steady motion. The start dies out: friction takes it within some periods.
#[test]
fn the_steady_motion_has_den_hartogs_amplitude() {
    let machine = DenHartog::NON_STOPPING;
    let published = machine.amplitude();
    let period_s = std::f64::consts::TAU / machine.drive_rad_s;
    for scheme in Scheme::ALL {
        let (mut y, steps) = ([0.0; 2], 2000);
        let step_s = period_s / f64::from(steps);
        let mut method = scheme.prepare(&machine, step_s).unwrap();
        let mut max: f64 = 0.0;
        for step in 0..60 * steps {
            method
                .step(&machine, f64::from(step) * step_s, &mut y)
                .unwrap();
            if step >= 55 * steps {
                max = max.max(y[0].abs());
            }
        }
        // Methods of order 1 are off by their step, and the start by e to the number of periods.
        let allowed = if scheme.facts().order == 1 {
            2e-2
        } else {
            2e-5
        };
        let off = (max / published - 1.0).abs();
        assert!(off < allowed, "{scheme}: {max} for {published}");
    }
}

/// If this fails, a formula of the judge is wrong. Its parts have to join, obey the law of friction, and be one stop in each half period.
#[test]
fn the_formula_sticks_once_in_each_half_period() {
    let machine = DenHartog::STOPPING;
    let period_s = std::f64::consts::TAU / machine.drive_rad_s;
    let phases = machine.phases(20.0 * period_s, [0.0; 2]);
    let late: Vec<_> = phases
        .iter()
        .filter(|phase| phase.from_s > 10.0 * period_s)
        .collect();
    let (sticks, slips): (Vec<&Phase>, Vec<&Phase>) =
        late.iter().partition(|phase| phase.direction == 0.0);
    assert!((19..=21).contains(&sticks.len()), "{}", sticks.len());
    assert!(
        slips
            .windows(2)
            .all(|pair| pair[0].direction == -pair[1].direction)
    );
    for (phase, next) in phases.iter().zip(&phases[1..]) {
        assert_eq!(next.start[1], 0.0, "{phase:?}");
        let force = machine.force * (machine.drive_rad_s * next.from_s).cos()
            - machine.omega_rad_s.powi(2) * next.start[0];
        if phase.direction == 0.0 {
            assert!(
                (force.abs() / machine.friction - 1.0).abs() < 1e-9,
                "{force}"
            );
            assert_eq!(next.direction, force.signum());
        }
    }
}

/// If this fails, a change of contact costs a method its order: it happens at another moment than where the speed or the force passes.
#[test]
fn every_method_keeps_its_order_through_stick_and_slip() {
    let machine = DenHartog::STOPPING;
    let end_s = 0.5;
    let exact = machine.exact(end_s, [0.0; 2]);
    assert!(machine.phases(end_s, [0.0; 2]).len() > 8);
    for scheme in Scheme::ALL {
        let steps: [u32; 2] = match scheme.facts().order {
            1 => [4000, 32_000],
            2 => [1000, 8000],
            _ => [250, 2000],
        };
        let off = steps.map(|steps| {
            let y = advanced(scheme, &machine, end_s, steps);
            (y[0] - exact[0]).abs()
        });
        let order = (off[0] / off[1]).log(8.0);
        println!(
            "{scheme}: order {order:.2}, errors {:.1e} and {:.1e} m",
            off[0], off[1]
        );
        let min = f64::from(scheme.facts().order) - 0.3;
        assert!(order > min, "{scheme}: {order}, {off:?}");
    }
}

/// If this fails, a mass drifts or shakes that friction holds.
#[test]
fn a_mass_under_less_than_its_friction_stands() {
    let machine = DenHartog {
        force: 0.999 * DenHartog::STOPPING.friction,
        ..DenHartog::STOPPING
    };
    for scheme in Scheme::ALL {
        for steps in [3, 100, 1000] {
            let y = advanced(scheme, &machine, 1.0, steps);
            assert_eq!(y, [0.0; 2], "{scheme}, {steps} steps");
        }
    }
}

/// If this fails, the energy that friction takes is wrong. A free mass loses 2 F/ω² of its amplitude in each half swing, and stops at
/// the first turning point within F/ω² (H. Lorenz, 1924).
#[test]
fn a_free_mass_stops_at_its_turning_point() {
    let machine = DenHartog {
        force: 1e-12,
        ..DenHartog::STOPPING
    };
    let unit_m = machine.friction / machine.omega_rad_s.powi(2);
    for scheme in Scheme::ALL {
        let mut y = [6.6 * unit_m, 0.0];
        let fine = if scheme.facts().order == 1 {
            1e-6
        } else {
            1e-4
        };
        let mut method = scheme.prepare(&machine, fine).unwrap();
        advance(method.as_mut(), &machine, 0.0, (0.2 / fine) as u32, &mut y).unwrap();
        // 6.6 − 2 − 2 − 2, on the other side after three half swings.
        assert_eq!(y[1], 0.0, "{scheme}");
        let off = (y[0] / unit_m + 0.6).abs();
        assert!(off < 5e-3, "{scheme}: {}", y[0] / unit_m);
    }
}

/// Masses that act on each other: M v′ = force + friction, state v.
#[derive(Debug)]
struct Coupled {
    mobility: DMatrix<f64>,
    force: DVector<f64>,
    friction: Vec<f64>,
    speeds: Vec<usize>,
}

impl DryFriction for Coupled {
    fn speeds(&self) -> &[usize] {
        &self.speeds
    }

    fn bounds(&self, _: &[f64], bounds: &mut [[f64; 2]]) {
        for (bounds, friction) in bounds.iter_mut().zip(&self.friction) {
            *bounds = [-friction, *friction];
        }
    }

    /// A mass that is held has a force that makes its acceleration 0: that of the other masses' equations.
    fn rates_with(&self, _: f64, _: &[f64], contacts: &[Contact], rates: &mut [f64]) {
        let free: Vec<usize> = (0..contacts.len())
            .filter(|i| contacts[*i] != Contact::Sticks)
            .collect();
        rates.fill(0.0);
        if free.is_empty() {
            return;
        }
        let inertia = self.mobility.clone().try_inverse().unwrap();
        let mass = DMatrix::from_fn(free.len(), free.len(), |i, j| inertia[(free[i], free[j])]);
        let force = DVector::from_fn(free.len(), |i, _| match contacts[free[i]] {
            Contact::Free(force) => self.force[free[i]] + force,
            Contact::Forwards => self.force[free[i]] - self.friction[free[i]],
            Contact::Backwards => self.force[free[i]] + self.friction[free[i]],
            Contact::Sticks => unreachable!(),
        });
        let solved = mass.lu().solve(&force).unwrap();
        for (i, rate) in free.iter().zip(solved.iter()) {
            rates[*i] = *rate;
        }
    }
}

proptest! {
    /// If this fails, masses that act on each other stick although friction cannot hold them, or slide against its direction. The law is
    /// checked as it stands: a mass that sticks needs at most its friction, and one that slides moves against it.
    #[test]
    fn coupled_contacts_obey_the_law_of_friction(
        n in 1..=6_usize,
        entries in prop::collection::vec(-1.0..1.0_f64, 36),
        forces in prop::collection::vec(-3.0..3.0_f64, 6),
        frictions in prop::collection::vec(0.1..2.0_f64, 6),
    ) {
        let root = DMatrix::from_fn(n, n, |i, j| entries[6 * i + j]);
        let machine = Coupled {
            mobility: &root * root.transpose() + DMatrix::identity(n, n) * 0.05,
            force: DVector::from_fn(n, |i, _| forces[i]),
            friction: frictions[..n].to_vec(),
            speeds: (0..n).collect(),
        };
        let (y, mut rates) = (vec![0.0; n], vec![0.0; n]);
        let contacts = Contacts::in_state(&machine, 0.0, &y, &mut rates);
        friction::rates(&machine, 0.0, &y, &mut rates);
        // The friction that acts is what the inertia times the acceleration lacks.
        let inertia = machine.mobility.clone().try_inverse().unwrap();
        let acts = inertia * DVector::from_column_slice(&rates) - &machine.force;
        for (i, contact) in contacts.iter().enumerate() {
            let max = machine.friction[i];
            match contact {
                Contact::Sticks => {
                    prop_assert_eq!(rates[i], 0.0);
                    prop_assert!(acts[i].abs() <= max + 1e-9, "{} of {max}", acts[i]);
                }
                Contact::Forwards => {
                    prop_assert!(rates[i] >= 0.0 && (acts[i] + max).abs() < 1e-9);
                }
                Contact::Free(_) => prop_assert!(false, "no contact is free"),
                Contact::Backwards => {
                    prop_assert!(rates[i] <= 0.0 && (acts[i] - max).abs() < 1e-9);
                }
            }
        }
    }
}

/// If this fails, a method that is far beyond its limit makes no end of events, or a value that is no number from them.
#[test]
fn a_step_of_any_length_ends() {
    let machine = DenHartog::STOPPING;
    for scheme in Scheme::ALL {
        for step_s in [1e-3, 0.05, 1.0, 30.0] {
            let mut method = scheme.prepare(&machine, step_s).unwrap();
            let mut y = [0.02, 0.0];
            for step in 0..50 {
                if method
                    .step(&machine, f64::from(step) * step_s, &mut y)
                    .is_err()
                {
                    break;
                }
            }
            assert!(y.iter().all(|y| y.is_finite()), "{scheme}, {step_s} s");
        }
    }
    assert!(machine.friction().is_some());
}
