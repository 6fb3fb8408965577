//! Shafts that end away from their commands, unnoticed by the controller. Such a run has not ended as it should: its report warns, and its
//! exit status is 1.

use cophase_files::trace::{Every, Window};
use cophase_scene::library;
use cophase_tests::{Run, built_in, record, scene};

fn run(text: &str) -> Run {
    record(&scene(text), Every::Ticks(8), Window::FirstMotion)
}

fn warnings(run: &Run) -> String {
    run.report["warnings"].to_string()
}

fn slipped_cycles(run: &Run, axis: usize) -> i64 {
    run.report["axes"][axis]["slipped_cycles"].as_i64().unwrap()
}

/// Four steppers with an index each, of which one loses cycles while the program runs.
fn steppers(level: &str, cycles: u32) -> String {
    format!(
        "name = \"lost\"\nfidelity = \"{level}\"\n\
         [machine]\ncrank_radius_mm = 20\nlambda = 0.25\nload_kg = 1\n\
         [limits]\nspeed_hz = 9\nacceleration_hz_per_s = 24\njerk_hz_per_s2 = 288\nhoming_speed_hz = 2\n\
         [axes]\ncount = 4\ndrive = \"stepper\"\nsteps_per_turn = 3200\nrotor_inertia_kgm2 = 1e-3\ndamping_nms = 0.2\n\
         pull_out = [[0, 40], [20, 40]]\n[correction]\ngain = 0\n\
         [[program]]\namax_g = 4\nramp_s = 0.6\nhold_s = 2\n\
         [[fault]]\nat_s = 2.0\nkind = \"lost-steps\"\naxis = 1\ncycles = {cycles}\n"
    )
}

/// If this fails, an arm that friction holds looks like one that works, as its path ends where it begins.
#[test]
fn an_arm_that_stands_is_warned_of() {
    let text = library::find("five-bar").unwrap().text;
    let changes = [
        ("friction_nm = 0.02", "friction_nm = 50"),
        ("hold_s = 40", "hold_s = 19"),
    ];
    let held = changes.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let held = run(&held);
    assert!(
        warnings(&held).contains("made less than half of its commanded motion"),
        "{}",
        warnings(&held)
    );
}

/// If this fails, a crank that is a whole turn behind looks like one in place. Its index shows the same again, so only the simulator knows.
#[test]
fn a_whole_lost_turn_is_counted_and_warned_of() {
    for level in ["kinematic", "phased"] {
        let lost = run(&steppers(level, 50));
        assert!(lost.report["faults"].as_array().unwrap().is_empty());
        assert_eq!(slipped_cycles(&lost, 1), -50, "{level}");
        assert_eq!(slipped_cycles(&lost, 0), 0, "{level}");
        assert!(lost.outcome.went_wrong(), "{level}");
        let expected = "Axis 1 ended 1.00 turns behind its command (50 electrical cycles)";
        assert!(warnings(&lost).contains(expected), "{}", warnings(&lost));
    }
}

/// If this fails, a loss that the controller found and stopped for is warned of as unnoticed.
#[test]
fn a_loss_that_the_controller_reports_is_no_unnoticed_one() {
    let lost = run(&steppers("kinematic", 1));
    assert_eq!(slipped_cycles(&lost, 1), -1);
    assert!(lost.outcome.went_wrong(), "it ended in a fault");
    assert!(
        !warnings(&lost).contains("did not notice"),
        "{}",
        warnings(&lost)
    );
}

