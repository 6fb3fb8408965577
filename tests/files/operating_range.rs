//! The operating range that pictures show, against runs, and against the limits of the settings.

use cophase_files::report::draw_operating_range;
use cophase_link::board::{self, Rp2040};
use cophase_tests::{SceneBuilder, bench_scene, built_in, built_in_scene};
use host_sim::checked::Checked;
use host_sim::operating_range::OperatingRange;
use host_sim::sim::simulate;

fn range(checked: &Checked) -> OperatingRange {
    let range = OperatingRange::for_scene(checked).expect("a machine");
    range.expect("whose torque is known")
}

/// Three steppers with a flat pull-out curve that hold one level, at the quasi-static model level.
fn level(amax_g: f64) -> SceneBuilder {
    bench_scene()
        .with(
            r#"
fidelity = "quasi-static"
machine = { crank_radius_mm = 12, lambda = 0.3, load_kg = 9, platform = "below" }
limits = { speed_hz = 30, acceleration_hz_per_s = 3, jerk_hz_per_s2 = 60 }
axes = { friction_nm = 0.4, rotor_inertia_kgm2 = 1e-3, pull_out = [[0, 200], [40, 200]] }
"#,
        )
        .program([(amax_g, 12.0, 2.0)])
}

/// If this fails, the picture's required torque differs from that of the simulation: a run that holds a level has the same peak. A tick
/// may miss the peak of the turn by 0.06 rad at 20 rev/s: 0.2 % of a second harmonic. Ramps of 3 rev/s² add up to 0.2 % at 10 rev/s.
#[test]
fn required_torque_is_the_peak_of_a_run_at_that_speed() {
    for (amax_g, axis) in [(6.0, 0), (15.0, 1), (25.0, 2)] {
        let checked = level(amax_g).checked();
        let range = range(&checked);
        let outcome = simulate(&checked, &mut (), |_, _| {}).expect("it runs");
        let used = outcome.record.axes[axis]
            .pull_out_used
            .expect("torques are compared");
        let available_nm = range.available_nm(axis, range.top_hz).expect("a curve");
        assert_eq!(available_nm, 200.0);
        let peak_nm = used * available_nm;
        let required_nm = range.required_nm(axis, range.top_hz, 0.0);
        let off = peak_nm / required_nm - 1.0;
        assert!(
            (-0.005..0.005).contains(&off),
            "{amax_g} g: {required_nm} N·m in the picture, {peak_nm} in the run"
        );
    }
}

/// If this fails, the picture shows a step rate as possible that settings refuse, or one as impossible that they accept.
#[test]
fn limits_of_the_step_rate_are_where_settings_are_refused() {
    let range = range(&level(10.0).checked());
    // Slow drifts of phase offsets, 1 degree a second on each of three axes, count towards the limit, too.
    let offset_hz = 3.0 / 360.0;
    let max_hz = range.planner_step_hz().expect("a timing");
    let steps = max_hz / (30.0 + offset_hz);
    let accepts = |steps_per_turn: u32| {
        let machine = bench_scene()
            .with(
                r#"
fidelity = "kinematic"
machine = { crank_radius_mm = 12, lambda = 0.3, load_kg = 9 }
limits = { speed_hz = 30, acceleration_hz_per_s = 3, jerk_hz_per_s2 = 60 }
axes = { drive = "pulse-servo" }
[[program]]
amax_g = 2
hold_s = 1
"#,
            )
            .set("axes.steps_per_turn", steps_per_turn);
        machine.check().is_ok()
    };
    assert!(
        accepts(steps as u32) && !accepts(steps as u32 + 2),
        "{steps}"
    );

    let board_hz = range.board_speed_hz().expect("steppers").expect("a limit");
    let mut settings = level(10.0).checked().settings;
    for (part, fits) in [(0.999, true), (1.001, false)] {
        settings.limits.speed_hz = part * board_hz;
        assert_eq!(board::check::<Rp2040>(&settings).is_ok(), fits);
    }
}

/// If this fails, a picture lacks a curve or a limit, or shows one that its machine does not have.
#[test]
fn pictures_label_their_curves_and_limits() {
    let svg = draw_operating_range(&range(&built_in("default")));
    for label in [
        "available",
        "required",
        "in the steepest ramp",
        "avoid 10–12",
        "limit 22 rev/s",
        "20 g",
        "limit 781 k (above)",
    ] {
        assert!(svg.contains(&format!(">{label}</text>")), "no {label}");
    }
    let weak = draw_operating_range(&range(&built_in("stiff-bearing")));
    for label in ["available", "required, 0 1", "required, 2"] {
        assert!(weak.contains(&format!(">{label}</text>")), "no {label}");
    }
    for name in ["patent-1", "wrapper", "screen", "five-bar"] {
        assert!(
            OperatingRange::for_scene(&built_in(name))
                .unwrap()
                .is_none(),
            "{name}"
        );
    }
}

/// If this fails, a scene with a load that starts during the run has no picture, and `cophase run` refuses it.
#[test]
fn disturbed_scene_has_the_range_of_its_undisturbed_machine() {
    let load = "[[fault]]\nat_s = 1.5\nkind = \"load-step\"\naxis = 1\ntorque_nm = 2\n";
    let disturbed = range(&built_in_scene("pulse-servo").with(load).checked());
    let undisturbed = range(&built_in("pulse-servo"));
    for speed_hz in [0.5, 2.0] {
        let required = |range: &OperatingRange| range.required_nm(1, speed_hz, 0.0);
        assert_eq!(required(&disturbed), required(&undisturbed));
    }
}
