//! STEP and DIR at the inputs of the drives: the wires of `steps.vcd` keep the times that the scene requires.

use cophase_files::trace::{Every, Window};
use cophase_tests::{bench_scene, record};
use host_sim::checked::Checked;

/// Axis 0 is trimmed against its sense faster than the shaft starts, so that it turns backwards for a time. Hold,
/// set-up and width are those of slow drives, all different.
fn turning() -> Checked {
    bench_scene()
        .with(
            r#"
machine = { allow_commanded_tilt = true, crank_radius_mm = 20, lambda = 0.3 }
limits = { speed_hz = 8, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 2000, homing_speed_hz = 5 }
pulse = { width_ns = 4000, dir_setup_ns = 9000, dir_hold_ns = 7000 }
drift = { tilt_limit_mrad = 20 }
axes = { count = 2, steps_per_turn = 1000, trim_rate_deg_per_s = 200, trim_limit_deg = 30 }
axis = [{ number = 0, trim_deg = -30, index = false }, { number = 1, reversed = true }]
"#,
        )
        .program([(5.0, 0.5, 0.3)])
        .checked()
}

/// If this fails, a drive counts a step in the wrong direction, and its crank is two steps off permanently.
#[test]
fn direction_lines_keep_setup_and_hold_times() {
    let run = record(&turning(), Every::Ticks(1), Window::All);
    let edges = run.edges();
    let (step, dir) = (edges.wire("step_0"), edges.wire("dir_0"));
    assert!(dir.changes.len() >= 2, "it turns round and back");
    for &(turned, _) in &dir.changes {
        let before = step.rises().take_while(|&at| at <= turned).last();
        let after = step.rises().find(|&at| at > turned).expect("a step");
        let low = step.changes.iter().find(|&&(at, _)| at > turned);
        assert!(
            before.is_none_or(|before| turned - before >= 7000),
            "hold before {turned} ns"
        );
        assert!(after - turned >= 9000, "set-up after {turned} ns");
        assert_eq!(
            low,
            Some(&(after, true)),
            "STEP is low where DIR turns, at {turned} ns"
        );
    }
    let apart = step.changes.windows(2).map(|two| two[1].0 - two[0].0);
    let shortest = apart.min();
    assert!(
        shortest.is_some_and(|ns| ns >= 4000),
        "width: {shortest:?} ns"
    );
}
