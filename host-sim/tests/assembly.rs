//! Cranks that are commanded apart on a platform of four. They are refused where rods cannot bend so far, before the
//! simulation begins.

use cophase_scene::load;
use host_sim::checked::Checked;

fn scene(fidelity: &str, count: usize, offset_deg: f64) -> String {
    format!(
        r#"
name = "apart"
fidelity = "{fidelity}"
[machine]
allow_commanded_tilt = true
crank_radius_mm = 10
lambda = 0.4
load_kg = 6
mount_radius_mm = 200
[limits]
speed_hz = 15
acceleration_hz_per_s = 15
jerk_hz_per_s2 = 180
[drift]
tilt_limit_mrad = 80
warp_limit_deg = 50
[axes]
count = {count}
drive = "servo"
steps_per_turn = 3200
rotor_inertia_kgm2 = 8e-4
servo = {{ position_gain_per_s = 90, velocity_gain_nms = 0.9, limit_nm = 10 }}
[[axis]]
number = 1
offset_deg = {offset_deg}
[[program]]
amax_g = 5
ramp_s = 0.8
"#
    )
}

/// If this fails, a machine that cannot be assembled diverges, and its user gets advice on the method's step instead.
#[test]
fn offsets_that_bend_the_rods_too_far_are_refused() {
    for offset_deg in [30.0, 90.0, 180.0] {
        let refused = Checked::new(load::parse(&scene("phased", 4, offset_deg)).unwrap());
        let error = refused.unwrap_err();
        assert_eq!(error.key, "axis[0].offset_deg");
        assert!(error.problem.contains("rods would bend by"), "{error}");
        assert!(error.problem.contains("at most three"), "{error}");
    }
    // A trim moves a crank as far.
    let trimmed = scene("phased", 4, 5.0).replace("offset_deg", "trim_deg");
    let error = Checked::new(load::parse(&trimmed).unwrap()).unwrap_err();
    assert_eq!(error.key, "axis[0].trim_deg", "{error}");
    assert!(error.problem.contains("rods would bend by"), "{error}");
    // No rod bends on three cranks, on a model level without torque, or where all cranks have the same angle.
    for (fidelity, count, offset_deg) in [
        ("phased", 3, 90.0),
        ("kinematic", 4, 90.0),
        ("phased", 4, 0.0),
    ] {
        let text = scene(fidelity, count, offset_deg);
        let accepted = Checked::new(load::parse(&text).unwrap());
        assert!(accepted.is_ok(), "{fidelity} {count}: {:?}", accepted.err());
    }
}
