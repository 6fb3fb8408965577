//! Capture at a resonance: a weak motor stays at the resonance, and a strong one passes it. The controller stops captured
//! shafts.

use cophase_lab::chart::breakdown::capture;

/// If this fails, the picture shows a capture where there is none, or the controller lets a captured screen run on.
#[test]
fn a_weak_motor_is_captured_and_stopped() {
    let facts = capture::measure().unwrap();
    // The captured state is steady: the motor's power equals the power that the springs dissipate, ζ M ω_n ω² A² · 2, at the
    // same speed.
    let (rpm, mm) = *facts.captured.last().unwrap();
    let omega = rpm * std::f64::consts::TAU / 60.0;
    let natural = (1310.4 * 981.0 / 3066.0_f64).sqrt();
    let power_w = 2.0 * 0.07 * 3066.0 * natural * (1e-3 * mm * omega).powi(2);
    // 11 kW at 1500 rpm · 314/560 less the rated slip of 2.8 % gives 128 N·m. The motor has 1.05 of it, less 2 N·m of
    // friction.
    let torque_nm =
        1.05 * 11e3 / (0.972 * 1500.0 * 314.0 / 560.0 * std::f64::consts::TAU / 60.0) - 2.0;
    assert!(
        (power_w / (torque_nm * omega) - 1.0).abs() < 0.03,
        "{power_w} W of {} W at {rpm} rpm",
        torque_nm * omega
    );
    // Both other shafts end beyond the resonance.
    let (through_rpm, through_mm) = *facts.through.last().unwrap();
    assert!((through_rpm - 837.0).abs() < 5.0 && (through_mm - 5.0).abs() < 0.1);
    // Friction of 2 N·m then takes a minute more to stop the shaft.
    let (coasting_rpm, _) = *facts.down.last().unwrap();
    assert!(coasting_rpm < 160.0, "{coasting_rpm} rpm");
    let (down_rpm, down_mm) = capture::peak(&facts.down);
    assert!(
        (120.0..230.0).contains(&down_rpm) && down_mm > through_mm,
        "{down_rpm} rpm, {down_mm} mm"
    );
    assert!(facts.stopped_s.is_some());
}
