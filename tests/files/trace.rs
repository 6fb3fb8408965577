//! The files of a run agree with each other and with integrals of its speed. The integrals are computed
//! without the loop.

#[path = "../support/program.rs"]
mod program;

use std::f64::consts::TAU;

use cophase_files::trace::{Every, Window};
use cophase_tests::{Run, Trace, bench_scene, built_in, record};
use host_sim::checked::Checked;
use program::Program;

/// A quarter of a minute, gentle enough for the shaft to follow its program to the tick once it has started.
/// Ramps have both shapes, a block contains a block, and there are no bands. The axes differ in every setting
/// that may differ.
fn gentle() -> Checked {
    bench_scene()
        .with(
            r#"
machine = { crank_radius_mm = 20, lambda = 0.3 }
control = { park_deg = 33.3 }
limits = { speed_hz = 12, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 40000 }
axes = { count = 4 }
axis = [
  { number = 1, reversed = true },
  { number = 2, steps_per_turn = 400 },
  { number = 3, drive = "servo", steps_per_turn = 8192 },
]
[[program]]
amax_g = 2
ramp_s = 1
hold_s = 1
[[program]]
amax_g = 9
ramp_s = 2
hold_s = 0.5
[[program]]
repeat = 2
segments = [
  { amax_g = 4, ramp_s = 1, hold_s = 0.2, shape = "linear" },
  { repeat = 2, segments = [
    { amax_g = 6.5, ramp_s = 0.7, hold_s = 0.1, shape = "linear" },
    { amax_g = 3, ramp_s = 0.8 },
  ] },
]
[[program]]
amax_g = 5
ramp_s = 1
hold_s = 1
"#,
        )
        .checked()
}

fn reversed(checked: &Checked, axis: usize) -> bool {
    checked.scene.resolved(axis).own.reversed
}

/// True if the axis has pulses. The counts of a servo make no edges.
fn has_pulses(checked: &Checked, axis: usize) -> bool {
    checked.scene.resolved(axis).drive.kind().takes_pulses()
}

fn steps_per_turn(checked: &Checked, axis: usize) -> f64 {
    f64::from(checked.scene.resolved(axis).steps_per_turn)
}

fn last_steps(trace: &Trace, axis: usize) -> i64 {
    *trace.axis("steps", axis).last().expect("a trace has rows") as i64
}

/// Checks that the edges of a whole run, its last row and its report give the same number of steps.
fn totals_agree(checked: &Checked, run: &Run) {
    let (trace, edges) = (run.trace(), run.edges());
    assert_eq!(edges.from_ns, 0, "the window is all of the run");
    for axis in 0..trace.axes {
        let steps = last_steps(&trace, axis);
        assert!(steps > 1000, "axis {axis} has moved");
        assert_eq!(
            run.report["axes"][axis]["steps"], steps,
            "report, axis {axis}"
        );
        if has_pulses(checked, axis) {
            assert_eq!(
                edges.steps(axis, reversed(checked, axis)),
                steps,
                "edges, axis {axis}"
            );
        } else {
            assert!(edges.wire(&format!("step_{axis}")).changes.is_empty());
        }
    }
}

/// If this fails, at least one of the three files has wrong steps. Each file gets its steps in a different
/// way (the planner's counter, the edges as played, the record).
#[test]
fn trace_edges_and_report_count_the_same_steps() {
    for checked in [gentle(), built_in("lost-steps")] {
        let run = record(&checked, Every::Ticks(1), Window::All);
        totals_agree(&checked, &run);
    }
}

/// If this fails, a window shows edges of another time, or loses some at its ends. The window lies across the
/// first passage of the band, where speed and acceleration are high.
#[test]
fn window_shows_the_steps_that_its_rows_count() {
    let (from_s, to_s) = (18.6, 19.3);
    let checked = built_in("default");
    let window = Window::Between(18_600_000_000, 19_300_000_000);
    let run = record(&checked, Every::Ticks(1), window);
    let (trace, edges) = (run.trace(), run.edges());
    assert_eq!(
        (edges.from_ns, edges.to_ns),
        (18_600_000_000, 19_300_000_000)
    );
    let (from, to) = (trace.row_at(from_s), trace.row_at(to_s));
    for axis in 0..4 {
        let steps = trace.axis("steps", axis);
        let between = (steps[to] - steps[from]) as i64;
        assert!(between > 20_000);
        assert_eq!(
            edges.steps(axis, reversed(&checked, axis)),
            between,
            "axis {axis}"
        );
        assert_eq!(run.report["axes"][axis]["steps"], last_steps(&trace, axis));
    }
    sums_agree(&checked, &trace);
}

