//! Words of reports: each speaks of the parts that its own machine has.

use cophase_files::report;
use cophase_files::trace::{Every, Window};
use cophase_scene::library;
use cophase_tests::{record, scene};

/// Parts that only a platform on cranks has.
const OF_PLATFORMS: [&str; 4] = ["crank", "platform", "tilt", "slider"];

/// If this fails, the report of a screen, a crusher, an arm or a cam shaft speaks of cranks and of a platform's tilt. `scene` in
/// `report.json` is the scene with its defaults, so it has the keys of all machines.
#[test]
fn reports_of_machines_without_a_platform_name_none() {
    let captured = [
        (
            "[screen]",
            "fidelity = \"phased\"\n[screen]\nallow_capture = true",
        ),
        ("limit_nm = 399, following_error_deg = 30", "limit_nm = 90"),
        ("acceleration_hz_per_s = 8", "acceleration_hz_per_s = 1"),
        ("hold_s = 1", "hold_s = 3"),
    ];
    let switched_off = [(
        "[[program]]",
        "[[fault]]\nat_s = 4.0\nkind = \"enable-loss\"\n[[program]]",
    )];
    for (name, changes) in [
        ("screen", &[][..]),
        ("screen", &captured),
        ("jaw-crusher", &switched_off),
        ("five-bar", &[]),
        ("wrapper", &[]),
        ("electronic-cam", &[]),
    ] {
        let text = library::find(name).unwrap().text.to_owned();
        let text = changes.iter().fold(text, |text, (from, to)| {
            assert!(text.contains(from), "{name}: {from}");
            text.replacen(from, to, 1)
        });
        let checked = scene(&text);
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
fn each_model_level_of_a_machine_has_words_of_its_own() {
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
