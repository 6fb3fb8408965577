//! Words of reports: each speaks of the parts that its own machine has.

use cophase_files::report;
use cophase_files::trace::{Every, Window};
use cophase_scene::library;
use cophase_tests::scripted::fault;
use cophase_tests::{built_in_scene, record, scene};

/// Parts that only a platform on cranks has.
const OF_PLATFORMS: [&str; 4] = ["crank", "platform", "tilt", "slider"];

/// If this fails, the report of a screen, a crusher, an arm or a cam shaft speaks of cranks and of a platform's tilt. `scene` in
/// `report.json` is the scene with its defaults, so it has the keys of all machines.
#[test]
fn reports_of_machines_without_a_platform_name_none() {
    let captured = built_in_scene("screen")
        .set("fidelity", "phased")
        .set("screen.allow_capture", true)
        .set("limits.acceleration_hz_per_s", 1)
        .set("axes.servo.limit_nm", 90)
        .without("axes.servo.following_error_deg")
        .program([(3.73, 2.0, 3.0)]);
    let switched_off = built_in_scene("jaw-crusher").with(&fault("enable-loss", 4.0, ""));
    for (name, machine) in [
        ("screen", built_in_scene("screen")),
        ("screen", captured),
        ("jaw-crusher", switched_off),
        ("five-bar", built_in_scene("five-bar")),
        ("wrapper", built_in_scene("wrapper")),
        ("electronic-cam", built_in_scene("electronic-cam")),
    ] {
        let checked = machine.checked();
        let run = record(&checked, Every::Ticks(8), Window::FirstMotion);
        let summary = report::summary(&checked, &run.outcome, None, 1.0);
        let mut written = run.report.clone();
        written.as_object_mut().unwrap().remove("scene");
        for text in [summary, written.to_string(), run.svg] {
            for word in OF_PLATFORMS {
                let place = text.to_lowercase().find(word);
                assert!(
                    place.is_none(),
                    "{name}: {}",
                    &text[place.unwrap_or(0).saturating_sub(40)..]
                );
            }
        }
    }
}

/// If this fails, the report of a run does not say which of two model levels computed it.
#[test]
fn model_levels_of_a_machine_have_words_of_their_own() {
    for built_in in library::SCENES {
        let machine = scene(built_in.text).machine;
        let words = machine
            .levels()
            .iter()
            .map(|&level| (machine.motion(level), machine.left_out(level)));
        let words: Vec<_> = words.collect();
        for (i, (motion, left_out)) in words.iter().enumerate() {
            let earlier = &words[..i];
            assert!(
                earlier
                    .iter()
                    .all(|(own, out)| own != motion && out != left_out),
                "{}: {motion}; {left_out}",
                built_in.name
            );
        }
    }
}
