//! The parts of `report.json` about the end of a run and about its gains.

use cophase_core::supervisor::{Fault, FaultKind};
use cophase_files::report::{Report, describe, summary};
use cophase_scene::library;
use cophase_tests::{SceneBuilder, bench_scene, built_in_scene};
use host_sim::checked::Checked;
use host_sim::fidelity::{self, Answers};
use host_sim::sim::events::EventKind;
use host_sim::sim::simulate;
use serde_json::Value;

/// A scene of three axes. Homing takes two turns, at 1 rev/s; the program ends at about 4.3 s.
fn machine(more: &str) -> SceneBuilder {
    bench_scene()
        .set("fidelity", "kinematic")
        .set("machine.crank_radius_mm", 12)
        .with("limits = { speed_hz = 40, acceleration_hz_per_s = 30, jerk_hz_per_s2 = 300 }")
        .program([(10.0, 1.0, 1.0)])
        .with(more)
}

/// Returns the report of a scene, and the page beside it.
fn run(machine: &SceneBuilder) -> (Value, String) {
    let checked = machine.checked();
    let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
    let report = serde_json::to_value(Report::new(&checked, &outcome, None, 1.0)).unwrap();
    (report, summary(&checked, &outcome, None, 1.0))
}

/// If this fails, the report omits the reason of a stop when the drives were switched off, or gives the program's end as the reason
/// although a fault followed.
#[test]
fn report_always_names_the_cause_of_the_stop() {
    let (plain, _) = run(&machine(""));
    assert_eq!(plain["ended"]["stopped_by"], "program end");
    let stop_s = plain["time_in_state_s"]["stop"].as_f64().unwrap();
    assert!(stop_s > 0.1, "{stop_s}");
    let mut events = plain["events"].as_array().unwrap().iter();
    let stops = events.find(|event| event["what"] == "stopping, all axes together");
    let stops_s = stops.unwrap()["t_s"].as_f64().unwrap();
    let in_stop_s = stops_s + 0.05;
    for more in [
        "[[input]]\nat_s = 3\nline = \"enable\"\nactive = false\n".to_owned(),
        "[[fault]]\nat_s = 3\nkind = \"enable-loss\"\n".to_owned(),
        format!("[[fault]]\nat_s = {in_stop_s}\nkind = \"enable-loss\"\n"),
        format!("[[fault]]\nat_s = {in_stop_s}\nkind = \"drive-alarm\"\naxis = 1\n"),
    ] {
        let (report, _) = run(&machine(&more));
        assert_eq!(report["ended"]["state"], "fault", "{more}");
        assert_eq!(report["ended"]["stopped_by"], "fault", "{more}");
    }
}

/// Returns the line of a page that states how a fault ended the run.
fn fault_line(more: &str) -> String {
    let (_, page) = run(&machine(more));
    let line = page.lines().find(|line| line.starts_with("A fault "));
    line.unwrap_or_else(|| panic!("{page}")).to_owned()
}

/// If this fails, a summary states a coordinated stop where the drives were off, where a crank stood, or where no axis turned.
#[test]
fn summary_reports_a_common_stop_only_if_axes_stopped() {
    const TOGETHER: &str = "brought to rest together";
    let fault = |at_s: f64, kind: &str| format!("[[fault]]\nat_s = {at_s}\nkind = \"{kind}\"\n");
    let alarm = |at_s: f64| fault(at_s, "drive-alarm") + "axis = 1\n";
    let stuck = fault(3.0, "stuck") + "axis = 1\n";

    let line = fault_line(&alarm(3.0));
    assert!(line.contains(TOGETHER), "{line}");
    let (report, _) = run(&machine(&alarm(3.0)));
    let stop_s = report["time_in_state_s"]["stop"].as_f64().unwrap();
    assert!(stop_s > 0.1, "{stop_s}");
    for (more, expected) in [
        (fault(3.0, "enable-loss"), "without a stop"),
        // The second fault occurs while the first one stops the machine.
        (
            alarm(3.0) + &fault(3.0 + stop_s / 2.0, "enable-loss"),
            "before the stop was over",
        ),
        (stuck.clone(), "axis 1 did not follow"),
        // The crank is released long after the stop. The end of the run is then not the end of the stop.
        (stuck + "for_s = 5\n", "axis 1 did not follow"),
        (alarm(6.0), "stood already"),
    ] {
        let line = fault_line(&more);
        assert!(
            line.contains(expected) && !line.contains(TOGETHER),
            "{line}"
        );
        assert!(
            line.starts_with("A fault stopped the machine at "),
            "{line}"
        );
    }
    // Homing detects the crank that stands apart, and does not begin a second time.
    let again = "[[command]]\nat_s = 0\ndo = \"start\"\n[[command]]\nat_s = 6\ndo = \"reset\"\n\
                 [[command]]\nat_s = 7\ndo = \"start\"\n";
    let lost = fault(3.0, "lost-steps") + "axis = 1\ncycles = 9\n";
    let line = fault_line(&(lost + again));
    assert!(
        line.starts_with("A fault refused the start at 7.00"),
        "{line}"
    );
    assert!(line.ends_with("The drives stayed off."), "{line}");
}

