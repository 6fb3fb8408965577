//! Reports of a run: torque, the curves of its page, causes and corrections.

use cophase_files::report::summary;
use cophase_files::trace::{Every, Window};
use cophase_tests::{Run, bench_scene, record};
use host_sim::checked::Checked;
use host_sim::sim::events::{Event, EventKind};

/// Four steppers at a steady 20 rev/s from 2 s on. Each corrects half of a phase error in a turn.
fn checked(fidelity: &str, more: &str) -> Checked {
    bench_scene()
        .set("fidelity", fidelity)
        .with(r#"
machine = { load_kg = 8, mount_radius_mm = 200 }
limits = { speed_hz = 30, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 600, homing_speed_hz = 5 }
axes = { count = 4, rotor_inertia_kgm2 = 8e-4, friction_nm = 0.2, pull_out = [[0, 60.0], [60, 45.0]] }
correction = { gain = 0.5 }
"#)
        .program([(16.0, 0.5, 4.0)])
        .with(more)
        .checked()
}

fn run(checked: &Checked) -> Run {
    record(checked, Every::Ticks(1), Window::FirstMotion)
}

fn printed(checked: &Checked, run: &Run) -> String {
    summary(checked, &run.outcome, None, 1.0)
}

/// If this fails, a run reports that a motor was overloaded when its drive was off: the master stops at once then, which no motor has
/// to do.
#[test]
fn motors_that_are_off_are_not_loaded() {
    let undisturbed = run(&checked("quasi-static", ""));
    let used = |run: &Run| {
        let axis = &run.outcome.record.axes[0];
        let used = axis.pull_out_used.expect("torques are compared");
        (used, axis.pull_out_used_at_hz)
    };
    let (max, _) = used(&undisturbed);
    let cut = checked(
        "quasi-static",
        "[[fault]]\nat_s = 3\nkind = \"enable-loss\"\n",
    );
    let off = run(&cut);
    let (max_off, off_hz) = used(&off);
    assert!(
        max_off <= max && off_hz > 1.0,
        "{max_off} at {off_hz} rev/s of {max}"
    );
    let page = printed(&cut, &off);
    assert!(
        page.contains("Closest to pull-out: all axes, loaded to "),
        "{page}"
    );
    assert!(page.contains("of the torque that they have at "), "{page}");
    // The drives come on again for a second homing, from rest.
    let again = "[[fault]]\nat_s = 3\nkind = \"enable-loss\"\nfor_s = 0.2\n\
                 [[command]]\nat_s = 0\ndo = \"start\"\n\
                 [[command]]\nat_s = 4\ndo = \"reset\"\n\
                 [[command]]\nat_s = 4.2\ndo = \"start\"\n";
    let again = run(&checked("quasi-static", again));
    let starts = |event: &&Event| matches!(event.what, EventKind::Running { .. });
    let runs = again.outcome.record.events.iter().filter(starts).count();
    assert_eq!(runs, 2, "{}", again.report["events"]);
    assert!(used(&again).0 <= 1.001 * max, "{:?} of {max}", used(&again));
}

/// Returns the largest x on the page of the curves of a colour.
fn end_of(svg: &str, colour: &str) -> f64 {
    let paths = svg.split("<path d=\"M ").skip(1);
    let points = paths.filter_map(|path| {
        let (points, rest) = path.split_once('"')?;
        let style = rest.split('>').next()?;
        style
            .contains(&format!("stroke=\"{colour}\""))
            .then_some(points)
    });
    let xs = points
        .flat_map(|points| points.split(" L "))
        .filter_map(|point| point.split(' ').next()?.parse().ok());
    xs.fold(f64::NEG_INFINITY, f64::max)
}

/// Colour of axis 3 alone, and of axis 0.
const AXIS_3: &str = "#cc79a7";
const AXIS_0: &str = "#0072b2";

/// If this fails, the page shows a crank without a phase error that nothing measures any more.
#[test]
fn curve_of_a_stuck_crank_ends() {
    let sound = run(&checked("kinematic", "")).svg;
    assert_eq!(end_of(&sound, AXIS_3), end_of(&sound, AXIS_0));
    let stuck = "[[fault]]\nat_s = 2.5\nkind = \"stuck\"\naxis = 3\n";
    let stuck = run(&checked("kinematic", stuck)).svg;
    let (ended, page) = (end_of(&stuck, AXIS_3), end_of(&stuck, AXIS_0));
    assert!(
        ended > 0.5 * page && ended < 0.95 * page,
        "{ended} of {page}"
    );
}

/// If this fails, a program that reads the report takes the name of a fault for its only possible cause.
#[test]
fn report_lists_the_causes_of_a_fault() {
    let lost = checked(
        "kinematic",
        "[[fault]]\nat_s = 2.5\nkind = \"lost-steps\"\naxis = 2\n",
    );
    let stopped = run(&lost);
    let fault = stopped.report["faults"].as_array().unwrap().last().unwrap();
    assert_eq!(fault["kind"], "lost-steps", "{fault}");
    let causes = fault["causes"].as_array().expect("others look alike");
    let kinds: Vec<_> = causes
        .iter()
        .map(|cause| cause["kind"].as_str().unwrap())
        .collect();
    assert_eq!(kinds, ["lost-steps", "stuck", "slip"]);
    let of = |i: usize| {
        causes[i]["probability"]
            .as_f64()
            .expect("campaigns have counted it")
    };
    assert!(of(0) > of(1) && of(1) > of(2), "{fault}");
    assert!((of(0) + of(1) + of(2) - 1.0).abs() < 1e-9, "{fault}");
    let percent = format!(
        "lost-steps {:.0} %, stuck {:.0} %",
        100.0 * of(0),
        100.0 * of(1)
    );
    let page = printed(&lost, &stopped);
    assert!(page.contains(&percent), "{percent}: {page}");
    let cut = "[[fault]]\nat_s = 2.5\nkind = \"enable-loss\"\n";
    let cut = run(&checked("kinematic", cut));
    let fault = &cut.report["faults"][0];
    assert!(fault.get("causes").is_none(), "{fault}");
}

/// If this fails, a run corrects a crank, and neither its summary nor its report says by how much.
#[test]
fn correction_is_reported_with_angle_and_duration() {
    let slip =
        "[[fault]]\nat_s = 2.5\nkind = \"slip\"\naxis = 1\nrate_deg_per_s = 8\nfor_s = 0.25\n";
    let slips = checked("kinematic", slip);
    let run_of_it = run(&slips);
    let corrections = run_of_it.report["corrections"].as_array().unwrap();
    assert_eq!(corrections.len(), 1, "{corrections:?}");
    let number = |key: &str| corrections[0][key].as_f64().unwrap();
    assert!((2.5..2.7).contains(&number("t_s")) && number("in_s") > 0.2);
    let by_deg: Vec<f64> = corrections[0]["by_deg"]
        .as_array()
        .unwrap()
        .iter()
        .map(|deg| deg.as_f64().unwrap())
        .collect();
    assert_eq!(by_deg.len(), 4);
    // The crank slipped by 2°. The offsets sum to zero, to half a step.
    let against = by_deg[1] - by_deg[0];
    assert!((against - 2.0).abs() < 0.3, "{by_deg:?}");
    assert!(
        by_deg.iter().sum::<f64>().abs() < 360.0 / 3200.0,
        "{by_deg:?}"
    );
    let line = format!("phase corrected in {:.2} s: ", number("in_s"));
    let axis = format!("axis 1 by {:+.2}°", by_deg[1]);
    let page = printed(&slips, &run_of_it);
    let lines = page
        .lines()
        .filter(|text| text.contains(&line) && text.contains(&axis));
    assert_eq!(lines.count(), 1, "{line}{axis}: {page}");
    let undisturbed = run(&checked("kinematic", ""));
    assert!(undisturbed.report.get("corrections").is_none());
}

/// If this fails, the angle of an index timeout reads like a measurement.
#[test]
fn index_timeout_states_a_bound() {
    let stuck = checked(
        "kinematic",
        "[[fault]]\nat_s = 2.5\nkind = \"stuck\"\naxis = 2\n",
    );
    let stopped = run(&stuck);
    let fault = &stopped.report["faults"][0];
    assert_eq!(fault["kind"], "index-timeout");
    let size_deg = fault["size_deg"].as_f64().unwrap();
    let words = format!(
        "no pulse, so the axis may be at its limit, {:.2}° behind, or beyond it",
        -size_deg
    );
    let page = printed(&stuck, &stopped);
    assert!(size_deg < 0.0 && page.contains(&words), "{words}: {page}");
}
