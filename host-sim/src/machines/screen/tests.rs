use std::f64::consts::TAU;

use cophase_methods::problems::Screen as OneShaft;
use cophase_methods::{Equations, Scheme, advance};
use num_complex::Complex;

use super::*;
use crate::drives::{Motor, Servo};
use crate::dynamics::Driven;
use crate::dynamics::plant::PlantRotors;

/// Screen of the source, with several shafts in place of one.
fn screen(places_m: &[f64]) -> Screen {
    Screen {
        box_kg: 2900.0,
        pitch_kgm2: 4000.0,
        block_kg: 166.0 / places_m.len() as f64,
        eccentricity_m: 14.487 / 166.0,
        places_m: places_m.to_vec(),
        stiffness_n_per_m: 1310.4 * 981.0,
        zeta: 0.07,
        springs_m: 2.0,
        gravity_mps2: 0.0,
        phases_turns: vec![0.0; places_m.len()],
        top_hz: 15.0,
        common_limit_turns: 15.0 / 360.0,
        sufficient: Sufficient::default(),
    }
}

/// If this fails, the simulated screen differs from the one whose run-up and capture are verified against published
/// figures. Those equations are separate, for one shaft.
#[test]
fn one_shaft_moves_as_the_published_screen() {
    let screen = screen(&[0.0]);
    let block_kgm2 = 14.487 * 14.487 / 166.0;
    let rotors_kgm2 = vec![6.5 - block_kgm2];
    let one = OneShaft {
        torque_over_rated: 1.3,
    };
    for k in 0..200_u32 {
        let part = |n: u32| f64::from((k * n + n) % 97) / 97.0;
        let state = [
            0.02 * part(3) - 0.01,
            0.02 * part(5) - 0.01,
            7.0 * part(7),
            part(11) - 0.5,
            part(13) - 0.5,
            90.0 * part(17),
        ];
        let mut rates = [0.0; 6];
        one.rates(0.0, &state, &mut rates);
        let q = [state[2], state[0], state[1], 0.0];
        let v = [state[5], state[3], state[4], 0.0];
        let shafts = Shafts {
            rotors_kgm2: &rotors_kgm2,
            torques_nm: &[one.torque_nm(state[5]) - 2.0],
            held: &[false],
        };
        let mut a = [0.0; 4];
        screen.accelerations(&shafts, &q, &v, &mut a);
        for (ours, theirs) in [(a[0], rates[5]), (a[1], rates[3]), (a[2], rates[4])] {
            assert!(
                (ours - theirs).abs() < 1e-9 * (1.0 + theirs.abs()),
                "{k}: {ours}, {theirs}"
            );
        }
        assert!(a[3].abs() < 1e-12, "a shaft at the centre does not pitch");
    }
}

/// If this fails, shafts and box create or lose energy. Without damping, motors and friction the energy is constant.
#[test]
fn energy_is_conserved() {
    for places in [&[0.3][..], &[-1.0, 1.2], &[-1.5, -0.5, 0.4, 1.6]] {
        let mut screen = screen(places);
        screen.zeta = 0.0;
        screen.gravity_mps2 = 9.81;
        let n = places.len();
        let no_torque = Motor::Servo(Servo {
            position_gain_per_s: 0.0,
            velocity_gain_nms: 0.0,
            integral_s: None,
            limit_nm: f64::INFINITY,
            velocity_feed_forward: 0.0,
        });
        let on = PlantRotors::new(vec![2.0; n], vec![0.0; n], std::sync::Arc::new(screen));
        let driven = Driven::new(Box::new(on), vec![no_torque; n]);
        let mut state = vec![0.0; driven.dimension()];
        let positions = n + 3;
        for i in 0..n {
            state[i] = 0.7 * i as f64;
            state[positions + i] = 30.0 + 5.0 * i as f64;
        }
        state[n + 2] = 0.002;
        let before = driven.energy_j(&state);
        let mut method = Scheme::Rk4.prepare(&driven, 5e-5).unwrap();
        advance(method.as_mut(), &driven, 0.0, 40_000, &mut state).unwrap();
        let after = driven.energy_j(&state);
        assert!(
            (after / before - 1.0).abs() < 1e-9,
            "{n} shafts: {before} J, {after} J"
        );
    }
}

