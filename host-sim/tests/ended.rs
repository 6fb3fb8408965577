//! What `report.json` says of the end of a run, and of the gains that acted in it.

use host_sim::report::{Report, summary};
use host_sim::scene::{Checked, load};
use host_sim::sim::simulate;
use serde_json::Value;

/// Three axes whose program ends at about 3.3 s.
fn scene(axes: &str, more: &str) -> String {
    format!(
        "name = \"ended\"\nfidelity = \"kinematic\"\n\
         [machine]\ncrank_radius_mm = 12\nlambda = 0.25\nload_kg = 5\n\
         [limits]\nspeed_hz = 40\nacceleration_hz_per_s = 30\njerk_hz_per_s2 = 300\n\
         [axes]\ncount = 3\n{axes}\n[[program]]\namax_g = 10\nramp_s = 1\nhold_s = 1\n{more}"
    )
}

const STEPPERS: &str = "drive = \"stepper\"\nsteps_per_turn = 3200";

/// The report of a scene, and the page beside it.
fn run(text: &str) -> (Value, String) {
    let checked = Checked::new(load::parse(text).unwrap()).unwrap();
    let outcome = simulate(&checked, &mut (), |_, _| {}).unwrap();
    let report = serde_json::to_value(Report::new(&checked, &outcome, None, 1.0)).unwrap();
    (report, summary(&checked, &outcome, None, 1.0))
}

/// Were it wrong, a report would not say what stopped a machine whose drives were switched off, or name the program's end where a
/// fault came on top of it.
#[test]
fn what_stopped_the_machine_is_always_said() {
    let (plain, _) = run(&scene(STEPPERS, ""));
    assert_eq!(plain["ended"]["stopped_by"], "program end");
    let stop_s = plain["time_in_state_s"]["stop"].as_f64().unwrap();
    assert!(stop_s > 0.1, "{stop_s}");
    let mut events = plain["events"].as_array().unwrap().iter();
    let stops = events.find(|event| event["what"] == "stopping, all axes together");
    let stops_s = stops.unwrap()["t_s"].as_f64().unwrap();
    let in_stop_s = stops_s + 0.05;
    for more in [
        "[[input]]\nat_s = 2\nline = \"enable\"\nactive = false\n".to_owned(),
        "[[fault]]\nat_s = 2\nkind = \"enable-loss\"\n".to_owned(),
        format!("[[fault]]\nat_s = {in_stop_s}\nkind = \"enable-loss\"\n"),
        format!("[[fault]]\nat_s = {in_stop_s}\nkind = \"drive-alarm\"\naxis = 1\n"),
    ] {
        let (report, _) = run(&scene(STEPPERS, &more));
        assert_eq!(report["ended"]["state"], "fault", "{more}");
        assert_eq!(report["ended"]["stopped_by"], "fault", "{more}");
    }
}

/// Were it wrong, gains that a scene leaves to be derived would be known to nobody.
#[test]
fn the_coupling_says_its_gains() {
    let servos = "drive = \"servo\"\nsteps_per_turn = 32768\nencoder = true\nrotor_inertia_kgm2 = 1e-3\n\
                  servo = { position_gain_per_s = 120, velocity_gain_nms = 1.0 }";
    let couple = "[correction]\ncouple = true\n";
    let (without, page) = run(&scene(servos, ""));
    assert_eq!(without["coupling"], Value::Null);
    assert!(!page.contains("Cross-coupling"), "{page}");

    let (derived, page) = run(&scene(servos, couple));
    let [p, q] = ["proportional", "per_s"].map(|key| derived["coupling"][key].as_f64().unwrap());
    assert!(p > 0.0 && q > 0.0, "{p}, {q}");
    let line = format!(
        "Cross-coupling of the setpoints: gain {p:.4}, integral gain {q:.3} 1/s (derived)."
    );
    assert!(page.contains(&line), "{page}");
    // The same gains, given, are those that act.
    let given = format!("[correction]\ncoupling = {p}\ncoupling_per_s = {q}\n");
    let (given, page) = run(&scene(servos, &given));
    assert_eq!(given["coupling"], derived["coupling"]);
    assert!(page.contains("(given)"), "{page}");
}
