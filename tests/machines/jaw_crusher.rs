//! A jaw crusher under the control loop: one axis with an induction motor, whose flywheel carries it through the rock. A crusher that
//! stalls is stopped and reported.

use cophase_tests::scripted::fault;
use cophase_tests::{Run, SceneBuilder, built_in_scene};
use host_sim::machines::crusher::mains::OnMains;
use host_sim::machines::crusher::mains::Shape;

fn crusher() -> SceneBuilder {
    built_in_scene("jaw-crusher")
}

/// If this fails, the flywheel under the loop does not carry the shaft as in the periodic regime of the source's motor, which is computed
/// without the loop. That motor runs on the mains, and its mean speed follows from the load. The converter keeps the commanded mean
/// instead, so the distances from the mean are compared. They differ as the torque curves do, a parabola and Kloss's.
#[test]
fn speed_varies_as_in_the_periodic_regime() {
    let run = crusher().run();
    assert_eq!(run.fault_kinds(), Vec::<String>::new());
    let rock = OnMains::SOURCE.with_rock(Shape::SecondHalf, 1310e3);
    let alone = rock.periodic(0.0, 28.0).unwrap();
    let mean = run.figure("speed_mean_rad_s").unwrap();
    let commanded = run.report["speed_top_hz"].as_f64().unwrap() * std::f64::consts::TAU;
    println!("mean: {mean:.3} rad/s, commanded {commanded:.3}");
    assert!((mean / commanded - 1.0).abs() < 2e-3);
    for (key, theirs) in [
        ("speed_slowest_rad_s", alone.slowest_rad_s()),
        ("speed_fastest_rad_s", alone.fastest_rad_s()),
    ] {
        let (ours, theirs) = (run.figure(key).unwrap() - mean, theirs - alone.mean_rad_s());
        println!("{key}: {ours:+.3} of the mean under the loop, {theirs:+.3} on the mains");
        assert!(
            (ours / theirs - 1.0).abs() < 0.08,
            "{key}: {ours}, {theirs}"
        );
    }
    assert!(run.figure("stalled_s").is_none());
}

/// If this fails, a converter with a stiff position loop does not work against the flywheel. Such a converter holds the speed, so the
/// flywheel does not give up energy. Torque and irregularity increase.
#[test]
fn stiff_position_loop_increases_the_irregularity() {
    let soft = crusher().run();
    let stiff = crusher()
        .set("axes.induction.position_gain_per_s", 20)
        .run();
    let irregularity = |run: &Run| run.figure("irregularity").unwrap();
    let (soft, stiff) = (irregularity(&soft), irregularity(&stiff));
    println!("irregularity {soft:.4} at 5/s, {stiff:.4} at 20/s");
    assert!(stiff > 1.1 * soft, "{soft}, {stiff}");
}

/// If this fails, the flywheel has no effect. With half the flywheel the speed varies about twice as much.
#[test]
fn flywheel_of_half_the_inertia_doubles_the_irregularity() {
    let whole = crusher().run().figure("irregularity").unwrap();
    let half = crusher().set("axes.rotor_inertia_kgm2", 20.395).run();
    let ratio = half.figure("irregularity").unwrap() / whole;
    assert!((1.7..2.3).contains(&ratio), "{ratio}");
}

/// If this fails, a crusher that rock has stopped is still driven, or the report does not state the stall and its place.
#[test]
fn stalled_crusher_is_stopped_and_reported() {
    let run = crusher().set("crusher.rock_kn", 4000).run();
    let kinds = run.fault_kinds();
    let first = kinds.first().expect("the controller stops");
    assert!(
        matches!(*first, "common-lag" | "index-timeout" | "drive-alarm"),
        "{first}"
    );
    assert!(run.figure("stalled_s").is_some());
    assert!((0.0..360.0).contains(&run.figure("stalled_deg").unwrap()));
    let warnings = run.report["warnings"].to_string();
    assert!(warnings.contains("crusher stalled"), "{warnings}");
    assert!(warnings.contains("no flywheel carries"), "{warnings}");
}

/// If this fails, the report gives rock as the cause of a stall before any was fed.
#[test]
fn stall_without_rock_is_no_effect_of_rock() {
    let stuck = crusher()
        .set("crusher.rock_turns", vec![9000, 9100])
        .with(&fault("stuck", 7.0, "axis = 0"));
    let run = stuck.run();
    assert!((7.0..7.1).contains(&run.figure("stalled_s").unwrap()));
    let warnings = run.report["warnings"].to_string();
    assert!(warnings.contains("no rock was fed there"), "{warnings}");
    assert!(!warnings.contains("break this rock"), "{warnings}");
}

/// If this fails, a stop is confused with a stall. A shaft that comes to rest as commanded does not stall.
#[test]
fn stop_without_rock_is_no_stall() {
    let run = crusher().set("crusher.rock_kn", 0).run();
    assert!(run.figure("stalled_s").is_none());
    assert_eq!(run.figure("rock_work_j"), Some(0.0));
    assert_eq!(run.fault_kinds(), Vec::<String>::new());
}

/// If this fails, the report names a time and an angle at which the shaft still turns.
#[test]
fn stall_is_reported_where_the_shaft_stands() {
    let blind = crusher()
        .set("crusher.rock_kn", 4000)
        .without("axes.induction.following_error_deg")
        .set("axes.index", false);
    let run = blind.run();
    let stalled_s = run.figure("stalled_s").unwrap();
    let trace = run.trace();
    let (t_s, turns) = (trace.column("t_s"), trace.column("actual_turns_0"));
    let row = t_s.iter().position(|t_s| *t_s >= stalled_s - 1e-9).unwrap();
    let speed =
        |row: usize| (turns[row] - turns[row - 1]) * std::f64::consts::TAU / (t_s[1] - t_s[0]);
    // The speed at the end of the tick is below 0.06 rad/s, and just before it the shaft turned.
    assert!(speed(row + 1) < 0.07, "{} rad/s", speed(row + 1));
    assert!(speed(row - 20) > 0.3, "{} rad/s", speed(row - 20));
    let angle_deg = turns[row].rem_euclid(1.0) * 360.0;
    let reported_deg = run.figure("stalled_deg").unwrap();
    assert!(
        (angle_deg - reported_deg).abs() < 0.01,
        "{angle_deg}, {reported_deg}"
    );
    // It stays there, but for the slow turning of regularised friction.
    let later_deg = turns[row + 200].rem_euclid(1.0) * 360.0;
    assert!(
        (later_deg - reported_deg).abs() < 0.5,
        "{later_deg}, {reported_deg}"
    );
}
