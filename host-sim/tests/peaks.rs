//! Peaks of followers, and the accuracy that the method's step gives them.

use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::machines::follower::Peaks;
use host_sim::sim::simulate;

/// Two wrapper pushers (`docs/methods.md`, the elastic follower), at up to 450 turns a minute.
const SCENE: &str = r#"
name = "peaks"
fidelity = "elastic"
[cam]
rise_mm = 84
rise_deg = 120
dwell_deg = 135
return_deg = 105
masses_kg = [0.525, 0.102, 1.01]
stiffness_n_per_mm = [7680, 7500, 102000]
dampers_ns_per_m = [402, 175, 2030]
[limits]
speed_hz = 8
acceleration_hz_per_s = 10
jerk_hz_per_s2 = 100
[axes]
count = 2
drive = "servo"
steps_per_turn = 8192
[[program]]
amax_g = 31.31
ramp_s = 1
hold_s = 0.7
"#;

fn peaks(method: &str) -> Peaks {
    let text = format!("{SCENE}[method]\nname = \"exact\"\n{method}");
    let checked = Checked::new(load::parse(&text).unwrap()).unwrap();
    let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
    outcome.record.axes[0].follower.unwrap()
}

/// If this fails, the docs promise an accuracy of a peak that the step does not reach: of the pusher 0.03 %, of the cam side 0.3 %, and
/// there a ninth of it for a third of the step.
#[test]
fn peaks_are_as_accurate_as_documented() {
    let steps = |count: u32| peaks(&format!("steps_per_tick = {count}\n"));
    let (own, third, fine) = (peaks(""), steps(3 * 18), steps(200));
    for (name, found, right) in [
        (
            "off_law_worst_mm",
            own.of("off_law_worst_mm").unwrap(),
            fine.of("off_law_worst_mm").unwrap(),
        ),
        (
            "pusher_accel_worst_mps2",
            own.of("pusher_accel_worst_mps2").unwrap(),
            fine.of("pusher_accel_worst_mps2").unwrap(),
        ),
    ] {
        let off = (found / right - 1.0).abs();
        assert!(off < 3e-4, "{name}: {found}, {right}: {off:.2e}");
    }
    let cam_side = |found: &Peaks| {
        (found.of("cam_side_accel_worst_mps2").unwrap()
            / fine.of("cam_side_accel_worst_mps2").unwrap()
            - 1.0)
            .abs()
    };
    let (own, third) = (cam_side(&own), cam_side(&third));
    assert!((3e-4..3e-3).contains(&own), "{own:.2e}");
    assert!((0.5..2.0).contains(&(9.0 * third / own)), "{third:.2e}");
}