/// Two shafts of a screen without sensors, whose motors lift no block.
const STUCK_SCREEN: &str = "name = \"stuck\"\nfidelity = \"phased\"\n\
    [screen]\nbox_kg = 328\nlength_mm = 1350\nblock_kg = 4.4\neccentricity_mm = 40\nshafts_mm = [-450, 450]\nstiffness_n_per_mm = 75\nallow_capture = true\n\
    [control]\nsettle_s = 0.01\npark_deg = 270\n\
    [limits]\nspeed_hz = 7.8\nacceleration_hz_per_s = 3.2\njerk_hz_per_s2 = 38\nhoming_speed_hz = 0.95\n\
    [drift]\ncommon_limit_deg = 90\n\
    [axes]\ncount = 2\ndrive = \"pulse-servo\"\nsteps_per_turn = 6400\nindex = false\nrotor_inertia_kgm2 = 0.035\n\
    servo = { position_gain_per_s = 37, velocity_gain_nms = 9.4, limit_nm = 1.5 }\n\
    [[program]]\namax_g = 0.2\nramp_s = 2\nhold_s = 1\n";

/// If this fails, a machine whose shafts never turned seems to have run its program.
#[test]
fn shafts_that_never_turn_are_warned_of() {
    let stuck = run(STUCK_SCREEN);
    assert!(stuck.outcome.fault.is_none(), "no sensor could show it");
    assert!(
        stuck.report["axes"][0]["actual_turns"]
            .as_f64()
            .unwrap()
            .abs()
            < 0.5
    );
    assert!(stuck.outcome.went_wrong());
    for axis in ["Axis 0 ended", "Axis 1 ended"] {
        assert!(warnings(&stuck).contains(axis), "{}", warnings(&stuck));
    }
}

/// If this fails, a crusher that rock has stopped for good, with a drive without an alarm and without sensors, seems to have parked.
#[test]
fn a_crusher_that_stays_stalled_is_warned_of() {
    let text = library::find("jaw-crusher").unwrap().text;
    let changes = [
        ("rock_kn = 1310", "rock_kn = 4000"),
        (", following_error_deg = 60", ""),
        ("count = 1", "count = 1\nindex = false"),
    ];
    let text = changes.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}\n{text}");
        text.replacen(from, to, 1)
    });
    let stalled = run(&text);
    assert!(stalled.outcome.fault.is_none());
    assert!(stalled.outcome.went_wrong());
    assert!(
        warnings(&stalled).contains("Axis 0 ended"),
        "{}",
        warnings(&stalled)
    );
}

/// If this fails, ordinary lags are taken for losses: servos without feed-forward lag by turns at speed and by half a turn at homing, and
/// cranks stand off their place at power-up.
#[test]
fn lags_at_speed_and_errors_at_power_up_are_no_losses() {
    let servos = "name = \"lag\"\nfidelity = \"phased\"\n\
         [machine]\ncrank_radius_mm = 20\nlambda = 0.25\nload_kg = 1\n\
         [control]\nsettle_s = 1\n\
         [limits]\nspeed_hz = 9\nacceleration_hz_per_s = 6\njerk_hz_per_s2 = 60\nhoming_speed_hz = 2\n\
         [axes]\ncount = 3\ndrive = \"pulse-servo\"\nsteps_per_turn = 4000\nindex = false\nrotor_inertia_kgm2 = 1e-3\n\
         servo = { position_gain_per_s = 4, velocity_gain_nms = 2, velocity_feed_forward = 0 }\n\
         [[axis]]\nnumber = 1\nstart_deg = 40\n\
         [[program]]\namax_g = 4\nramp_s = 0.6\nhold_s = 2\n";
    // The shafts reach their places seconds after the master stands, so the run goes on.
    let parked = format!(
        "{servos}[[command]]\nat_s = 0\ndo = \"start\"\n[[command]]\nat_s = 15\ndo = \"reset-peak\"\n"
    );
    let lagged = run(&parked);
    assert!(!lagged.outcome.went_wrong(), "{}", warnings(&lagged));
    for name in [
        "default",
        "pulse-servo",
        "five-bar",
        "jaw-crusher",
        "screen",
        "wrapper",
    ] {
        let run = record(&built_in(name), Every::Ticks(8), Window::FirstMotion);
        assert!(!run.outcome.went_wrong(), "{name}: {}", warnings(&run));
    }
}