/// If this fails, the kinematic level shows the box elsewhere than the equations of motion do in steady rotation, in its pitch as well.
#[test]
fn steady_motion_solves_the_equations() {
    for (places, turns) in [
        ([-1.0, 1.0], [0.13, 0.13]),
        ([-0.4, 1.3], [0.13, 0.13]),
        ([-1.0, 1.0], [0.13, 0.63]),
    ] {
        let screen = screen(&places);
        for omega in [5.0, 20.0, 40.0, 88.0] {
            let steady = screen.steady(&turns, omega);
            // Along the box the motion is the real part of the amplitude that turns with the shafts, otherwise the imaginary part.
            let turned = Complex::new(0.0, omega);
            let motion = |amplitudes: [Complex<f64>; 3]| {
                [amplitudes[0].re, amplitudes[1].im, amplitudes[2].im]
            };
            let place = [steady.along, steady.across, steady.pitch];
            let angles = turns.map(|turns| turns * TAU);
            let q = [&angles[..], &motion(place)].concat();
            let v = [&[omega; 2][..], &motion(place.map(|at| at * turned))].concat();
            let rotors_kgm2 = vec![3.0, 3.0];
            let shafts = Shafts {
                rotors_kgm2: &rotors_kgm2,
                torques_nm: &[0.0, 0.0],
                held: &[true, true],
            };
            let mut a = [0.0; 5];
            screen.accelerations(&shafts, &q, &v, &mut a);
            let expected = motion(place.map(|at| at * turned * turned));
            let scale = screen.throw_m() * omega * omega;
            for (a, expected) in a[2..].iter().zip(expected) {
                assert!((a - expected).abs() < 1e-9 * scale, "{places:?}, {omega}");
            }
        }
    }
}

/// If this fails, the forbidden band permits speeds at which the box moves by more than twice its throw, or is far too wide.
#[test]
fn the_forbidden_band_covers_amplified_speeds() {
    let mut screen = screen(&[0.0]);
    screen.zeta = 0.01;
    let [(from_hz, to_hz)] = screen.bands_hz()[..] else {
        panic!("a centred shaft excites one resonance")
    };
    let amplified = |hz: f64| screen.steady(&[0.0], hz * TAU).across.norm() / screen.throw_m();
    for edge in [from_hz, to_hz] {
        assert!((amplified(edge) - AMPLIFICATION).abs() < 0.01, "{edge}");
    }
    assert!(amplified(0.99 * from_hz) < AMPLIFICATION);
    assert!(amplified(1.01 * to_hz) < AMPLIFICATION);
}

/// If this fails, a screen may dwell where its pitch resonates and its ends break. The judge integrates the equations of motion at held
/// speeds until the motion is steady, and knows nothing of modes or bands.
#[test]
fn the_forbidden_bands_cover_the_speeds_at_which_the_ends_swing_up() {
    let mut screen = screen(&[1.2]);
    screen.zeta = 0.03;
    let ends_m = |hz: f64| {
        let on = PlantRotors::new(vec![1e9], vec![0.0], std::sync::Arc::new(screen.clone()));
        let motor = Motor::Servo(Servo {
            position_gain_per_s: 0.0,
            velocity_gain_nms: 0.0,
            integral_s: None,
            limit_nm: f64::INFINITY,
            velocity_feed_forward: 0.0,
        });
        let driven = Driven::new(Box::new(on), vec![motor]);
        let mut state = vec![0.0; driven.dimension()];
        state[4] = hz * TAU;
        let mut method = Scheme::Rk4.prepare(&driven, 1e-3).unwrap();
        advance(method.as_mut(), &driven, 0.0, 15_000, &mut state).unwrap();
        let mut worst: f64 = 0.0;
        for _ in 0..1500 {
            advance(method.as_mut(), &driven, 0.0, 1, &mut state).unwrap();
            for end_m in [-2.0, 2.0] {
                worst = worst.max(state[1].hypot(state[2] + end_m * state[3]));
            }
        }
        worst
    };
    let bands = screen.bands_hz();
    let far_m = ends_m(40.0);
    let is_forbidden = |hz: f64| bands.iter().any(|band| (band.0..=band.1).contains(&hz));
    let mut forbidden = 0;
    for i in 0..60 {
        let hz = 1.0 + 0.2 * f64::from(i);
        let times = ends_m(hz) / far_m;
        if times > 1.05 * AMPLIFICATION {
            assert!(is_forbidden(hz), "{hz} rev/s: {times}, {bands:?}");
            forbidden += 1;
        }
        // Outside of the bands nothing swings up; inside of the springs' band the centre may.
        let natural_hz = screen.natural_rad_s() / TAU;
        if hz > 1.5 * natural_hz && times < 0.95 * AMPLIFICATION {
            assert!(!is_forbidden(hz), "{hz} rev/s: {times}, {bands:?}");
        }
    }
    assert!(forbidden > 3, "the pitch resonates in the range");
}

/// If this fails, a pair of shafts in opposite phase shakes the pitch alone, and no band forbids its resonance.
#[test]
fn opposite_phases_excite_the_pitch() {
    let mut screen = screen(&[-1.0, 1.0]);
    assert!(!screen.excites_pitch());
    assert_eq!(screen.bands_hz().len(), 1);
    screen.phases_turns = vec![0.0, 0.5];
    assert!(screen.excites_pitch());
    let pitch_hz = (screen.stiffness_n_per_m / (4000.0 + 166.0)).sqrt() * 2.0 / TAU;
    let bands = screen.bands_hz();
    assert!(
        bands
            .iter()
            .any(|band| (band.0..band.1).contains(&pitch_hz)),
        "{bands:?}, {pitch_hz}"
    );
}
