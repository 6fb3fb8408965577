//! Cranks without drive torque: a run ends only when they stand, and their motion after the drives are off is reported
//! separately.

use std::f64::consts::TAU;

use cophase_files::report::{summary, warnings};
use cophase_files::trace::{Every, Window};

use super::{AT_S, Checked, Samples, SceneBuilder, TICK_S, faulty, kinematic, observe, phased};

/// The drives are cut while cranks turn at a homing speed of 5 rev/s, with this friction on each.
fn cut(machine: SceneBuilder, friction_nm: f64) -> Checked {
    let machine = machine.set("axes.friction_nm", friction_nm);
    faulty(&machine, AT_S, "kind = \"enable-loss\"")
}

/// Returns the turns of crank 0 after the drives were off, and in the last 50 ms of the run.
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

/// If this fails, a run ends 50 ms after its drives are off, as in an earlier version. The motion of cranks that swing on is then
/// left out: here 1.6 rad of it.
///
/// Dry friction T takes N T of energy per radian. The rotors have N J ω²/2 of energy, the platform up to m v²/2, and its weight
/// gives or takes at most m g 2 R.
#[test]
fn run_continues_until_coasting_cranks_stand_still() {
    let friction_nm = 0.05;
    let samples = observe(&cut(phased(), friction_nm));
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
    // A motor that is off does not slip.
    let record = &samples.outcome.record;
    assert!(record.axes.iter().all(|axis| axis.motor_slips == 0));
    let coasted_s = record.figures.coasted_s;
    assert!(
        !record.is_coasting && coasted_s > Some(0.1),
        "{coasted_s:?}"
    );
}

/// If this fails, a machine without friction runs without end, or a run that is cut off does not say so. Its last tilt is then
/// taken for the final one.
#[test]
fn endless_coast_is_ended_and_reported() {
    let checked = cut(phased(), 0.0);
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

/// If this fails, the report mixes motion with the drives off into motion with the drives on, and hides what the loop allowed.
/// One crank of the three is stuck as its drives are cut. The platform tilts by the motion of the others.
#[test]
fn tilts_with_drives_on_and_off_are_reported_separately() {
    let stuck = format!(
        "kind = \"enable-loss\"\n[[fault]]\nat_s = {}\nkind = \"stuck\"\naxis = 1\n",
        AT_S + 0.01
    );
    let stuck = faulty(&phased().set("axes.friction_nm", 0.05), AT_S, &stuck);
    let run = cophase_tests::record(&stuck, Every::Fitting, Window::FirstMotion);
    let number = |key: &str| run.report[key].as_f64();
    let (on, off) = (
        number("tilt_worst_mrad").unwrap(),
        number("tilt_worst_off_mrad").unwrap(),
    );
    // A stroke is 20 mm, on a circle of 250 mm. One of three corners tilts the platform by two thirds of that.
    assert!(on < 1.0 && (10.0..=54.0).contains(&off), "{on}, {off}");
    assert!(number("coasted_s").unwrap() > 0.05);

    // Drives that stay on, and cranks that stand where they are left, add no such values.
    for machine in [phased(), kinematic()] {
        let run = cophase_tests::record(&machine.checked(), Every::Fitting, Window::FirstMotion);
        assert!(run.report.get("tilt_worst_off_mrad").is_none());
        assert!(run.report.get("coasted_s").is_none());
    }
    let stands = observe(&cut(kinematic(), 0.05));
    assert_eq!(stands.outcome.record.figures.coasted_s, None);
    let off = stands.ticks.iter().filter(|sample| !sample.enabled).count() as f64 * TICK_S;
    assert!(off < 0.1, "{off}");
}
