//! A Scotch yoke moves its platform as the cosine of the crank angle, as hard as the program requests. It loads its motors by the
//! lever at that angle.

use std::f64::consts::TAU;

use cophase_files::trace::{Every, Window};
use cophase_tests::{built_in, built_in_scene, record};

const RADIUS_M: f64 = 0.02;

/// If this fails, a yoke is simulated as a slider-crank, or shakes its load harder or softer than required.
#[test]
fn platform_is_at_the_cosine_and_holds_its_amax() {
    let run = record(
        &built_in("scotch-yoke"),
        Every::Ticks(1),
        Window::FirstMotion,
    );
    assert_eq!(run.report["scene"]["machine"]["mechanism"], "scotch-yoke");
    let trace = run.trace();
    let turns: Vec<_> = (0..3)
        .map(|axis| trace.axis("actual_turns", axis))
        .collect();
    let z_m = trace.column("z_m");
    for row in 0..trace.rows() {
        // Heights and turns end at 1e-9: 2π R · 0.5e-9 of height, and half a last digit.
        let mean_m = turns
            .iter()
            .map(|turns| RADIUS_M * (turns[row] * TAU).cos())
            .sum::<f64>()
            / 3.0;
        assert!(
            (z_m[row] - mean_m).abs() < 1e-9,
            "row {row}: {} m, not {mean_m}",
            z_m[row]
        );
    }
    // A hold at 10 g. Its turns in half a second give ω, and ω gives R ω².
    let requested = trace.column("amax_requested_mps2");
    let top_mps2 = 98.0665;
    let hold: Vec<usize> = (0..trace.rows())
        .filter(|&row| (requested[row] - top_mps2).abs() < 1e-3)
        .collect();
    // The shaft has the first fifth of a second to reach its speed.
    let (from, to) = (hold[400], hold[hold.len() - 1]);
    assert!(to > from + 600, "{from} to {to}");
    let seconds = trace.column("t_s")[to] - trace.column("t_s")[from];
    let omega = (turns[0][to] - turns[0][from]) * TAU / seconds;
    let amax_mps2 = RADIUS_M * omega * omega;
    // One step of 3200 in four turns, twice.
    assert!(
        (amax_mps2 / top_mps2 - 1.0).abs() < 3e-4,
        "{amax_mps2} m/s²"
    );
}

/// If this fails, gravity has another lever on a yoke than its radius at 90°. A load of m g pushes on N cranks, so that T sin(p
/// δ) = m g R / N in each motor's spring. A platform above its cranks pushes them ahead, one below holds them back.
#[test]
fn gravity_deflects_a_parked_yoke_by_the_motor_stiffness() {
    for model_level in ["rigid", "phased"] {
        for (platform, sign) in [("above", 1.0), ("below", -1.0)] {
            let yoke = built_in_scene("scotch-yoke")
                .set("fidelity", model_level)
                .set("machine.platform", platform)
                .set("control.park_deg", 90)
                .set("axes.friction_nm", 0)
                .set("axes.damping_nms", 1);
            let run = record(&yoke.checked(), Every::Ticks(1), Window::FirstMotion);
            assert_eq!(run.report["fidelity"]["model_level"], model_level);
            let trace = run.trace();
            let torque_nm = 4.0 * 9.80665 * RADIUS_M / 3.0;
            let lag_turns = sign * (torque_nm / 5.0_f64).asin() / 50.0 / TAU;
            for axis in 0..3 {
                let last = |name: &str| *trace.axis(name, axis).last().unwrap();
                let ahead = last("actual_turns") - last("command_turns");
                assert!(
                    (ahead - lag_turns).abs() < 2e-3 * lag_turns.abs(),
                    "{model_level}, {platform}, axis {axis}: {ahead}, not {lag_turns}"
                );
            }
        }
    }
}
