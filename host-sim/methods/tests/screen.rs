//! Run-up of the vibrating screen through its resonance, against the figures computed for its source.

use core::f64::consts::TAU;

use cophase_methods::Scheme;
use cophase_methods::problems::Screen;

/// Largest amplitude in a run-up from rest, mm, the shaft's speed there, rpm, and both at its end.
fn run_up(torque_over_rated: f64) -> [f64; 4] {
    const STEP_S: f64 = 1e-3;
    let screen = Screen { torque_over_rated };
    let mut method = Scheme::Rk4.prepare(&screen, STEP_S).unwrap();
    let mut state = [0.0; Screen::DIMENSION];
    let (mut max_mm, mut at_rpm) = (0.0, 0.0);
    let rpm = |state: &[f64]| state[5] * 60.0 / TAU;
    for step in 0..30_000 {
        method
            .step(&screen, f64::from(step) * STEP_S, &mut state)
            .unwrap();
        let amplitude_mm = 1e3 * Screen::amplitude_m(&state);
        if amplitude_mm > max_mm {
            (max_mm, at_rpm) = (amplitude_mm, rpm(&state));
        }
    }
    [
        max_mm,
        at_rpm,
        1e3 * Screen::amplitude_m(&state),
        rpm(&state),
    ]
}

fn near(what: &str, ours: f64, published: f64, part: f64) {
    println!("{what}: {ours}, published {published}");
    assert!(
        (ours / published - 1.0).abs() < part,
        "{what}: {ours}, published {published}"
    );
}

/// Item 7. If this fails, a run-up passes the resonance at another speed or amplitude. The peak comes well above the natural speed of 195
/// rpm, because the shaft is faster than the box can follow.
///
/// The peak depends on the inertia, which the source does not give: 19.6 mm at 300 rpm with 6.5 kg m², 17.6 mm at 333 rpm with 4.26. No
/// inertia gives 18.8 mm at 285 rpm as radial displacement. Only 5.9 to 7.1 kg m² give the capture below.
#[test]
fn a_run_up_peaks_beyond_the_natural_speed() {
    let [max_mm, at_rpm, end_mm, end_rpm] = run_up(Screen::UNLIMITED);
    near("peak amplitude, mm", max_mm, 18.8, 0.06);
    near("speed at the peak, rpm", at_rpm, 285.0, 0.06);
    near("final amplitude, mm", end_mm, 5.0, 0.02);
    near("final speed, rpm", end_rpm, 837.0, 0.02);
}

/// Item 8. If this fails, a weak motor passes a resonance that should capture it, or a stronger motor is captured.
#[test]
fn a_weak_motor_is_captured() {
    let [_, _, mm, rpm] = run_up(1.05);
    near("captured, amplitude, mm", mm, 28.0, 0.02);
    near("captured, speed, rpm", rpm, 187.0, 0.02);
    let [_, _, _, rpm] = run_up(1.1);
    near("run up, rpm", rpm, 837.0, 0.02);
}
