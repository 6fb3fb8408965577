//! Cranks that nothing drives any more: a run is not over before they stand, and what they do then is reported apart.

use std::f64::consts::TAU;

use host_sim::report::{summary, warnings};
use host_sim::trace::{Every, Window};

use super::{AT_S, KINEMATIC, Samples, TICK_S, observe, phased, scene};

/// Drives that are cut while cranks turn at a homing speed of 5 rev/s, with so much friction on each.
fn cut(text: &str, friction_nm: f64) -> host_sim::scene::Checked {
    let text = text.replace(
        "[axes]\n",
        &format!("[axes]\nfriction_nm = {friction_nm}\n"),
    );
    scene(&format!(
        "{text}[[fault]]\nat_s = {AT_S}\nkind = \"enable-loss\"\n"
    ))
}

/// Turns that crank 0 made after the drives were off, and in the last 50 ms of the run.
fn coasted(samples: &Samples) -> (f64, f64) {
    let off = samples
        .ticks
        .iter()
        .rposition(|sample| sample.enabled)
        .unwrap();
    let place = |i: usize| samples.ticks[i].actual[0];
    let last = samples.ticks.len() - 1;
    (place(last) - place(off), place(last) - place(last - 100))
}

/// Were a run cut off 50 ms after its drives, as it once was, what cranks do that swing on would be left out: here 1.6 rad of it.
///
/// Dry friction T takes N T of energy a radian. There is N J ω²/2 of it in the rotors, up to m v²/2 in the platform, and what its
/// weight gives or takes is at most m g 2 R.
#[test]
fn a_run_goes_on_until_cranks_that_are_let_go_stand() {
    let friction_nm = 0.05;
    let samples = observe(&cut(&phased(), friction_nm));
    let omega = 5.0 * TAU;
    let rotors_j = 3.0 * 1e-3 * omega * omega / 2.0;
    let platform_j = 5.0 * (0.01 * 1.031 * omega).powi(2) / 2.0;
    let weight_j = 5.0 * 9.81 * 0.02;
    let radians = |energy_j: f64| energy_j / (3.0 * friction_nm) / TAU;
    let (turned, at_last) = coasted(&samples);
    assert!(turned > radians(rotors_j - weight_j), "{turned}");
    assert!(
        turned < radians(rotors_j + platform_j + weight_j),
        "{turned}"
    );
    assert!(at_last.abs() * 360.0 < 0.36, "{at_last}");
    // Nor does a motor that is off slip.
    assert_eq!(samples.outcome.statistics.slipped_cycles, [0; 3]);
    let coast = &samples.outcome.statistics.coast;
    assert!(!coast.is_on() && coast.turned_s > 0.1, "{}", coast.turned_s);
}

/// Were there no end to it, a machine without friction would run for ever; were that not said, its last tilt would pass for
/// the last.
#[test]
fn what_turns_on_for_ever_is_ended_and_said() {
    let checked = cut(&phased(), 0.0);
    let samples = observe(&checked);
    let off = samples
        .ticks
        .iter()
        .filter(|sample| !sample.enabled)
        .count() as f64
        * TICK_S;
    assert!((5.0..5.2).contains(&off), "{off}");
    let said = warnings(&checked, &samples.outcome);
    let said: Vec<_> = said
        .iter()
        .filter(|said| said.contains("still turned 5.0 s"))
        .collect();
    assert_eq!(said.len(), 1);
    assert!(summary(&checked, &samples.outcome, None, 1.0).contains("turned on for 5.0"));
}

/// Were what happens with the drives off mixed into what happens with them on, nobody could see what the loop let happen. One
/// crank of the three is stuck as its drives are cut: the platform tilts by what the others go on.
#[test]
fn tilts_with_drives_on_and_off_are_apart() {
    let stuck = format!(
        "{}[[fault]]\nat_s = {AT_S}\nkind = \"enable-loss\"\n[[fault]]\nat_s = {}\nkind = \"stuck\"\naxis = 1\n",
        phased().replace("[axes]\n", "[axes]\nfriction_nm = 0.05\n"),
        AT_S + 0.01
    );
    let run = cophase_tests::record(&scene(&stuck), Every::Fitting, Window::FirstMotion);
    let number = |key: &str| run.report[key].as_f64();
    let (on, off) = (
        number("tilt_worst_mrad").unwrap(),
        number("tilt_worst_off_mrad").unwrap(),
    );
    // By one stroke, 20 mm on a circle of 250 mm: two thirds of it is what one of three corners tilts.
    assert!(on < 1.0 && (10.0..=54.0).contains(&off), "{on}, {off}");
    assert!(number("coasted_s").unwrap() > 0.05);

    // What stays on, or stands where it is left, has nothing of that.
    for text in [phased(), KINEMATIC.to_owned()] {
        let run = cophase_tests::record(&scene(&text), Every::Fitting, Window::FirstMotion);
        assert!(run.report.get("tilt_worst_off_mrad").is_none());
        assert!(run.report.get("coasted_s").is_none());
    }
    let stands = observe(&cut(KINEMATIC, 0.05));
    assert_eq!(stands.outcome.statistics.coast.turned_s, 0.0);
    let off = stands.ticks.iter().filter(|sample| !sample.enabled).count() as f64 * TICK_S;
    assert!(off < 0.1, "{off}");
}
