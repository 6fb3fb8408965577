//! What must hold of equations of motion whatever the numbers are: power in is energy gained, and each rung is the
//! one below where their assumptions meet.

use proptest::prelude::*;

use super::{Body, Phased, PlaneMotion, Rigid, Sprung};
use crate::mechanism::slider_crank::{Load, Platform, SliderCrank};

fn body(axes: usize, platform: Platform) -> Body {
    Body {
        mechanism: SliderCrank::new(0.012, 0.04).unwrap(),
        load: Load {
            mass_kg: 8.0,
            gravity_mps2: 9.80665,
            platform,
        },
        tilt_inertia_kgm2: 0.15,
        rotors_kgm2: (0..axes).map(|i| 1e-3 * (1.0 + 0.2 * i as f64)).collect(),
        mount_radius_m: 0.2,
        rod_n_per_m: 2e6,
        friction_nm: vec![0.0; axes],
    }
}

fn platforms() -> impl Strategy<Value = Platform> {
    prop_oneof![Just(Platform::Above), Just(Platform::Below)]
}

/// A machine's angles, speeds and torques.
fn states() -> impl Strategy<Value = (Vec<f64>, Vec<f64>, Vec<f64>)> {
    (2_usize..=6).prop_flat_map(|n| {
        let each = |range| prop::collection::vec(range, n);
        (each(-7.0..7.0), each(-200.0..200.0), each(-50.0..50.0))
    })
}

/// (E(t + h) − E(t − h)) / 2h for a motion that has these positions, speeds and accelerations at t.
fn power(energy: impl Fn(f64) -> f64) -> f64 {
    // Third-order terms are of the order of h² ω³: 1e-14 · 1e7 of some 1e3 J.
    const H_S: f64 = 1e-7;
    (energy(H_S) - energy(-H_S)) / (2.0 * H_S)
}

fn moved(places: &[f64], speeds: &[f64], accelerations: &[f64], t: f64) -> (Vec<f64>, Vec<f64>) {
    let place = |i: usize| places[i] + speeds[i] * t + 0.5 * accelerations[i] * t * t;
    let speed = |i: usize| speeds[i] + accelerations[i] * t;
    let all = 0..places.len();
    (all.clone().map(place).collect(), all.map(speed).collect())
}

fn close(found: f64, right: f64, scale: f64) -> Result<(), TestCaseError> {
    prop_assert!(
        (found - right).abs() <= 2e-6 * scale,
        "{found} is not {right}, at a scale of {scale}"
    );
    Ok(())
}

proptest! {
    /// Were it wrong, the shaft would need another torque to move than `cophase design` sizes motors for.
    #[test]
    fn a_rigid_shaft_moves_as_its_torque_was_reckoned(
        platform in platforms(),
        alpha in -7.0..7.0,
        omega in -200.0..200.0,
        acceleration in -1e4..1e4,
    ) {
        let machine = Rigid::new(body(4, platform));
        let rotors: f64 = machine.body().rotors_kgm2.iter().sum();
        let load = machine.body().load;
        let torque = machine.body().mechanism.torque_nm(&load, alpha, omega, acceleration)
            + rotors * acceleration;
        let found = machine.acceleration_rad_s2(alpha, omega, torque);
        prop_assert!((found - acceleration).abs() < 1e-9 * 1e4, "{found}, not {acceleration}");
    }

    /// Were it wrong, cranks in phase would load each other.
    #[test]
    fn cranks_in_phase_are_one_shaft(
        platform in platforms(),
        n in 2_usize..=6,
        alpha in -7.0..7.0,
        omega in -200.0..200.0,
        torque in -50.0..50.0,
    ) {
        let mut body = body(n, platform);
        body.rotors_kgm2.fill(2e-3);
        let apart = Phased::new(body.clone());
        let mut found = vec![0.0; n];
        apart.accelerations(&vec![alpha; n], &vec![omega; n], &vec![torque; n], &mut found);
        let together = Rigid::new(body).acceleration_rad_s2(alpha, omega, n as f64 * torque);
        for found in found {
            prop_assert!((found - together).abs() < 1e-9 * (1e3 + together.abs()));
        }
    }

    /// Were it wrong, a machine would make energy, or lose it, without anyone to give or take it.
    #[test]
    fn what_motors_give_a_phased_machine_is_what_it_gains(
        platform in platforms(),
        (alpha, omega, torque) in states(),
    ) {
        let machine = Phased::new(body(alpha.len(), platform));
        let mut acceleration = vec![0.0; alpha.len()];
        machine.accelerations(&alpha, &omega, &torque, &mut acceleration);
        let gained = power(|t| {
            let (alpha, omega) = moved(&alpha, &omega, &acceleration, t);
            machine.energy_j(&alpha, &omega)
        });
        let given: f64 = torque.iter().zip(&omega).map(|(torque, omega)| torque * omega).sum();
        // What flows to and fro between rotors and rods is larger than what comes in.
        let flow = 200.0 * 12e-3 * 2e6 * 24e-3;
        close(gained, given, flow)?;
    }

    /// As above, of a machine on springs.
    #[test]
    fn what_motors_give_a_sprung_machine_is_what_it_gains(
        platform in platforms(),
        (alpha, omega, torque) in states(),
        place in prop::array::uniform3(-1e-3..1e-3),
        rate in prop::array::uniform3(-1.0..1.0),
    ) {
        let machine = Sprung::new(body(alpha.len(), platform), 0.0);
        let plane = PlaneMotion { place, rate };
        let mut acceleration = vec![0.0; alpha.len()];
        let lifted = machine.accelerations(&alpha, &omega, &plane, &torque, &mut acceleration);
        let gained = power(|t| {
            let (alpha, omega) = moved(&alpha, &omega, &acceleration, t);
            let (place, rate) = moved(&plane.place, &plane.rate, &lifted, t);
            let plane = PlaneMotion {
                place: place.try_into().unwrap(),
                rate: rate.try_into().unwrap(),
            };
            machine.energy_j(&alpha, &omega, &plane)
        });
        let given: f64 = torque.iter().zip(&omega).map(|(torque, omega)| torque * omega).sum();
        let flow = 200.0 * 12e-3 * 2e6 * 60e-3;
        close(gained, given, flow)?;
    }
}

/// Were it wrong, damping in the rods would drive the machine.
#[test]
fn damped_rods_take_energy() {
    let machine = Sprung::new(body(4, Platform::Above), 0.1);
    let alpha = [0.3, 0.4, 0.2, 0.35];
    let heights = alpha.map(|alpha| machine.body().height_m(alpha));
    let plane = PlaneMotion {
        place: [heights[0], 0.0, 0.0],
        rate: [0.7, 0.0, 0.0],
    };
    let mut found = [0.0; 4];
    let lifted = machine.accelerations(&alpha, &[0.0; 4], &plane, &[0.0; 4], &mut found);
    let undamped = Sprung::new(body(4, Platform::Above), 0.0);
    let without = undamped.accelerations(&alpha, &[0.0; 4], &plane, &[0.0; 4], &mut [0.0; 4]);
    assert!(lifted[0] < without[0] - 1.0, "{lifted:?}, {without:?}");
}
