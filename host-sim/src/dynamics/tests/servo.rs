//! A servo's drive on a load: what its integral is for, and what its current limit does to it.

use cophase_methods::{Equations, Scheme, advance};

use super::body;
use crate::dynamics::{Driven, Freedom, Motor, Rigid, Servo};
use crate::mechanism::slider_crank::Platform;

/// Rotor inertia of the body's four rotors, kg·m², and what its platform weighs.
const ROTORS_KGM2: f64 = 5.2e-3;
const WEIGHT_N: f64 = 8.0 * 9.80665;

/// 2 N·m at most from four of them, on one shaft; critical for the rotors.
fn servo(integral_s: Option<f64>) -> Servo {
    Servo {
        position_gain_per_s: 50.0,
        velocity_gain_nms: 50.0 * ROTORS_KGM2,
        integral_s,
        limit_nm: 0.5,
        velocity_feed_forward: 1.0,
    }
}

fn shaft(servo: Servo) -> Driven {
    let rigid = Rigid::new(body(4, Platform::Below));
    let mut driven = Driven::new(Freedom::Rigid(rigid), vec![Motor::Servo(servo); 4]);
    driven.energised = true;
    driven
}

/// Advances the shaft, commanded to stand at an angle, from a state on, for a time.
fn settle(driven: &mut Driven, alpha_rad: f64, state: &mut [f64], time_s: f64) {
    for field in &mut driven.fields {
        field.alpha_rad = alpha_rad;
    }
    let mut method = Scheme::Rk4.prepare(driven, 1e-3).unwrap();
    advance(method.as_mut(), driven, 0.0, (time_s * 1e3) as u32, state).unwrap();
}

/// What gravity asks of the shaft, N·m.
fn load_nm(driven: &Driven, alpha_rad: f64) -> f64 {
    WEIGHT_N * driven.body().crank(alpha_rad).lever_m
}

/// Were it wrong, a servo under load would stand where it is not commanded to, with its integral or for want of it.
#[test]
fn an_integral_leaves_no_error_under_load() {
    let mut driven = shaft(servo(None));
    let mut state = driven.at_rest(&[1.5; 4]);
    settle(&mut driven, 1.5, &mut state, 2.0);
    // Four position loops hold the load: 4 k g · error.
    let holds_nm = 4.0 * 50.0 * 50.0 * ROTORS_KGM2 * (1.5 - state[0]);
    let load = load_nm(&driven, state[0]);
    assert!(
        load.abs() > 0.1 && (holds_nm - load).abs() < 1e-6 * load.abs(),
        "{holds_nm}, {load}"
    );

    let mut driven = shaft(servo(Some(0.05)));
    let mut state = driven.at_rest(&[1.5; 4]);
    settle(&mut driven, 1.5, &mut state, 4.0);
    // Its slowest mode goes at some 10/s: e^-40 is left, and rounding.
    assert!((state[0] - 1.5).abs() < 1e-12, "{} rad off", state[0] - 1.5);
    let held_nm: f64 = state[2..].iter().sum();
    let load = load_nm(&driven, state[0]);
    assert!((held_nm - load).abs() < 1e-9, "{held_nm}, not {load}");
    let given_nm: f64 = driven.torques_nm(0.0, &state).iter().sum();
    assert!((given_nm - load).abs() < 1e-9, "{given_nm}, not {load}");
}

/// Were it wrong, an integral would go on growing while the current limit holds the torque, and the drive push on long after it
/// has been commanded to turn back: half a radian from where commanded, held fast for 10 s, what an integral would gather by
/// itself is 0.26 N·m·s · 25 rad/s over 0.05 s, 1300 N·m.
#[test]
fn an_integral_does_not_wind_up() {
    let limited = servo(Some(0.05));
    let mut driven = shaft(limited);
    let mut state = driven.at_rest(&[0.0; 4]);
    let mut rates = state.clone();
    for field in &mut driven.fields {
        field.alpha_rad = 0.5;
    }
    for _ in 0..10_000 {
        driven.rates(0.0, &state, &mut rates);
        for (integral, rate) in state[2..].iter_mut().zip(&rates[2..]) {
            *integral += 1e-3 * rate;
        }
    }
    assert_eq!(driven.torques_nm(0.0, &state)[0], limited.limit_nm);
    for integral in &state[2..] {
        // It follows the torque that is given.
        assert!(
            (integral - limited.limit_nm).abs() < 1e-12,
            "{integral} N·m"
        );
    }
    for field in &mut driven.fields {
        field.alpha_rad = -1e-6;
    }
    let turned = driven.torques_nm(0.0, &state)[0];
    assert!(turned < limited.limit_nm, "{turned} N·m");
}
