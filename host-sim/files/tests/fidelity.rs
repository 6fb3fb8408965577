//! `fidelity = "auto"`: its bounds hold, it takes no more model than is needed, and a sample checks its choice.

use cophase_files::report::{Report, summary};
use cophase_scene::file::Fidelity;
use cophase_scene::{library, load};
use host_sim::checked::Checked;
use host_sim::fidelity::{self, Answers, answers, check};
use host_sim::model_level::{Bounds, available, questions};
use host_sim::output::Output;
use host_sim::sim::simulate;

/// A scene on all its model levels, with the answers of each in the sample.
struct Climbed {
    name: &'static str,
    checked: Checked,
    model_levels: Vec<(Fidelity, Answers)>,
}

fn climb(name: &'static str, checked: Checked) -> Climbed {
    let model_levels = available(&checked)
        .into_iter()
        .map(|model_level| (model_level, answers(&checked, model_level).unwrap()))
        .collect();
    Climbed {
        name,
        checked,
        model_levels,
    }
}

impl Climbed {
    fn off_top(&self, of: &Answers, output: Output) -> Option<f64> {
        let (_, top) = self
            .model_levels
            .last()
            .expect("there is a lowest model level");
        let both = of.of(output).zip(top.of(output));
        both.map(|(found, right)| output.difference(found, right))
    }

    /// Returns true if a model level's answers are within the tolerances.
    fn is_within(&self, of: &Answers) -> bool {
        let questions = questions(&self.checked);
        Output::ALL.into_iter().all(|output| {
            output.tolerance(&questions).is_none_or(|tolerance| {
                self.off_top(of, output).is_some_and(|off| off <= tolerance)
            })
        })
    }
}

/// If this fails, a report promises an accuracy that the machine does not reach. Every model level of every built-in scene must differ
/// from the top one by at most its bound. This applies to each output that exists, requested or not. The level that `auto` takes must
/// be within each tolerance. It must be at most one model level above the lowest that is.
fn judge(name: &'static str) {
    let scene = library::find(name).expect("a built-in scene").scene();
    judge_scene(name, Checked::new(scene).unwrap());
}

fn judge_scene(name: &'static str, checked: Checked) {
    let climbed = climb(name, checked);
    if climbed.model_levels.len() == 1 {
        // Its scene does not say enough for a second level, so there is no other level to compare with.
        assert_eq!(name, "electronic-cam", "a scene has lost its model levels");
        assert!(Bounds::new(&climbed.checked).is_err());
        return;
    }
    let bounds = Bounds::new(&climbed.checked).expect("built-in scenes say enough");
    // Bounds apply to the undisturbed machine. `auto` prints none for another.
    let is_disturbed = !climbed.checked.scene.fault.is_empty();
    for (model_level, found) in &climbed.model_levels {
        for output in Output::ALL {
            let bound = bounds.with_steps(*model_level, output, climbed.checked.resolution);
            let off = climbed.off_top(found, output);
            println!(
                "{:12} {:12} {:15} {:10.3?} off {:10.4?}, at most {bound:.4?}",
                climbed.name,
                model_level.name(),
                output.key(),
                found.of(output).unwrap_or(f64::NAN),
                off.unwrap_or(f64::NAN),
            );
            if let Some((off, bound)) = off.zip(bound).filter(|_| !is_disturbed) {
                assert!(
                    off <= bound,
                    "{name}, {}, {}: {off} > {bound}",
                    model_level.name(),
                    output.key()
                );
            }
        }
    }
    let taken = check(climbed.checked.clone()).unwrap();
    println!("{name}: {}, {}", taken.fidelity.name(), taken.why());
    // The top level is compared with a coarse step. That may move a difference by the tenth of the tolerance that such a step is
    // allowed, and the step here by another.
    let found = climbed.model_levels.iter();
    let found =
        found.filter(|(model_level, found)| *model_level == taken.fidelity && found.is_regular());
    for (_, found) in found {
        for judged in &taken.choice.as_ref().unwrap().judged {
            let fine = climbed.off_top(found, judged.output);
            if let Some(((coarse, _), fine)) = judged.measured.zip(fine) {
                let moved = (coarse - fine).abs();
                assert!(moved <= 0.2 * judged.tolerance, "{name}: {coarse}, {fine}");
            }
        }
    }
    let place = |model_level| {
        climbed
            .model_levels
            .iter()
            .position(|(other, _)| *other == model_level)
    };
    let taken = place(taken.fidelity).expect("a model level that it has");
    let lowest = climbed
        .model_levels
        .iter()
        .position(|(_, found)| climbed.is_within(found));
    let lowest = lowest.expect("the top is within");
    assert!(climbed.is_within(&climbed.model_levels[taken].1), "{name}");
    if name == "lost-steps" {
        // Nothing bounds the effects of its fault, so `auto` takes the top level.
        assert_eq!((taken, lowest), (3, 1), "{name}");
    } else {
        assert!(
            taken <= lowest + 1,
            "{name}: model level {taken}, and {lowest} would do"
        );
    }
}

