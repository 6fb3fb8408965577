//! Loads on machines whose cranks are all on one shaft.

use cophase_scene::file::Fidelity;
use cophase_tests::bench_scene;
use host_sim::checked::Checked;
use host_sim::fidelity::{answers, check};
use host_sim::output::Output;

fn machine(axes: usize, more: &str) -> Checked {
    bench_scene()
        .with(
            r#"
machine = { load_kg = 4 }
limits = { acceleration_hz_per_s = 20, jerk_hz_per_s2 = 200 }
[axes]
drive = "servo"
rotor_inertia_kgm2 = 1e-3
friction_nm = 0.2
servo = { position_gain_per_s = 100, velocity_gain_nms = 1.0 }
"#,
        )
        .set("axes.count", axes as i64)
        .program([(5.0, 0.3, 0.3)])
        .with(more)
        .checked()
}

const NOISE: &str = "noise = { load_nm = 0.3 }\n";
const STEP: &str = "fault = [{ at_s = 0.5, kind = \"load-step\", axis = 1, torque_nm = 2 }]\n";

/// If this fails, a load on one crank is written into the state of a crank that does not exist, because there is
/// one shaft only.
#[test]
fn loads_act_on_one_shaft() {
    for axes in 2..=6 {
        let torque = |more: &str| {
            let checked = machine(axes, &format!("fidelity = \"rigid\"\n{more}"));
            let found = answers(&checked, Fidelity::Rigid).unwrap();
            found.of(Output::Torque).expect("torque moves the shaft")
        };
        let unloaded = torque("");
        // All motors share the step in equal parts.
        let shared = torque(STEP) - unloaded;
        assert!(
            (0.5..2.0).contains(&(shared * axes as f64 / 2.0)),
            "{shared}"
        );
        assert_ne!(torque(NOISE), unloaded, "{axes} axes");
    }
}

/// If this fails, the default model level fails in the sample that checks it.
#[test]
fn auto_runs_its_sample_under_loads() {
    for more in [NOISE, STEP] {
        let questions = "questions = { lag_deg = 0.05, torque_percent = 3 }\n";
        let checked = machine(6, &format!("fidelity = \"auto\"\n{questions}{more}"));
        assert!(check(checked).is_ok(), "{more}");
    }
}