/// If this fails, a user examines crank and drive where the index sensor is at fault.
#[test]
fn faults_from_scattered_readings_name_their_tolerance() {
    const JITTER: &str = "scatter by more than drift.reading_error_deg, 0.25°";
    for deg in [2.0, 3.0] {
        let line = fault_line(&format!("[noise]\nindex_deg = {deg}\n"));
        assert!(line.contains(JITTER), "{line}");
    }
    let alarm = "[[fault]]\nat_s = 3\nkind = \"drive-alarm\"\naxis = 1\n";
    let line = fault_line(alarm);
    assert!(!line.contains(JITTER), "{line}");
}

/// If this fails, a fault appears to have its last name from its detection on, or to be two faults.
#[test]
fn renamed_fault_is_one_fault_with_two_times() {
    let lost = "[[fault]]\nat_s = 3\nkind = \"lost-steps\"\naxis = 1\ncycles = 9\n";
    let (report, page) = run(&machine(lost));
    let faults = report["faults"].as_array().unwrap();
    let [first, .., last] = &faults[..] else {
        panic!("one name: {faults:?}");
    };
    assert_eq!(first["tick"], last["tick"], "{faults:?}");
    let at_s = |fault: &Value| fault["t_s"].as_f64().unwrap();
    assert!(at_s(first) < at_s(last));
    for (before, t_s, after) in [
        (
            "A fault stopped the machine at ",
            at_s(first),
            " s: index-timeout",
        ),
        (
            "At ",
            at_s(last),
            " s it was named lost steps, axis 1 off by -64.80°.",
        ),
    ] {
        let (head, _) = page.split_once(after).unwrap_or_else(|| panic!("{page}"));
        let (_, shown) = head.rsplit_once(before).unwrap_or_else(|| panic!("{page}"));
        let off_s = shown.parse::<f64>().unwrap() - t_s;
        assert!(off_s.abs() < 0.000_6, "{shown}, and not {t_s}");
    }
    // A fault that latches is listed once. So is a fault that is only reported.
    assert_eq!(page.matches("  fault: index-timeout").count(), 1, "{page}");
    assert!(!page.contains("  reported: "), "{page}");
    let extra = "[[fault]]\nat_s = 3\nkind = \"index-extra\"\naxis = 1\n";
    let (_, page) = run(&machine(extra).set("axes.encoder", true));
    assert_eq!(page.matches("  reported: index-extra").count(), 1, "{page}");

    // After a reset the fault is over, and counts as one.
    let reset = "[[command]]\nat_s = 0\ndo = \"start\"\n[[command]]\nat_s = 6\ndo = \"reset\"\n";
    let (_, page) = run(&machine(&format!("{lost}{reset}")));
    let ended = "There was 1 fault, and the machine ended in state `idle`.";
    assert!(page.contains(ended), "{page}");
}

/// If this fails, the page states that cranks lead at 360°, where no axis is.
#[test]
fn reported_leading_side_is_below_360_degrees() {
    for (deg, expected) in [
        (359.7, "lead at 0°"),
        (359.4, "lead at 359°"),
        (0.4, "lead at 0°"),
    ] {
        let fault = Fault::new(FaultKind::Tilt).on_axis(0);
        let leading_deg = Some(deg);
        let words = describe(&EventKind::Fault { fault, leading_deg });
        assert!(words.contains(expected), "{words}");
    }
}