/// See [`judge`].
#[test]
fn every_built_in_scene_is_within_its_bounds_and_tolerances() {
    std::thread::scope(|threads| {
        for scene in library::SCENES {
            threads.spawn(|| judge(scene.name));
        }
    });
}

/// A machine whose load moves its cranks by slightly more than half a degree.
const SOFT: &str = r#"
name = "soft"
[questions]
lag_deg = 0.05
[machine]
crank_radius_mm = 10
lambda = 0.25
load_kg = 8
[limits]
speed_hz = 30
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 600
[axes]
count = 3
drive = "stepper"
steps_per_turn = 25600
rotor_inertia_kgm2 = 1e-3
damping_nms = 0.5
pull_out = [[0, 20.0], [60, 20.0]]
[[program]]
amax_g = 15
ramp_s = 0.5
hold_s = 0.2
"#;

fn checked(text: &str) -> Checked {
    Checked::new(load::parse(text).unwrap()).unwrap()
}

/// The same check for less uniform machines. One has a crank that stands off, whose rods pull at the others. One has cranks that are
/// apart by design, on a frame. One has elastic rods. One has a method and a step that the scene sets.
#[test]
fn bounds_and_the_auto_level_hold_for_uneven_machines() {
    let default = library::SCENES[0].text;
    let four = default.replace("lag_deg = 2", "lag_deg = 0.1\ntorque_percent = 3");
    let standing = four.replacen("[[axis]]\n", "[[axis]]\nstart_deg = 1\n", 1);
    judge_scene("standing", checked(&standing));

    let elastic = four.replace("load_kg = 8\n", "load_kg = 8\nrods = \"elastic\"\n");
    judge_scene("elastic", checked(&elastic));

    let suspended = library::find("suspended").unwrap().text;
    let apart = suspended
        .replace("lag_deg = 0.5", "lag_deg = 0.5\ntilt_mrad = 0.5")
        .replace("[machine]", "[machine]\nallow_commanded_tilt = true")
        + "[[axis]]\nnumber = 1\noffset_deg = 120\n[[axis]]\nnumber = 2\noffset_deg = -120\n";
    judge_scene("apart", checked(&apart));

    let method = "[method]\nname = \"symplectic-euler\"\nsteps_per_tick = 2\n[machine]";
    let coarse = SOFT
        .replace("lag_deg = 0.05", "lag_deg = 0.002")
        .replace("[machine]", method);
    let coarse = checked(&coarse);
    let imposed = coarse.resolution;
    assert!(
        imposed > 1e-2,
        "two steps a tick resolve no more: {imposed}"
    );
    judge_scene("coarse", coarse);
}

/// If this fails, equal motors that swing beyond their torque are assumed to stay alike, as they do on one shaft.
#[test]
fn motors_that_may_slip_have_no_lag_bound() {
    // The motors' springs of 200 N·m/rad meet the fourth harmonic of 17 rev/s.
    let weak = SOFT
        .replace("damping_nms = 0.5", "damping_nms = 0.002")
        .replace("[[0, 20.0], [60, 20.0]]", "[[0, 4.0], [60, 4.0]]");
    let weak = checked(&weak);
    let bounds = Bounds::new(&weak).unwrap();
    for model_level in [Fidelity::Rigid, Fidelity::Phased] {
        for output in [Output::Lag, Output::Slips] {
            let bound = bounds.with_steps(model_level, output, weak.resolution);
            assert_eq!(bound, None, "{} {}", model_level.name(), output.key());
        }
    }
    assert_eq!(weak.fidelity, Fidelity::Phased);
}

