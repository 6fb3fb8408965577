use crate::machines::crusher::mains::OnMains;
use crate::machines::crusher::mains::Shape;
use cophase_methods::{Equations, Scheme, advance};

use super::*;
use crate::drives::{Induction, Motor};
use crate::dynamics::Driven;
use crate::dynamics::plant::PlantRotors;

const FLYWHEEL_KGM2: f64 = 40.79;

fn crusher(peak_n: f64) -> Crusher {
    Crusher {
        linkage: Linkage::SOURCE,
        jaw: Jaw::SOURCE,
        load: Load::new(Shape::LinearRise, peak_n, &Linkage::SOURCE),
        fed_rad: 0.0..1e6,
        flywheel_kgm2: FLYWHEEL_KGM2,
        motor_nm: None,
    }
}

/// If this fails, the simulated crusher differs from the one that is verified against the published speeds.
#[test]
fn the_plant_moves_as_the_published_crusher() {
    let published = OnMains::SOURCE.with_rock(Shape::LinearRise, 1.3e6);
    let (ours, rotors_kgm2) = (crusher(1.3e6), vec![FLYWHEEL_KGM2]);
    for k in 0..360 {
        let (phi, omega) = (TAU * f64::from(k) / 360.0, 20.0 + f64::from(k % 9));
        let mut rates = [0.0; 2];
        published.rates(0.0, &[phi, omega], &mut rates);
        let shafts = Shafts {
            rotors_kgm2: &rotors_kgm2,
            torques_nm: &[published.motor_nm(omega) - resistance_nm(&ours, phi)],
            held: &[false],
        };
        let mut a = [0.0];
        ours.accelerations(&shafts, &[phi], &[omega], &mut a);
        assert!(
            (a[0] - rates[1]).abs() < 1e-9 * (1.0 + rates[1].abs()),
            "{k}"
        );
    }
}

/// If this fails, the changing inertia creates or absorbs energy. Without rock and motor the energy is constant.
#[test]
fn energy_is_conserved() {
    let off = Motor::Induction(Induction::new(0.0, 1.0, 2.0, 1.0));
    let on = PlantRotors::new(
        vec![FLYWHEEL_KGM2],
        vec![0.0],
        std::sync::Arc::new(crusher(0.0)),
    );
    let driven = Driven::new(Box::new(on), vec![off]);
    let mut state = vec![0.3, 27.0];
    let before = driven.energy_j(&state);
    let mut method = Scheme::Rk4.prepare(&driven, 5e-4).unwrap();
    advance(method.as_mut(), &driven, 0.0, 20_000, &mut state).unwrap();
    let after = driven.energy_j(&state);
    assert!((after / before - 1.0).abs() < 1e-9, "{before} J, {after} J");
}

fn resistance_nm(crusher: &Crusher, phi: f64) -> f64 {
    crusher.resistance_nm(0, &[phi]).unwrap()
}

/// If this fails, rock pushes back a shaft that it has stopped, or drives one at standstill. Broken rock has no spring force.
#[test]
fn rock_brakes_and_does_not_push() {
    let ours = crusher(1.3e6);
    let [from, to] = ours.load.acts_rad();
    let phi = 0.5 * (from + to);
    let empty = Crusher {
        fed_rad: 100.0..200.0,
        ..ours.clone()
    };
    let acceleration = |crusher: &Crusher, omega: f64, load_nm: f64| {
        let rotors_kgm2 = vec![FLYWHEEL_KGM2];
        let on = PlantRotors::new(rotors_kgm2, vec![0.0], std::sync::Arc::new(crusher.clone()));
        let off = Motor::Induction(Induction::new(0.0, 1.0, 2.0, 1.0));
        let mut driven = Driven::new(Box::new(on), vec![off]);
        driven.loads_nm[0] = load_nm;
        let mut rates = [0.0; 2];
        driven.rates(0.0, &[phi, omega], &mut rates);
        rates[1]
    };
    let braked = acceleration(&ours, 10.0, 0.0) - acceleration(&empty, 10.0, 0.0);
    assert!(braked < -1000.0 / (2.0 * FLYWHEEL_KGM2), "{braked}");
    // It holds a shaft against the motor, up to its torque, and lets go of one that turns back.
    assert_eq!(acceleration(&ours, 0.0, 0.0), 0.0);
    assert_eq!(
        acceleration(&ours, 0.0, -0.99 * resistance_nm(&ours, phi)),
        0.0
    );
    assert!(acceleration(&ours, 0.0, -1.01 * resistance_nm(&ours, phi)) > 0.0);
    for (omega, load_nm) in [(-10.0, 0.0), (0.0, 50.0)] {
        let free = acceleration(&empty, omega, load_nm);
        assert_eq!(acceleration(&ours, omega, load_nm), free);
    }
    assert_eq!(resistance_nm(&empty, phi), 0.0);
}

/// If this fails, the jaw's acceleration is not the second derivative of its position, or the amplitude is not the largest one.
#[test]
fn jaw_acceleration_is_the_second_derivative_of_position() {
    let ours = crusher(0.0);
    let omega = 27.0;
    let place = |phi: f64| ours.pose(&[phi / TAU], omega, 0.0).z_m;
    let h = 1e-3;
    let mut max = 0.0_f64;
    for k in 0..720 {
        let phi = TAU * f64::from(k) / 720.0;
        let difference = (place(phi + h) - 2.0 * place(phi) + place(phi - h)) / (h * h);
        let pose = ours.pose(&[phi / TAU], omega, 0.0);
        assert!((pose.accel_mps2 - difference * omega * omega).abs() < 1e-4);
        max = max.max(pose.accel_mps2.abs());
        // The rock's lever is perpendicular to the actual jaw, and the displacement to the jaw at angle 0. They differ by
        // the eccentric's velocity along the jaw, times the angle between them.
        let slope = (place(phi + h) - place(phi - h)) / (2.0 * h);
        let between = ours.linkage.at(phi).jaw_rad - ours.linkage.at(0.0).jaw_rad;
        let off_m = (slope - ours.linkage.closing_m(phi)).abs();
        assert!(
            off_m < ours.linkage.eccentric_m * between.abs() + 1e-6,
            "{k}"
        );
    }
    assert!((max / (ours.amplitude_m() * omega * omega) - 1.0).abs() < 1e-4);
}
