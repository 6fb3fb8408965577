//! A loop that wakes late: results that must not change, events that must be reported, and delays that must
//! stop the machine.
//!
//! A tick is 500 µs here. The output that the loop submits at one deadline plays from the next on. A
//! deadline missed at `LATE_S` therefore leaves the drives without pulses from a tick after that.

use cophase_core::supervisor::{FaultKind, State};
use cophase_files::trace::{Every, Window};
use cophase_tests::{SceneBuilder, Tick, Watched, bench_scene, record, watch};
use host_sim::checked::Checked;

const TICK_NS: u64 = 500_000;
const LATE_S: f64 = 1.2;

fn machine() -> SceneBuilder {
    bench_scene()
        .with(
            r#"
machine = { crank_radius_mm = 20, lambda = 0.3 }
control = { settle_s = 0.02 }
limits = { speed_hz = 12, jerk_hz_per_s2 = 1000, homing_speed_hz = 5 }
axis = [{ number = 1, reversed = true }, { number = 2, drive = "servo" }]
"#,
        )
        .program([(9.0, 1.5, 0.7), (2.0, 0.6, 0.2)])
}

/// The machine with a loop that is late once.
fn late(at_s: f64, by_us: f64) -> SceneBuilder {
    machine().with(&format!("late = [{{ at_s = {at_s}, by_us = {by_us} }}]"))
}

fn late_by(by_us: f64) -> Checked {
    late(LATE_S, by_us).checked()
}

/// Returns the commands of the ticks, without their times and counters.
fn commanded(watched: &Watched) -> Vec<Tick> {
    let timeless = |tick: &Tick| Tick {
        start_ns: 0,
        missed: 0,
        late: 0,
        ..*tick
    };
    watched.ticks.iter().map(timeless).collect()
}

/// Gaps between ticks, as (time at which the drives had nothing to play, number of ticks).
fn gaps(watched: &Watched) -> Vec<(u64, u64)> {
    let gap = |pair: &[Tick]| {
        let (end_ns, next_ns) = (pair[0].start_ns + TICK_NS, pair[1].start_ns);
        (next_ns != end_ns).then(|| (end_ns, (next_ns - end_ns) / TICK_NS))
    };
    watched.ticks.windows(2).filter_map(gap).collect()
}

/// If this fails, ordinary jitter of the processor reaches the cranks.
#[test]
fn delay_within_a_tick_changes_only_the_count() {
    let punctual = watch(&machine().checked());
    for (by_us, counted) in [(200.0, 0), (300.0, 1), (499.0, 1)] {
        let late = watch(&late_by(by_us));
        assert_eq!(
            (late.last().late, late.last().missed),
            (counted, 0),
            "{by_us} µs"
        );
        assert_eq!(commanded(&late), commanded(&punctual), "{by_us} µs");
        assert_eq!(gaps(&late), []);
        assert_eq!(late.outcome.state, State::Parked);
    }
    let report = record(&late_by(300.0), Every::Fitting, Window::FirstMotion).report;
    assert_eq!(report["late_deadlines"], 1);
}

/// If this fails, a missed deadline costs steps, makes some axes stand and not others, or is made up for by
/// a burst. (`watch` asserts that all axes are together at every tick.)
#[test]
fn missed_deadline_pauses_all_axes_without_losing_steps() {
    let punctual = watch(&machine().checked());
    for (by_us, missed) in [(500.0, 1), (750.0, 1), (1000.0, 2), (1499.0, 2)] {
        let checked = late_by(by_us);
        let late = watch(&checked);
        assert_eq!(late.last().missed, missed, "{by_us} µs");
        assert_eq!(late.outcome.fault, None, "{by_us} µs");
        // The program and all its results are the same, to the bit, only later.
        assert_eq!(commanded(&late), commanded(&punctual), "{by_us} µs");
        let stand_ns = (LATE_S * 1e9) as u64 + TICK_NS;
        assert_eq!(gaps(&late), [(stand_ns, u64::from(missed))], "{by_us} µs");
        assert_eq!(
            late.last().start_ns,
            punctual.last().start_ns + u64::from(missed) * TICK_NS
        );

        // Meanwhile nothing moves on any wire, and the report says so.
        let run = record(&checked, Every::Ticks(1), Window::All);
        let until_ns = stand_ns + u64::from(missed) * TICK_NS;
        for axis in [0, 1] {
            let step = run.edges().wire(&format!("step_{axis}")).clone();
            assert_eq!(
                step.cut(stand_ns, until_ns).changes,
                [],
                "axis {axis} stands"
            );
            assert!(
                !step.cut(stand_ns - TICK_NS, stand_ns).changes.is_empty(),
                "it moved before"
            );
            assert!(
                !step.cut(until_ns, until_ns + TICK_NS).changes.is_empty(),
                "and after"
            );
            let steps = run.edges().steps(axis, axis == 1);
            assert_eq!(steps, punctual.last().steps, "axis {axis}");
        }
        let events = run.report["events"].to_string();
        assert!(
            events.contains(&format!(
                "{missed} deadline{} missed",
                if missed == 1 { "" } else { "s" }
            )),
            "{events}"
        );
    }
}