/// If this fails, the force on the ground is accepted as a question for a machine without a frame, or is answered without its frame.
#[test]
fn the_ground_question_needs_a_frame() {
    let suspended = library::find("suspended").unwrap().text;
    let requested = suspended.replace("amax_percent = 2", "ground_percent = 5");
    let taken = check(checked(&requested)).unwrap();
    assert_eq!(taken.fidelity, Fidelity::Elastic, "{}", taken.why());
    let none = SOFT.replace("lag_deg = 0.05", "ground_percent = 5");
    let said = Checked::new(load::parse(&none).unwrap()).unwrap_err();
    assert_eq!(said.key, "questions.ground_percent");
    assert!(said.problem.contains("give [frame]"), "{said}");
}

/// If this fails, the choice relies on a bound that is too small. The test forges such a bound, and the sample must reveal it.
#[test]
fn a_level_that_is_off_in_the_sample_is_rejected() {
    let mut forged = checked(SOFT);
    assert!(forged.fidelity > Fidelity::QuasiStatic, "{}", forged.why());
    let choice = forged.choice.as_mut().unwrap();
    choice.model_level = Fidelity::Kinematic;
    for judged in &mut choice.judged {
        judged.bound = Some(0.8 * judged.tolerance);
    }
    let taken = check(forged).unwrap();
    assert!(taken.fidelity > Fidelity::QuasiStatic, "{}", taken.why());
    assert!(
        taken
            .why()
            .contains("in a sample run its error exceeded a tolerance"),
        "{}",
        taken.why()
    );
}

/// If this fails, a wide bound leads to a higher level than necessary.
#[test]
fn a_lower_level_is_taken_where_the_sample_confirms_it() {
    let exact = checked(SOFT);
    let kinematic = answers(&exact, Fidelity::Kinematic).unwrap();
    let top = answers(&exact, Fidelity::Phased).unwrap();
    let off = Output::Lag.difference(
        kinematic.of(Output::Lag).unwrap(),
        top.of(Output::Lag).unwrap(),
    );
    let bound = Bounds::new(&exact)
        .unwrap()
        .of(Fidelity::Kinematic, Output::Lag)
        .unwrap();
    assert!(off < 0.4 * bound, "{off} of {bound}: no room between them");
    // A tolerance between the actual difference and its bound. The bound fails it, and the sample confirms it.
    let requested = 2.2 * off;
    let scene = checked(&SOFT.replace("lag_deg = 0.05", &format!("lag_deg = {requested}")));
    assert!(scene.fidelity > Fidelity::Kinematic);
    let taken = check(scene).unwrap();
    assert_eq!(taken.fidelity, Fidelity::Kinematic);
    assert!(taken.why().contains("sample"), "{}", taken.why());
}

/// If this fails, a scene gets an answer although it lacks the keys for it.
#[test]
fn a_question_that_cannot_be_answered_is_refused() {
    for line in [
        "rotor_inertia_kgm2 = 1e-3\n",
        "pull_out = [[0, 20.0], [60, 20.0]]\n",
    ] {
        let text = SOFT.replace(line, "");
        let said = Checked::new(load::parse(&text).unwrap())
            .unwrap_err()
            .to_string();
        assert!(said.contains("questions.lag_deg"), "{said}");
        let key = line.split(' ').next().unwrap();
        assert!(said.contains(&format!("axes.{key}")), "{said}");
    }
    let said = load::parse(&SOFT.replace("lag_deg", "lag_degrees"))
        .unwrap_err()
        .to_string();
    assert!(said.contains("lag_deg"), "{said}");
    let zero = SOFT.replace("lag_deg = 0.05", "lag_deg = 0");
    let said = load::parse(&zero).unwrap_err().to_string();
    assert!(said.contains("questions.lag_deg"), "{said}");
}

