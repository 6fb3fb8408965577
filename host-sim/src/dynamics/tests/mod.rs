//! Properties of the equations of motion that hold for all values. Power in equals energy gained, and each model level
//! equals the one below where their assumptions coincide.

mod energy;
mod induction;
mod modes;
mod servo;

use proptest::prelude::*;

use super::{Body, Elastic, FREEDOMS, Frame, Layer, Phased, Rigid};
use crate::dynamics::equations::Dynamics;
use crate::mechanism::slider_crank::SliderCrank;
use crate::mechanism::{Load, Mechanism, Platform};

fn body(axes: usize, platform: Platform) -> Body {
    Body {
        mechanism: SliderCrank::new(0.012, 0.04).unwrap().into(),
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

/// Angles, speeds and torques of a machine.
fn states() -> impl Strategy<Value = (Vec<f64>, Vec<f64>, Vec<f64>)> {
    (2_usize..=6).prop_flat_map(|n| {
        let each = |range| prop::collection::vec(range, n);
        (each(-7.0..7.0), each(-200.0..200.0), each(-50.0..50.0))
    })
}

/// Central difference (E(t + h) − E(t − h)) / 2h of the energy over time, at t = 0.
fn power(energy: impl Fn(f64) -> f64) -> f64 {
    // Third-order terms are of the order of h² ω³: 1e-14 · 1e7 of about 1e3 J.
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

/// Rotors of which none is held.
const FREE: [bool; super::MAX] = [false; super::MAX];

proptest! {
    /// If this fails, the shaft needs another torque than the one for which `cophase design` sizes motors.
    #[test]
    fn the_design_torque_accelerates_a_rigid_shaft_as_computed(
        platform in platforms(),
        alpha in -7.0..7.0,
        omega in -200.0..200.0,
        acceleration in -1e4..1e4,
    ) {
        let machine = Rigid::new(body(4, platform));
        let rotors: f64 = machine.body().unwrap().rotors_kgm2.iter().sum();
        let load = machine.body().unwrap().load;
        let torque = machine.body().unwrap().mechanism.torque_nm(&load, alpha, omega, acceleration)
            + rotors * acceleration;
        let found = machine.acceleration_rad_s2(alpha, omega, torque);
        prop_assert!((found - acceleration).abs() < 1e-9 * 1e4, "{found}, not {acceleration}");
    }

    /// If this fails, cranks in phase load each other.
    #[test]
    fn cranks_in_phase_accelerate_as_one_rigid_shaft(
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
        apart.accelerations(&vec![alpha; n], &vec![omega; n], &vec![torque; n], &FREE, &mut found);
        let together = Rigid::new(body).acceleration_rad_s2(alpha, omega, n as f64 * torque);
        for found in found {
            prop_assert!((found - together).abs() < 1e-9 * (1e3 + together.abs()));
        }
    }

    /// If this fails, a machine gains or loses energy without a source or sink.
    #[test]
    fn a_phased_machine_gains_the_work_of_its_motors(
        platform in platforms(),
        (alpha, omega, torque) in states(),
    ) {
        let machine = Phased::new(body(alpha.len(), platform));
        let mut acceleration = vec![0.0; alpha.len()];
        machine.accelerations(&alpha, &omega, &torque, &FREE, &mut acceleration);
        let gained = gain(&alpha, &omega, &acceleration, |q, v| machine.energy_j(q, v));
        // The power that flows between rotors and rods is larger than the power of the motors.
        let flow = 200.0 * 12e-3 * 2e6 * 24e-3;
        close(gained, given(&torque, &omega), flow)?;
    }

    /// As above, for a platform on springs.
    #[test]
    fn an_elastic_machine_gains_the_work_of_its_motors(
        platform in platforms(),
        (alpha, omega, torque) in states(),
        place in planes(1e-3),
        rate in planes(1.0),
    ) {
        let machine = Elastic::new(body(alpha.len(), platform), 0.0);
        let (q, v) = ([&alpha[..], &place].concat(), [&omega[..], &rate].concat());
        let mut a = vec![0.0; q.len()];
        machine.accelerations(&q, &v, &torque, &FREE, &mut a);
        let gained = gain(&q, &v, &a, |q, v| machine.energy_j(q, v));
        let flow = 200.0 * 12e-3 * 2e6 * 60e-3;
        close(gained, given(&torque, &omega), flow)?;
    }

    /// As above, for a machine on a moving frame, with and without a foundation, on both kinds of rods. If this fails, the
    /// suspension excites or damps the machine by itself.
    #[test]
    fn a_suspended_machine_gains_the_work_of_its_motors(
        platform in platforms(),
        (alpha, omega, torque) in states(),
        elastic in any::<bool>(),
        on_block in any::<bool>(),
        place in prop::array::uniform9(-1e-3..1e-3),
        rate in prop::array::uniform9(-1.0..1.0),
    ) {
        let n = alpha.len();
        let frame = frame(0.0, on_block);
        let freedoms = frame.freedoms() + if elastic { FREEDOMS } else { 0 };
        let (q, v) = ([&alpha[..], &place[..freedoms]].concat(), [&omega[..], &rate[..freedoms]].concat());
        let mut a = vec![0.0; q.len()];
        let gained = if elastic {
            let machine = Elastic::new(body(n, platform), 0.0).on(frame);
            machine.accelerations(&q, &v, &torque, &FREE, &mut a);
            gain(&q, &v, &a, |q, v| machine.energy_j(q, v))
        } else {
            let machine = Phased::new(body(n, platform)).on(frame);
            machine.accelerations(&q, &v, &torque, &FREE, &mut a);
            gain(&q, &v, &a, |q, v| machine.energy_j(q, v))
        };
        let flow = 200.0 * 12e-3 * 2e6 * 60e-3;
        close(gained, given(&torque, &omega), flow)?;
    }

    /// If this fails, a rigidly fixed frame changes the motion of the cranks. Its mass here is 1e9 times the
    /// usual one, so it moves by less than 1e-9 of the platform's motion.
    #[test]
    fn a_fixed_frame_does_not_affect_the_cranks(
        platform in platforms(),
        (alpha, omega, torque) in states(),
    ) {
        let n = alpha.len();
        let mut heavy = frame(0.1, false);
        heavy.suspended.masses = heavy.suspended.masses.map(|mass| mass * 1e9);
        let with = Phased::new(body(n, platform)).on(heavy);
        let without = Phased::new(body(n, platform));
        let (q, v) = ([&alpha[..], &[0.0; 3]].concat(), [&omega[..], &[0.0; 3]].concat());
        let (mut found, mut right) = (vec![0.0; n + 3], vec![0.0; n]);
        with.accelerations(&q, &v, &torque, &FREE, &mut found);
        without.accelerations(&alpha, &omega, &torque, &FREE, &mut right);
        let scale = right.iter().fold(1.0, |max: f64, a| max.max(a.abs()));
        for (found, right) in found.iter().zip(&right) {
            prop_assert!((found - right).abs() < 1e-8 * scale, "{found}, not {right}");
        }
    }

    /// If this fails, stiff rods load the cranks differently from quasi-static rods. The platform is placed where
    /// quasi-static rods have it, at the same speeds. The springs then push with y and the warps if their compression
    /// matches that load already.
    #[test]
    fn compressed_elastic_rods_push_as_quasi_static_rods(
        platform in platforms(),
        (alpha, omega, torque) in states(),
    ) {
        let n = alpha.len();
        let (quasi_static, elastic) = (Phased::new(body(n, platform)), Elastic::new(body(n, platform), 0.0));
        let mut right = vec![0.0; n];
        quasi_static.accelerations(&alpha, &omega, &torque, &FREE, &mut right);
        let plane = quasi_static.plane(&alpha, &omega, &right);
        let body = quasi_static.body().unwrap();
        // Corner forces that push the platform with y, in a plane. The compression is the corner's share of y, over k.
        let y: [f64; 3] = std::array::from_fn(|f| {
            body.masses()[f] * plane.acceleration[f] + if f == 0 { body.weight_n() } else { 0.0 }
        });
        let around = n as f64 / 2.0 * body.mount_radius_m * body.mount_radius_m;
        let around = if n == 2 { 2.0 * around } else { around };
        let spread = [n as f64, around, around];
        let place: [f64; 3] =
            std::array::from_fn(|f| plane.place[f] - y[f] / spread[f] / body.rod_n_per_m);
        let (q, v) = ([&alpha[..], &place].concat(), [&omega[..], &plane.rate].concat());
        let mut found = vec![0.0; n + 3];
        elastic.accelerations(&q, &v, &torque, &FREE, &mut found);
        let right = [&right[..], &plane.acceleration].concat();
        let scale = right.iter().fold(1.0, |max: f64, a| max.max(a.abs()));
        for (i, (found, right)) in found.iter().zip(&right).enumerate() {
            prop_assert!((found - right).abs() < 1e-7 * scale, "{i}: {found}, not {right}");
        }
    }
}

/// Central difference (E(t + h) − E(t − h)) / 2h for a motion with these positions, speeds and accelerations.
fn gain(q: &[f64], v: &[f64], a: &[f64], energy: impl Fn(&[f64], &[f64]) -> f64) -> f64 {
    power(|t| {
        let (q, v) = moved(q, v, a, t);
        energy(&q, &v)
    })
}

fn given(torque: &[f64], omega: &[f64]) -> f64 {
    torque
        .iter()
        .zip(omega)
        .map(|(torque, omega)| torque * omega)
        .sum()
}

fn planes(max: f64) -> impl Strategy<Value = [f64; FREEDOMS]> {
    prop::array::uniform3(-max..max)
}

/// Frame of 30 kg at 10 Hz, on a block of 100 kg at 50 Hz if `on_block`.
fn frame(zeta: f64, on_block: bool) -> Frame {
    let load = [8.0, 0.15, 0.15];
    let own = [30.0, 0.4, 0.4];
    let both = std::array::from_fn(|f| load[f] + own[f]);
    Frame {
        suspended: Layer::new(own, load, 1.5e5, 0.2, zeta),
        foundation: on_block.then(|| Layer::new([100.0, 1.5, 1.5], both, 1.4e7, 0.2, zeta)),
    }
}

/// If this fails, dampers in rods, suspension or ground drive the machine.
#[test]
fn dampers_take_energy() {
    let alpha = [0.3, 0.4, 0.2, 0.35];
    let rates = [0.7, 0.1, -0.2, 0.3, -0.2, 0.1, -0.4, 0.2, 0.3];
    for (in_rods, in_frame) in [(0.1, 0.0), (0.0, 0.1)] {
        let machine = Elastic::new(body(4, Platform::Above), in_rods).on(frame(in_frame, true));
        let height = machine.body().unwrap().crank(alpha[0]).height_m;
        let q = [&alpha[..], &[height], &[0.0; 8]].concat();
        let v = [&[0.0; 4][..], &rates].concat();
        let mut a = vec![0.0; q.len()];
        machine.accelerations(&q, &v, &[0.0; 4], &FREE, &mut a);
        let lost = gain(&q, &v, &a, |q, v| machine.energy_j(q, v));
        // Springs exchange a few watts. Dampers take c v²: at least some hundred N·s/m times about 0.1 m²/s².
        assert!(lost < -10.0, "{lost} W, rods {in_rods}, frame {in_frame}");
    }
}

/// If this fails, the machine drops on its suspension at switch-on, or its rest position is not an equilibrium.
#[test]
fn a_machine_at_rest_stays_at_rest() {
    use super::Driven;
    use crate::drives::{Motor, Servo};
    use cophase_methods::Equations;
    // At a dead centre no motor torque is needed to hold it.
    let servo = Motor::Servo(Servo {
        position_gain_per_s: 10.0,
        velocity_gain_nms: 1.0,
        integral_s: None,
        limit_nm: 10.0,
        velocity_feed_forward: 1.0,
    });
    for on_block in [false, true] {
        let own = frame(0.1, on_block);
        let body = body(4, Platform::Above);
        let phased: Box<dyn Dynamics> = Box::new(Phased::new(body.clone()).on(own.clone()));
        let elastic: Box<dyn Dynamics> = Box::new(Elastic::new(body.clone(), 0.1).on(own.clone()));
        for dynamics in [phased, elastic] {
            let machine = Driven::new(dynamics, vec![servo.clone(); 4]);
            let state = machine.at_rest(&[0.0; 4]);
            let mut rates = vec![1.0; state.len()];
            machine.rates(0.0, &state, &mut rates);
            for rate in &rates {
                // Weights of about 1e3 N cancel, over inertias of at least 0.1 kg·m².
                assert!(rate.abs() < 1e-9, "{rates:?}");
            }
            assert_eq!(machine.frame_motion(&state).unwrap().ground_n, 0.0);
        }
        // Relative to unloaded springs, the frame is lower by the weight on each spring over its stiffness.
        let weight = |kg: f64| kg * 9.80665;
        let mut sag = weight(38.0) / 1.5e5;
        if on_block {
            sag += weight(138.0) / 1.4e7;
        }
        assert!((own.sag_m(8.0, 9.80665) - sag).abs() < 1e-15);
        // Lifted by that distance, the springs carry nothing, and the ground is relieved of the whole weight.
        let block_sag = if on_block { weight(138.0) / 1.4e7 } else { 0.0 };
        let place = [sag, 0.0, 0.0, block_sag, 0.0, 0.0];
        let freedoms = own.freedoms();
        let lifted = own.motion(&place[..freedoms], &[0.0; 6][..freedoms]);
        let all = if on_block { 138.0 } else { 38.0 };
        assert!(
            (lifted.ground_n + weight(all)).abs() < 1e-9,
            "{}",
            lifted.ground_n
        );
    }
}