/// If this fails, a processor that hangs leaves the machine running without a program. Or it cuts the drives
/// off and each crank coasts by itself, although the loop is back.
#[test]
fn deadlines_missed_three_times_stop_the_machine_in_phase() {
    for (by_us, missed) in [(1500.0, 3), (5000.0, 10)] {
        let late = watch(&late_by(by_us));
        let fault = late.outcome.fault.expect("an overrun is a fault");
        assert_eq!(fault.kind, FaultKind::Overrun);
        // These are the ticks that the loop has played, without the missed ones.
        assert_eq!(fault.tick, (LATE_S * 2000.0) as u64);
        assert_eq!(late.last().missed, missed, "{by_us} µs");
        assert_eq!(
            late.states(),
            [State::Homing, State::Run, State::Stop, State::Fault]
        );
        assert_eq!(gaps(&late).len(), 1);
        // The stop keeps the acceleration that the scene allows: 40 rev/s² at 2 kHz, in 2⁻⁴⁸ turn.
        let max = (40.0 / 4e6 * (1_u64 << 48) as f64) as u64;
        let stopping: Vec<&Tick> = late
            .ticks
            .iter()
            .filter(|tick| tick.state == State::Stop)
            .collect();
        assert!(stopping[0].speed > 0, "{by_us} µs: stopped from speed");
        for pair in stopping.windows(2) {
            assert!(pair[1].speed.abs_diff(pair[0].speed) <= max);
            assert!(pair[1].drives_enabled, "the drives hold the cranks");
        }
        assert_eq!(stopping[stopping.len() - 1].speed, 0);
        assert!(late.last().drives_enabled, "and go on holding them");
    }
}

/// The scene with `times` missed deadlines, one every `ticks` ticks.
fn missing_one_in(ticks: u32, times: u32) -> Watched {
    let late: String = (0..times)
        .map(|i| {
            let at_s = LATE_S + f64::from(i * ticks) * TICK_NS as f64 * 1e-9;
            format!("[[late]]\nat_s = {at_s}\nby_us = 550\n")
        })
        .collect();
    watch(&machine().with(&late).checked())
}

/// If this fails, a loop with more work than a tick has time for runs on without end, at a fraction of its
/// speed. All axes stay in phase, and only a counter reports it.
#[test]
fn deadlines_missed_repeatedly_are_a_fault() {
    for (ticks, misses_before_the_fault) in [(2, 3), (3, 3), (5, 4)] {
        let watched = missing_one_in(ticks, 40);
        let fault = watched.outcome.fault.expect("an overrun is a fault");
        assert_eq!(fault.kind, FaultKind::Overrun, "one in {ticks}");
        // The fault's tick does not count missed ticks.
        let passed = fault.tick - (LATE_S * 2000.0) as u64;
        let max = u64::from(ticks * misses_before_the_fault);
        assert!(passed < max, "one in {ticks}: {passed} ticks");
    }
    let watched = missing_one_in(9, 60);
    assert_eq!(watched.outcome.fault, None);
    assert_eq!(watched.last().missed, 60);
}

/// If this fails, an index pulse that comes while deadlines are missed is compared with a phase that was
/// never played. One axis is then taken to be off: with sensors that stand apart, at some times.
#[test]
fn missed_deadline_causes_no_tilt_fault() {
    for tick in 0..100 {
        let at_s = LATE_S + f64::from(tick) * TICK_NS as f64 * 1e-9;
        let apart = late(at_s, 550.0)
            .axis(1, "index_deg", 90)
            .axis(2, "index_deg", 180);
        let watched = watch(&apart.checked());
        assert_eq!(watched.outcome.fault, None, "missed at {at_s} s");
        assert_eq!(watched.outcome.record.figures.missed_deadlines, 1);
    }
}
