//! An induction motor on its converter: its torque at the specified points, and its response to a load.

use cophase_methods::{Scheme, advance};

use super::body;
use crate::drives::{Field, Induction, Motor};
use crate::dynamics::{Driven, Rigid};
use crate::mechanism::Platform;

/// Motor of 15 kW at 970 of 1000 rpm, breakdown at twice the rated torque.
fn motor() -> Induction {
    Induction::new(147.68, 0.5 * std::f64::consts::TAU, 2.0, 2.0)
}

fn torque_nm(motor: Induction, slip_rad_s: f64) -> f64 {
    let field = Field {
        omega_rad_s: 100.0,
        ..Field::default()
    };
    Motor::Induction(motor).torque_nm(&field, 0.0, 100.0 - slip_rad_s, 0.0)
}

/// If this fails, the curve does not pass through the rated point. Or its largest torque is not the breakdown torque at the
/// published breakdown slip, 104.720 − 92.995 rad/s.
#[test]
fn the_torque_curve_passes_through_rated_and_breakdown_points() {
    let rated = 0.5 * std::f64::consts::TAU;
    assert!((torque_nm(motor(), rated) - 147.68).abs() < 1e-9);
    assert!((torque_nm(motor(), -rated) + 147.68).abs() < 1e-9);
    let slips = (0..40_000).map(|i| f64::from(i) * 1e-3);
    let (slip, max) = slips
        .map(|slip| (slip, torque_nm(motor(), slip)))
        .max_by(|one, other| one.1.total_cmp(&other.1))
        .unwrap();
    assert!((max / 295.36 - 1.0).abs() < 1e-6, "{max}");
    assert!((slip - (104.720 - 92.995)).abs() < 2e-3, "{slip}");
}

/// If this fails, the converter does not bring the shaft to its commanded phase, apart from the load's slip over the gain.
#[test]
fn the_phase_error_under_load_is_slip_over_gain() {
    let rigid = Rigid::new(body(2, Platform::Below));
    let motor = Induction::new(2.0, 3.0, 2.0, 5.0);
    let mut driven = Driven::new(Box::new(rigid), vec![Motor::Induction(motor); 2]);
    driven.energised = true;
    for field in &mut driven.fields {
        field.alpha_rad = 1.5;
    }
    let mut state = driven.at_rest(&[1.5; 2]);
    let mut method = Scheme::Rk4.prepare(&driven, 1e-3).unwrap();
    advance(method.as_mut(), &driven, 0.0, 20_000, &mut state).unwrap();
    let load_nm = 8.0 * 9.80665 * driven.body().unwrap().crank(state[0]).lever_m;
    // The two motors hold the load with a slip of 5/s times the error.
    let slip = 5.0 * (1.5 - state[0]);
    let holds_nm = 2.0 * torque_nm(motor, slip);
    assert!(load_nm.abs() > 0.1, "{load_nm}");
    assert!(
        (holds_nm - load_nm).abs() < 1e-6 * load_nm.abs(),
        "{holds_nm}, {load_nm}"
    );
}
