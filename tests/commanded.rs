//! Effect of commanded phases on the platform: refused beyond its limits, and stated where the scene means it.

use cophase_files::report::summary;
use cophase_scene::load;
use cophase_tests::scene;
use host_sim::checked::Checked;
use host_sim::sim::simulate;

const SCENE: &str = r#"
name = "forty"
[machine]
crank_radius_mm = 12
lambda = 0.25
load_kg = 5
[limits]
speed_hz = 40
acceleration_hz_per_s = 30
jerk_hz_per_s2 = 300
[axes]
count = 3
drive = "stepper"
steps_per_turn = 3200
[[program]]
amax_g = 40
ramp_s = 2
hold_s = 1
[[axis]]
number = 1
offset_deg = 120
[[axis]]
number = 2
offset_deg = -120
"#;

/// If this fails, a scene is run whose platform tilts by seventeen times its limit in every turn, and the report says that all is well.
#[test]
fn offsets_that_tilt_the_platform_beyond_its_limit_are_refused() {
    let parsed = load::parse(SCENE).expect("its form is right");
    let said = Checked::new(parsed).expect_err("it tilts").to_string();
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
fn a_commanded_tilt_is_stated_as_such() {
    let meant = SCENE.replace("[machine]", "[machine]\nallow_commanded_tilt = true");
    let checked = scene(&meant);
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