/// If this fails, the answer to a question is not printed, or is that of another time. A crank that stands off at power-up tilts the
/// platform only in homing.
#[test]
fn an_answer_covers_running_and_stopping_but_not_homing() {
    let apart = SOFT
        .replace("lag_deg = 0.05", "spread_deg = 0.5")
        .replace("lambda = 0.25", "lambda = 0.25\nmount_radius_mm = 200")
        + "[correction]\ngain = 0.5\n[[axis]]\nnumber = 1\nstart_deg = 2\n";
    let checked = checked(&apart);
    let mut answers = Answers::default();
    let outcome = simulate(&checked, &mut answers, |_, _| {}).unwrap();
    let answered = fidelity::answered(checked, &answers);
    let judged = &answered.choice.as_ref().unwrap().judged;
    let spread_deg = judged[0].value.expect("it was asked");
    assert_eq!(judged[0].output, Output::Spread);
    let worst_deg = outcome.record.figures.phase_spread_worst_deg;
    assert!(
        spread_deg < 0.5 && worst_deg > Some(1.9),
        "{spread_deg} of {worst_deg:?}"
    );
    let report = Report::new(&answered, &outcome, None, 1.0);
    let report = serde_json::to_value(&report).unwrap();
    assert_eq!(report["fidelity"]["outputs"][0]["value"], spread_deg);
    let page = summary(&answered, &outcome, None, 1.0);
    let line = format!(
        "  largest phase difference of two cranks: {spread_deg:.3}°. Error: 0.5° allowed; at most "
    );
    assert!(page.contains(&line), "{line}: {page}");
}

/// If this fails, a model level with all cranks on one shaft confirms that none of them slips. Here one crank slips alone.
#[test]
fn a_slip_is_confirmed_by_a_level_that_can_show_it() {
    let weak = SOFT
        .replace("lag_deg = 0.05", "slips = true")
        .replace("lambda = 0.25", "lambda = 0.25\nmount_radius_mm = 200")
        .replace(
            "jerk_hz_per_s2 = 600",
            "jerk_hz_per_s2 = 1200\nhoming_speed_hz = 5",
        )
        .replace("damping_nms = 0.5", "damping_nms = 0.2")
        .replace("hold_s = 0.2", "hold_s = 0.5")
        + "[[axis]]\nnumber = 2\nfriction_nm = 3\npull_out_scale = 0.2\n";
    let taken = check(checked(&weak)).unwrap();
    assert_eq!(taken.fidelity, Fidelity::Phased, "{}", taken.why());
    let slips = |model_level| {
        answers(&taken, model_level)
            .unwrap()
            .of(Output::Slips)
            .unwrap()
    };
    assert_eq!(slips(Fidelity::Rigid), 0.0);
    assert!(slips(Fidelity::Phased) > 0.0);
}

/// If this fails, `cophase run` simulates the default scene several times. Its bounds decide, and no sample is run.
#[test]
fn the_default_scene_needs_no_sample() {
    let taken = check(Checked::new(library::SCENES[0].scene()).unwrap()).unwrap();
    assert!(fidelity::sample_run(&taken).unwrap().is_none());
    let judged = &taken.choice.as_ref().unwrap().judged;
    assert!(!judged.is_empty());
    for judged in judged {
        assert!(judged.bound.is_some_and(|bound| bound <= judged.tolerance));
        assert_eq!((judged.measured, judged.step_error), (None, None));
    }
    // A disturbance voids the machine's bounds, so a sample is run.
    let disturbed =
        library::SCENES[0].text.to_owned() + "[[fault]]\nat_s = 5\nkind = \"stuck\"\naxis = 1\n";
    let disturbed = checked(&disturbed);
    assert!(fidelity::sample_run(&disturbed).unwrap().is_some());
}

/// If this fails, a screen with steppers whose inertia is not given is refused for a level that no screen has.
#[test]
fn a_level_is_chosen_of_those_that_the_machine_has() {
    let pulse_servo = "drive = \"pulse-servo\"";
    let text = library::find("screen").unwrap().text;
    assert!(text.contains(pulse_servo));
    let lines = text.lines().map(|line| match line.split(' ').next() {
        Some("[questions]") => "[drift]",
        Some("lag_deg" | "amax_percent" | "rotor_inertia_kgm2" | "servo") => "",
        Some("drive") => "drive = \"stepper\"\npull_out = [[0, 400], [16, 300]]",
        _ => line,
    });
    let screen = checked(&lines.collect::<Vec<_>>().join("\n"));
    assert_eq!(screen.fidelity, Fidelity::Kinematic);
}
