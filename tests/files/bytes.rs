//! The same scene gives the same run, byte for byte, with any observer and at any resolution.
//!
//! (A test beside the command checks that the command's own files are the same too.)

use cophase_files::trace::{Every, Window};
use cophase_tests::{Run, bench_scene, built_in, record, watch};
use host_sim::checked::Checked;

/// Two seconds with a change of level, a hold on command and a late deadline.
fn short() -> Checked {
    bench_scene()
        .with(r#"
machine = { allow_commanded_tilt = true, crank_radius_mm = 20, lambda = 0.3 }
control = { settle_s = 0.02 }
axes = { steps_per_turn = 1600 }
axis = [{ number = 1, reversed = true, trim_deg = -1.5 }, { number = 2, gear = [3, 7], index = false }]
command = [{ at_s = 1.3, do = "hold" }, { at_s = 1.5, do = "resume" }]
late = [{ at_s = 1.2, by_us = 700 }]
[limits]
speed_hz = 12
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 2000
homing_speed_hz = 5
band = [{ from_hz = 6, to_hz = 7 }]
"#)
        .program([(9.0, 0.8, 0.4), (3.0, 0.5, 0.2)])
        .checked()
}

fn assert_same(one: &Run, other: &Run) {
    assert!(one.csv == other.csv, "trace.csv differs");
    assert!(one.vcd == other.vcd, "steps.vcd differs");
    assert!(one.svg == other.svg, "scope.svg differs");
    assert_eq!(
        one.lasting_report(false),
        other.lasting_report(false),
        "report.json"
    );
}

/// If this fails, a golden file is useless, and a fault that occurred once may never be reproduced.
#[test]
fn runs_of_a_scene_give_the_same_bytes() {
    for checked in [short(), built_in("lost-steps")] {
        let run = || record(&checked, Every::Ticks(1), Window::All);
        assert_same(&run(), &run());
    }
}

/// If this fails, threads share virtual time or other data. A campaign that uses all cores then differs from one
/// on a single core.
#[test]
fn parallel_runs_give_the_same_bytes() {
    let scenes = [short(), built_in("lost-steps"), built_in("patent-3")];
    let run = |i: usize| record(&scenes[i], Every::Fitting, Window::FirstMotion);
    let alone: Vec<Run> = (0..3).map(run).collect();
    let together: Vec<Run> = std::thread::scope(|threads| {
        // Each scene runs on two threads at once, in another order.
        let spawned: Vec<_> = [0, 1, 2, 2, 0, 1]
            .map(|i| threads.spawn(move || run(i)))
            .into();
        let joined = spawned
            .into_iter()
            .map(|thread| thread.join().expect("no panic"));
        joined.collect()
    });
    for (i, run) in [0, 1, 2, 2, 0, 1].into_iter().zip(&together) {
        assert_same(&alone[i], run);
    }
}

/// If this fails, thinning a trace or moving the window changes the run: the observer is part of the experiment.
#[test]
fn finer_traces_and_windows_do_not_change_the_run() {
    let checked = short();
    let all = record(&checked, Every::Ticks(1), Window::All);
    let lines = |run: &Run| -> Vec<String> {
        let text = String::from_utf8(run.csv.clone()).expect("UTF-8");
        text.lines().map(str::to_owned).collect()
    };
    let rows = lines(&all);
    let edges = all.edges();
    assert!(rows.len() > 4000);
    // The windows lie in the middle of motion with no change of any wire at their ends, at power-up, and across
    // the run's end.
    let windows = [
        (900_000_000, 1_250_500_000),
        (0, 300_000_000),
        (2_000_000_000, 90_000_000_000),
    ];
    for (every, (from_ns, to_ns)) in [2, 7, 10].into_iter().zip(windows) {
        let some = record(
            &checked,
            Every::Ticks(every),
            Window::Between(from_ns, to_ns),
        );
        assert_eq!(
            some.lasting_report(true),
            all.lasting_report(true),
            "every {every}"
        );
        let thinned = lines(&some);
        assert_eq!(thinned[0], rows[0], "header");
        let every = every as usize;
        let nth: Vec<&String> = rows[1..].iter().skip(every - 1).step_by(every).collect();
        assert_eq!(
            thinned[1..].iter().collect::<Vec<_>>(),
            nth,
            "every {every}"
        );
        assert!(some.svg == all.svg, "scope.svg is drawn from every tick");

        let window = some.edges();
        let to_ns = to_ns.min(edges.to_ns);
        assert_eq!((window.from_ns, window.to_ns), (from_ns, to_ns));
        for (name, wire) in &edges.wires {
            let mut shown = window.wire(name).clone();
            // A wire that changes at the window's very start first shows its old level.
            shown.changes.retain(|&(at, _)| at < to_ns);
            assert_eq!(
                shown,
                wire.cut(from_ns, to_ns),
                "{name} in {from_ns}..{to_ns}"
            );
        }
    }
}

/// If this fails, watching the loop instead of recording it changes it.
#[test]
fn observer_changes_nothing() {
    let checked = built_in("patent-4");
    let recorded = record(&checked, Every::Fitting, Window::FirstMotion);
    let watched = watch(&checked);
    let ticks = watched.ticks.len() as u64;
    assert_eq!(ticks, watched.outcome.record.control_ticks);
    assert_eq!(recorded.outcome.record, watched.outcome.record);
}
