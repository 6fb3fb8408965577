use crate::machines::five_bar::arm::{Load, Surface};
use cophase_methods::{Equations, Scheme, advance};

use super::*;
use crate::drives::{Motor, Servo};
use crate::dynamics::Driven;
use crate::dynamics::plant::PlantRotors;

fn arm(gravity_mps2: f64) -> Arm {
    let path = Path::new(&[[0.0, 0.3], [0.2, 0.3]], 0.02, 0.5).unwrap();
    Arm {
        arm: FiveBarArm {
            hand_kg: 2.0,
            load: Load::Balancer(9.81),
            surface: Some(Surface {
                normal: [0.0, 1.0],
                distance_m: 0.3,
                stiffness_n_per_m: 2e4,
                damping_ns_per_m: 50.0,
            }),
            ..FiveBarArm::assumed(gravity_mps2)
        },
        law: None,
        path,
        quarter_rad: [0.0; 2],
        min_sine: 0.9,
    }
}

/// If this fails, the simulated arm differs from the one that is verified against virtual work and published figures.
#[test]
fn the_plant_moves_as_the_published_arm() {
    let ours = arm(9.81);
    let light = vec![0.0; 2];
    for k in 0..300_u32 {
        let part = |n: u32| f64::from((k * n + 3 * n) % 101) / 101.0;
        let state = [
            3.0 * part(7),
            2.0 * part(11) - 1.5,
            part(13) - 0.5,
            part(17) - 0.5,
        ];
        let torques = [4.0 * part(19) - 2.0, 4.0 * part(23) - 2.0];
        let alone = FiveBarArm {
            torque_nm: torques,
            ..ours.arm.clone()
        };
        let mut rates = [0.0; 4];
        alone.rates(0.0, &state, &mut rates);
        let (q, v) = state.split_at(2);
        let move_with = |held: [bool; 2], a: &mut [f64; 2]| {
            let shafts = Shafts {
                rotors_kgm2: &light,
                torques_nm: &torques,
                held: &held,
            };
            ours.accelerations(&shafts, q, v, a);
        };
        let mut a = [0.0; 2];
        move_with([false; 2], &mut a);
        for i in 0..2 {
            let theirs = rates[2 + i];
            assert!((a[i] - theirs).abs() < 1e-9 * (1.0 + theirs.abs()), "{k}");
        }
        // The hand must move as its joints do.
        let moved = ours.moved(q, v, &a);
        let h = 1e-5;
        let place = |t: f64| {
            let at = [0, 1].map(|i| q[i] + v[i] * t + 0.5 * a[i] * t * t);
            ours.arm.hand_m(at)[0]
        };
        let difference = (place(h) - 2.0 * place(0.0) + place(-h)) / (h * h);
        assert!(
            (moved.acceleration[0] - difference).abs() < 1e-4 * (1.0 + difference.abs()),
            "{k}"
        );
        move_with([true, false], &mut a);
        assert_eq!(a[0], 0.0);
    }
}

/// If this fails, arm and rotors create or lose energy.
#[test]
fn energy_is_conserved() {
    let mut ours = arm(9.81);
    ours.arm.surface = None;
    let no_torque = Motor::Servo(Servo {
        position_gain_per_s: 0.0,
        velocity_gain_nms: 0.0,
        integral_s: None,
        limit_nm: f64::INFINITY,
        velocity_feed_forward: 0.0,
    });
    let on = PlantRotors::new(vec![0.05, 0.02], vec![0.0; 2], std::sync::Arc::new(ours));
    let driven = Driven::new(Box::new(on), vec![no_torque; 2]);
    let mut state = vec![2.4, 0.6, 1.0, -0.5];
    let before = driven.energy_j(&state);
    let mut method = Scheme::Rk4.prepare(&driven, 1e-4).unwrap();
    advance(method.as_mut(), &driven, 0.0, 50_000, &mut state).unwrap();
    let after = driven.energy_j(&state);
    assert!(
        (after - before).abs() < 1e-9 * before.abs(),
        "{before} J, {after} J"
    );
}

/// If this fails, the acceleration on the kinematic level is not that of the path, or the path does not return to its start.
#[test]
fn the_path_returns_and_its_velocity_matches_its_position() {
    let path = arm(0.0).path;
    assert!((path.duration_s() - 21.0).abs() < 1e-12);
    let end = path.at(1.0 - 1e-12).at_m;
    assert!((end[0] - 0.0).abs() < 1e-9 && (end[1] - 0.3).abs() < 1e-12);
    let h = 1e-4;
    for k in 0..1000 {
        let part = (f64::from(k) + 0.37) / 1000.0;
        let here = path.at(part);
        let place = |offset: f64| path.at(part + offset / path.duration_s()).at_m[0];
        let speed = (place(h) - place(-h)) / (2.0 * h);
        assert!((here.velocity_mps[0] - speed).abs() < 1e-5, "{k}");
        let (off_m, acceleration) = path.nearest(here.at_m);
        assert!(off_m < 1e-12);
        assert_eq!(acceleration, here.acceleration_mps2, "{k}");
    }
    assert!((path.nearest([0.1, 0.33]).0 - 0.03).abs() < 1e-12);
}

/// If this fails, a contact without `sensor_n` has another sensor than that of the source. The scene's default is written apart, because a
/// scene imports no equation.
#[test]
fn the_default_sensor_is_that_of_the_source() {
    let row = cophase_scene::keys::row("five_bar.contact.sensor_n").unwrap();
    let source = crate::machines::five_bar::arm::ForceSensor::SOURCE;
    assert_eq!(row.number(), source.full_scale_n);
}