/// Compares the steps with the sum of the column `omega_rad_s`. Each row's speed holds over its whole tick,
/// so the sum is the integral, without a rule of quadrature. Its digits end at 1e-6 rad/s. Over the 120,000
/// ticks of a minute the error is at most 120,000 · 5e-7 · T/2π = 5e-6 turns, 0.04 counts of 8192. The steps
/// are the travel rounded down, so they are less than one step behind.
fn sums_agree(checked: &Checked, trace: &Trace) {
    let tick_s = 1.0 / f64::from(checked.scene.control.tick_hz);
    let turns: f64 = trace.column("omega_rad_s").iter().sum::<f64>() * tick_s / TAU;
    for axis in 0..trace.axes {
        let distance = turns * steps_per_turn(checked, axis);
        let ahead = distance - last_steps(trace, axis) as f64;
        assert!(
            (-0.05..1.05).contains(&ahead),
            "axis {axis}: {ahead} steps between speed and steps"
        );
    }
}

/// If this fails, the speed in a trace is not the speed that was driven.
#[test]
fn steps_are_the_integral_of_the_speed() {
    for checked in [gentle(), built_in("lost-steps"), built_in("patent-2")] {
        let run = record(&checked, Every::Ticks(1), Window::FirstMotion);
        sums_agree(&checked, &run.trace());
    }
}

/// If this fails, the machine runs another program than the scene's. The test evaluates the program's levels,
/// shapes, times, repeats and the law between amax and speed again, in f64, and integrates by Simpson's rule.
///
/// The loop's tick has the speed that the program requests at the tick's *end*. Over ticks of length T from
/// ω(a) to ω(b) it is therefore ahead of the integral by T/2 (ω(b) − ω(a)), less T²/12 (ω'(b) − ω'(a)). The
/// second term, 2e-8 · 20 rad/s² / 2π of a turn, is negligible. The speed law is accurate to 2⁻³⁰ (1e-9 · 60
/// turns) and a ramp's level to 2⁻²⁶, half of that in speed (7e-9 · 60 turns = 4e-7): 0.004 counts of 8192.
/// Both ends are rounded down to whole steps: less than one step in all.
#[test]
fn steps_are_the_integral_of_the_program() {
    let checked = gentle();
    let run = record(&checked, Every::Ticks(1), Window::FirstMotion);
    let trace = run.trace();
    let tick_s = 1.0 / f64::from(checked.scene.control.tick_hz);
    let program = Program::new(&checked.scene.program);
    let running = trace.first("run");
    // The first row in `run` belongs to the program's first tick, and ends one tick into the program.
    let start_s = trace.column("t_s")[running.start] - tick_s;
    assert_eq!(
        running.len(),
        (program.duration_s() / tick_s).round() as usize
    );

    // From inside the first hold, long after the shaft has caught up with the program, to the program's end.
    let (from, to) = (running.start + 3000 - 1, running.end - 1);
    let time = |row: usize| trace.column("t_s")[row] - start_s;
    for what in ["behind the program", "forbidden band", "missed"] {
        for (_, until_s) in run.spans(what) {
            assert!(
                until_s < start_s + time(from),
                "`{what}` until {until_s} s: not gentle enough"
            );
        }
    }
    assert!(
        !run.spans("behind the program").is_empty(),
        "the start, at the least, is reported"
    );

    let machine = checked.scene.machine.as_ref().unwrap();
    let stiffness = machine.crank_radius_mm.unwrap() * 1e-3 * (1.0 + machine.lambda.unwrap());
    let omega = |t_s: f64| (program.amax_mps2(t_s) / stiffness).sqrt();
    let (a, b) = (time(from), time(to));
    let integral = program.integral(a, b, omega);
    let turns = (integral + tick_s / 2.0 * (omega(b) - omega(a))) / TAU;
    assert!(turns > 50.0);
    for axis in 0..trace.axes {
        let steps = trace.axis("steps", axis);
        let made = steps[to] - steps[from];
        let off = made - turns * steps_per_turn(&checked, axis);
        assert!(
            off.abs() < 1.05,
            "axis {axis}: {off} steps from the program's own integral"
        );
    }
    // The trace shows the program's level at every tick, to the last digit (5e-5) and the ramp's 2⁻²⁶ of at
    // most 70 m/s².
    for row in running {
        let reported = trace.column("amax_requested_mps2")[row];
        let off = reported - program.amax_mps2(time(row));
        assert!(
            off.abs() < 5.2e-5,
            "{} s: the program is off by {off} m/s²",
            time(row)
        );
    }
}