/// If this fails, cranks that coast count as motors that slipped, and the page omits their final positions.
#[test]
fn slips_with_drives_off_are_reported_separately() {
    let mut scene = library::find("lost-steps").unwrap().scene();
    scene.axes.brake = true;
    let checked = Checked::new(scene).unwrap();
    let checked = fidelity::check(checked).unwrap();
    let mut answers = Answers::default();
    let outcome = simulate(&checked, &mut answers, |_, _| {}).unwrap();
    let checked = fidelity::answered(checked, &answers);
    let page = summary(&checked, &outcome, None, 1.0);
    let report = serde_json::to_value(Report::new(&checked, &outcome, None, 1.0)).unwrap();
    let slips = "slip, or reach their torque limit: 3 (2 of them only after the drives were off). Error: none allowed; ";
    assert!(page.contains(slips), "{page}");
    assert_eq!(report["fidelity"]["outputs"][0]["value"], 3.0);

    let ends = report["axes"].as_array().unwrap().iter().enumerate();
    let ends = ends.map(|(axis, own)| {
        let turns = |key: &str| own[key].as_f64().unwrap();
        let away_deg = (turns("actual_turns") - turns("command_turns")) * 360.0;
        format!("axis {axis} {away_deg:+.1}°")
    });
    let ends: Vec<_> = ends.collect();
    let line = format!("commanded to be: {}.", ends.join(", "));
    assert!(page.contains(&line), "{line}: {page}");
}

/// If this fails, the gains that the program derives do not appear in the report.
#[test]
fn report_contains_the_derived_coupling_gains() {
    let servos = machine("").with(
        r#"
[axes]
drive = "servo"
steps_per_turn = 32768
encoder = true
rotor_inertia_kgm2 = 1e-3
servo = { position_gain_per_s = 120, velocity_gain_nms = 1.0 }
"#,
    );
    let (without, page) = run(&servos);
    assert_eq!(without["coupling"], Value::Null);
    assert!(!page.contains("Cross-coupling"), "{page}");

    let (derived, page) = run(&servos.clone().set("correction.couple", true));
    let [p, q] = ["proportional", "per_s"].map(|key| derived["coupling"][key].as_f64().unwrap());
    assert!(p > 0.0 && q > 0.0, "{p}, {q}");
    let line = format!(
        "Cross-coupling of the setpoints: gain {p:.4}, integral gain {q:.3} 1/s (derived)."
    );
    assert!(page.contains(&line), "{page}");
    // The same gains, given in the scene, have the same effect.
    let given = servos
        .set("correction.coupling", p)
        .set("correction.coupling_per_s", q);
    let (given, page) = run(&given);
    assert_eq!(given["coupling"], derived["coupling"]);
    assert!(page.contains("(given)"), "{page}");
}

/// If this fails, steppers that lost their steps for want of torque look like a dead sensor or a held shaft, as their sensors show them.
#[test]
fn slips_before_a_fault_of_another_name_are_stated() {
    let steppers = built_in_scene("screen")
        .without("axes.servo")
        .with("axes = { drive = \"stepper\", pull_out = [[0, 400], [16, 300]], damping_nms = 20 }")
        .set("axes.rotor_inertia_kgm2", 9);
    let (report, page) = run(&steppers);
    assert_eq!(report["faults"][0]["kind"], "index-timeout");
    let said = "In the simulation, axis 0, 1 had slipped by then, from 0.";
    assert!(page.contains(said), "{page}");
    // The cause of that is known before the run.
    assert!(page.contains("lack torque for the steepest ramp"), "{page}");
}

/// If this fails, the summary states that an axis was given nothing, after it went back and forth.
#[test]
fn axis_on_a_cam_table_ends_where_the_table_has_it() {
    let (_, page) = run(&built_in_scene("electronic-cam"));
    let last = page
        .lines()
        .find(|line| line.starts_with("Axis 2"))
        .unwrap();
    assert_eq!(
        last,
        "Axis 2 followed its cam table, and ended 0 steps from where it began, at 4.200 turns."
    );
    assert!(!page.contains("was given"), "{page}");
}

/// If this fails, a machine without rods is said to have bent them, and shafts are called cranks.
#[test]
fn machine_that_diverged_is_described_in_its_own_words() {
    let light = built_in_scene("screen")
        .set("axes.rotor_inertia_kgm2", 0.1)
        .without("axes.servo.following_error_deg");
    let load = "[[fault]]\nat_s = 1.5\nkind = \"load-step\"\naxis = 0\ntorque_nm = 1000\n";
    let (report, page) = run(&light.with(load));
    assert_eq!(report["ended"]["diverged"], true, "{page}");
    for said in [
        "there: shaft 0 turns at ",
        "torque on this shaft",
        "and at its load.",
    ] {
        assert!(page.contains(said), "{page}");
    }
    assert!(!page.contains("rods"), "{page}");
}
