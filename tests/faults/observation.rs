//! Data by which a campaign judges a run: times at which cranks truly passed a limit, reported faults, and cranks that moved while
//! others stood.

use cophase_lab::campaign::geometry::Geometry;
use cophase_lab::campaign::judge::{self, Verdict, judge};
use cophase_lab::campaign::response::{Response, Twin};
use cophase_lab::campaign::watch::{Observation, Watch};
use host_sim::checked::Checked;
use host_sim::sim::simulate;

use super::{AT_S, AT_TICK, SceneBuilder, TICK_S, faulty, kinematic, observe, unread};

/// A tilt limit, mrad, in place of the scene's limit that nothing passes.
fn limited(mrad: f64) -> SceneBuilder {
    kinematic().set("drift.tilt_limit_mrad", mrad)
}

fn watched(machine: &SceneBuilder, fault: &str) -> (Checked, Observation) {
    watched_at(AT_S, machine, fault)
}

fn watched_at(at_s: f64, machine: &SceneBuilder, fault: &str) -> (Checked, Observation) {
    let checked = faulty(machine, at_s, fault);
    let geometry = Geometry::new(&checked.scene);
    let count = judge::cranks_that_count(&checked);
    let mut twin = Twin::default();
    simulate(&machine.checked(), &mut twin, |_, _| {}).expect("a checked scene runs");
    let mut watch = Watch::new(geometry.as_ref(), &checked, count).compared_with(&twin);
    simulate(&checked, &mut watch, |_, _| {}).expect("a checked scene runs");
    let observation = watch.observation();
    (checked, observation)
}

fn verdict((checked, observation): &(Checked, Observation)) -> Verdict {
    let geometry = Geometry::new(&checked.scene);
    judge(
        &checked.scene,
        geometry.as_ref(),
        observation,
        (false, false),
    )
    .verdict
}

/// If this fails, a campaign takes the wrong tick for the one in which a fault became dangerous, or the wrong tilt for the largest.
///
/// One crank of three that is e behind tilts the platform by 2/3 e s R/ρ at the phase where s is largest: 1.031 at λ = 0.25.
#[test]
fn first_tick_beyond_the_limit_is_recorded() {
    let mrad = |cycles: f64| {
        2.0 / 3.0 * cycles * 0.02 * std::f64::consts::TAU * 1.031 * 10.0 / 250.0 * 1e3
    };
    let beyond_tick = |observation: &Observation| {
        observation
            .beyond_limit
            .map(|beyond_limit| (beyond_limit.t_s / TICK_S).round() as u64)
    };
    let fault = "kind = \"lost-steps\"\naxis = 2\ncycles = 3\n";
    let (_, passed) = watched(&limited(mrad(2.9)), fault);
    assert_eq!(beyond_tick(&passed), Some(AT_TICK + 1)); // at the end of the tick in which it began
    assert_eq!(beyond_tick(&watched(&limited(mrad(3.1)), fault).1), None);

    // A slip passes the limit when it has reached this distance: two cycles at a turn a second, from the end of the tick in which it
    // begins.
    let slip = "kind = \"slip\"\naxis = 0\nrate_deg_per_s = 360\nfor_s = 0.045\n";
    let beyond_limit =
        beyond_tick(&watched(&limited(mrad(2.0)), slip).1).expect("2.25 cycles are slipped");
    assert!(
        (AT_TICK + 79..=AT_TICK + 82).contains(&beyond_limit),
        "{beyond_limit}"
    );
}

/// If this fails, motion of cranks without drives counts against the loop, and no stop is soon enough. Here one crank is stuck as the
/// drives are cut, and the others swing on, far beyond a limit of 3 mrad.
#[test]
fn motion_with_drives_off_is_ignored() {
    let stuck = format!(
        "kind = \"enable-loss\"\n[[fault]]\nat_s = {}\nkind = \"stuck\"\naxis = 1\n",
        AT_S + 0.01
    );
    let machine = limited(3.0).set("fidelity", "phased");
    let (_, observation) = watched(&machine, &stuck);
    assert_eq!(observation.beyond_limit, None);
}

/// If this fails, an axis that is left running while another stands is overlooked, or one is reported where all stop.
#[test]
fn axis_left_running_is_reported() {
    // The machine is commanded to stop, and stops. One motor runs on with its drive on.
    let alone = format!(
        "kind = \"stop-input\"\n[[fault]]\nat_s = {}\nkind = \"runaway\"\naxis = 1\nspeed_hz = 9\nfor_s = 0.5\n",
        AT_S + 0.01
    );
    let (_, observation) = watched(&unread(&kinematic()), &alone);
    assert!(
        observation.left_running_turns > 0.2,
        "{}",
        observation.left_running_turns
    );
    let (_, observation) = watched(&kinematic(), "kind = \"drive-alarm\"\naxis = 1\n");
    let step = 1.0 / 12_800.0;
    assert!(
        observation.left_running_turns <= step,
        "{}",
        observation.left_running_turns
    );
}

/// If this fails, a stop is reported where there is none, or where the twin stops too. A campaign then takes anything for a detection.
/// If a stop is reported late, a loop that is in time seems late.
#[test]
fn outputs_show_only_stops_and_disabled_drives() {
    let response = |fault: &str| {
        let (_, observation) = watched(&kinematic(), fault);
        observation.stopped.map(|stopped| {
            let tick = (stopped.place.t_s / TICK_S).round() as u64;
            (stopped.response, tick - AT_TICK)
        })
    };
    // An input that changes at a deadline is read at that deadline, and the output is played from the next one on. Drives go off at
    // once.
    assert_eq!(
        response("kind = \"drive-alarm\"\naxis = 1\n"),
        Some((Response::Stop, 1))
    );
    assert_eq!(
        response("kind = \"enable-loss\"\n"),
        Some((Response::Off, 0))
    );
    assert_eq!(
        response("kind = \"slip\"\naxis = 1\nrate_deg_per_s = 0.2\nfor_s = 0.5\n"),
        None
    );
}

/// If this fails, a campaign takes the place of an extra pulse from the loop that it judges. Or it counts a pulse at the flag's own
/// place as missed, although it cannot be detected and has no effect.
#[test]
fn extra_pulses_are_judged_by_the_actual_crank_position() {
    let flags = observe(&kinematic().checked()).rises_us(1);
    // The first passage finds the crank, the second confirms its place, and the third is the first one in run.
    let after = |late_ms: f64| {
        let at_s = ((flags[2] + late_ms * 1e3).round()) * 1e-6;
        watched_at(
            at_s,
            &kinematic(),
            "kind = \"index-extra\"\naxis = 1\ncount = 1\n",
        )
    };
    // At 12 rev/s at most and 5 at least, a millisecond is 1.8 to 4.3 degrees. The gate is 4 (0.25 + 2 steps) = 1.23.
    for (late_ms, verdict_is) in [(0.25, Verdict::Within), (5.0, Verdict::Right)] {
        let observation = after(late_ms);
        let off_deg = observation.1.extra.expect("a pulse was put in").off_turns * 360.0;
        let speed_hz = observation.1.injected.expect("it was").speed_hz;
        let expected = speed_hz * late_ms * 1e-3 * 360.0;
        assert!(
            (off_deg - expected).abs() < 0.1,
            "{off_deg}, not {expected}"
        );
        assert_eq!(
            verdict(&observation),
            verdict_is,
            "{late_ms} ms, {off_deg}°"
        );
    }
}
