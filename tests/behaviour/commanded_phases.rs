//! Effect of commanded phases on the platform: refused beyond its limits or where rods cannot bend so far, and stated where the scene
//! means it.

use cophase_files::report::summary;
use cophase_tests::{SceneBuilder, bench_scene};
use host_sim::sim::simulate;

/// Three cranks, a third of a turn apart.
fn apart() -> SceneBuilder {
    bench_scene()
        .with("limits = { speed_hz = 40, acceleration_hz_per_s = 30, jerk_hz_per_s2 = 300 }")
        .set("machine.crank_radius_mm", 12)
        .axis(1, "offset_deg", 120)
        .axis(2, "offset_deg", -120)
        .program([(40.0, 2.0, 1.0)])
}

/// If this fails, a scene is run whose platform tilts by seventeen times its limit in every turn, and the report says that all is well.
#[test]
fn offsets_that_tilt_the_platform_beyond_its_limit_are_refused() {
    let said = apart().refused();
    assert!(
        said.contains("axes.offset_deg") || said.contains("axis[0].offset_deg"),
        "{said}"
    );
    assert!(said.contains("tilt the platform by up to 51.1"), "{said}");
    assert!(
        said.contains("machine.allow_commanded_tilt = true"),
        "{said}"
    );
}

/// If this fails, a report gives index sensors as the cause of a tilt that is commanded, or says that the cranks are in phase.
#[test]
fn commanded_tilt_is_stated_as_such() {
    let checked = apart().set("machine.allow_commanded_tilt", true).checked();
    let outcome = simulate(&checked, &mut (), |_, _| {}).expect("it runs");
    let summary = summary(&checked, &outcome, None, 1.0);
    assert!(
        summary.contains("as far apart as commanded, which tilts the platform by up to 51.1"),
        "{summary}"
    );
    assert!(
        summary.contains("the commanded phases alone tilt it by up to 51.1"),
        "{summary}"
    );
    assert!(
        !summary.contains("index is detected once a turn"),
        "{summary}"
    );
}

fn machine(fidelity: &str, count: i64, key: &str, deg: f64) -> SceneBuilder {
    bench_scene()
        .set("fidelity", fidelity)
        .with(
            r#"
machine = { allow_commanded_tilt = true, lambda = 0.4, load_kg = 6, mount_radius_mm = 200 }
limits = { speed_hz = 15, acceleration_hz_per_s = 15, jerk_hz_per_s2 = 180 }
drift = { tilt_limit_mrad = 80, warp_limit_deg = 50 }
[axes]
drive = "servo"
rotor_inertia_kgm2 = 8e-4
servo = { position_gain_per_s = 90, velocity_gain_nms = 0.9, limit_nm = 10 }
[[program]]
amax_g = 5
ramp_s = 0.8
"#,
        )
        .set("axes.count", count)
        .axis(1, key, deg)
}

/// If this fails, a machine that cannot be assembled diverges, and its user gets advice on the method's step instead.
#[test]
fn offsets_that_bend_the_rods_too_far_are_refused() {
    // A trim moves a crank as far as an offset.
    for (key, deg) in [
        ("offset_deg", 30.0),
        ("offset_deg", 90.0),
        ("offset_deg", 180.0),
        ("trim_deg", 5.0),
    ] {
        let error = machine("phased", 4, key, deg).refusal();
        assert_eq!(error.key, format!("axis[0].{key}"), "{error}");
        assert!(error.problem.contains("rods would bend by"), "{error}");
        assert!(
            key == "trim_deg" || error.problem.contains("at most three"),
            "{error}"
        );
    }
    // No rod bends on three cranks, on a model level without torque, or where all cranks have the same angle.
    for (fidelity, count, offset_deg) in [
        ("phased", 3, 90.0),
        ("kinematic", 4, 90.0),
        ("phased", 4, 0.0),
    ] {
        machine(fidelity, count, "offset_deg", offset_deg).checked();
    }
}
