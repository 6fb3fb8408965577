//! Faults of servos, whose command is a position instead of a distance.

use cophase_files::trace::{Every, Window};
use cophase_tests::{SceneBuilder, built_in, built_in_scene};

use super::{AT_TICK, TICK_S, kinematic, unread, with};

/// The same machine on servos.
fn servos(model_level: &str) -> SceneBuilder {
    kinematic()
        .set("fidelity", model_level)
        .without("axes.damping_nms")
        .without("axes.pull_out")
        .with(
            r#"axes = { drive = "servo", servo = { position_gain_per_s = 200, velocity_gain_nms = 1 } }"#,
        )
}

/// Lag of a servo of 200 N·m/rad under its share of 5 kg at 25 m/s² and a lever of 10.3 mm, turns. Its oscillation doubles it.
const LAG: f64 = 2.0 * 5.0 * 35.0 * 0.0103 / 3.0 / 200.0 / std::f64::consts::TAU;

/// If this fails, a reversed servo follows its setpoint, or a servo that slips takes its crank along.
#[test]
fn reversed_servos_turn_backward_and_slipping_ones_fall_behind() {
    for (model_level, off) in [("kinematic", 1e-9), ("phased", LAG)] {
        let samples = with(
            &unread(&servos(model_level)),
            "kind = \"reversed\"\naxis = 1\n",
        );
        let sample = samples.at(AT_TICK);
        assert!((sample.actual[1] + sample.command[1]).abs() < off);
        let slip = "kind = \"slip\"\naxis = 0\nrate_deg_per_s = 36\nfor_s = 0.5\n";
        let samples = with(&servos(model_level), slip);
        let slipped = samples.ahead(0, AT_TICK + 99);
        assert!((slipped + 0.1 * 100.0 * TICK_S).abs() < off, "{slipped}");
    }
}

/// If this fails, a released servo jumps its whole distance at once on the kinematic level, or does not catch up on the phased
/// level.
#[test]
fn released_servo_follows_its_command_again() {
    let fault = "kind = \"stuck\"\naxis = 2\nfor_s = 0.02\n";
    let samples = with(&servos("kinematic"), fault);
    let behind = samples.ahead(2, AT_TICK + 39);
    assert!(behind < -0.05, "{behind}");
    // From there on, it moves as far as commanded in each tick.
    assert!((samples.ahead(2, AT_TICK + 60) - behind).abs() < 1e-9);
    let samples = with(&servos("phased"), fault);
    let before = samples.at(AT_TICK - 1).actual[2];
    assert_eq!(samples.at(AT_TICK + 39).actual[2], before);
    assert!(samples.ahead(2, AT_TICK + 39) < -0.05);
    // Ten time constants of its position loop, 5 ms each, after its release.
    assert!(samples.ahead(2, AT_TICK + 140).abs() < LAG);
}

/// If this fails, a scene can make a servo lose steps, or hold a cam shaft away from its command.
#[test]
fn faults_that_the_scene_cannot_have_are_refused() {
    let fault = |kind: &str| format!("[[fault]]\nat_s = 1\nkind = \"{kind}\"\naxis = 1\n");
    for kind in ["lost-steps", "step-fifo-underrun"] {
        let said = servos("phased").with(&fault(kind)).refused();
        assert!(
            said.contains("fault[0].axis") && said.contains("is a servo"),
            "{said}"
        );
    }
    let cams = built_in_scene("wrapper");
    let said = cams.clone().with(&fault("stuck")).refused();
    assert!(
        said.contains("fault[0].kind")
            && said.contains("leave it out")
            && !said.contains("questions"),
        "{said}"
    );
    // Faults that move no cam are accepted there too.
    let alarmed = cams.with(&fault("drive-alarm")).checked();
    assert_eq!(alarmed.fidelity, built_in("wrapper").fidelity);
    let run = cophase_tests::record(&alarmed, Every::Fitting, Window::FirstMotion);
    assert_eq!(run.report["faults"][0]["kind"], "drive-alarm");
    assert_eq!(run.report["faults"][0]["axis"], 1);
}
