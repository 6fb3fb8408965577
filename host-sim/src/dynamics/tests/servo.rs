//! A servo's drive on a load: the purpose of its integral, and the effect of its current limit.

use cophase_methods::{Equations, Scheme, advance};

use super::body;
use crate::drives::{Motor, Servo};
use crate::dynamics::{Driven, Rigid};
use crate::mechanism::Platform;

/// Total inertia of the body's four rotors, kg·m², and weight of its platform.
const ROTORS_KGM2: f64 = 5.2e-3;
const WEIGHT_N: f64 = 8.0 * 9.80665;

/// Servo for four motors on one shaft, with 2 N·m at most together. Critically damped for the rotors.
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
    let mut driven = Driven::new(Box::new(rigid), vec![Motor::Servo(servo); 4]);
    driven.energised = true;
    driven
}

/// Advances the shaft from a state by a time, with standstill at an angle as the command.
fn settle(driven: &mut Driven, alpha_rad: f64, state: &mut [f64], time_s: f64) {
    for field in &mut driven.fields {
        field.alpha_rad = alpha_rad;
    }
    let mut method = Scheme::Rk4.prepare(driven, 1e-3).unwrap();
    advance(method.as_mut(), driven, 0.0, (time_s * 1e3) as u32, state).unwrap();
}

/// Torque of gravity on the shaft, N·m.
fn load_nm(driven: &Driven, alpha_rad: f64) -> f64 {
    WEIGHT_N * driven.body().unwrap().crank(alpha_rad).lever_m
}

/// If this fails, a servo with an integral keeps a position error under load, or one without it has another error than its gains
/// give.
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
    // The slowest mode decays at about 10/s. After 4 s only e^-40 and rounding remain.
    assert!((state[0] - 1.5).abs() < 1e-12, "{} rad off", state[0] - 1.5);
    let held_nm: f64 = state[2..].iter().sum();
    let load = load_nm(&driven, state[0]);
    assert!((held_nm - load).abs() < 1e-9, "{held_nm}, not {load}");
    let given_nm: f64 = driven.torques_nm(0.0, &state).iter().sum();
    assert!((given_nm - load).abs() < 1e-9, "{given_nm}, not {load}");
}

/// If this fails, the integral grows while the current limit clamps the torque. The drive then pushes on long after the
/// command to turn back. For a rotor held for 10 s at half a radian from its commanded angle, the integral alone would
/// reach 0.26 N·m·s · 25 rad/s / 0.05 s · 10 s, which is 1300 N·m.
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
        // The integral follows the actual torque.
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
