//! Tests of `compare` on synthetic rows and edges, against plain definitions.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use cophase_files::compare::{
    Comparison, Matching, Origin, Run, Tolerances, Trace, compare, summary,
};
use proptest::prelude::*;

/// Length of a tick of the synthetic traces, ns.
const TICK_NS: u64 = 500_000;
const HEADER: &str = "t_s,state,state_code,accel_mps2,steps_0\n";

/// Rows of a synthetic run, one a tick from tick 1 on: state, acceleration, steps.
type Ticks = Vec<(bool, f64, i64)>;

/// Time of a tick as written in the trace.
fn t_s(tick: u64, shift_ns: u64) -> String {
    let ns = tick * TICK_NS + shift_ns;
    format!("{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
}

fn csv(ticks: &Ticks, every: u64, shift_ns: u64) -> String {
    let mut text = HEADER.to_owned();
    for (tick, (runs, accel, steps)) in (1..).zip(ticks) {
        if tick % every == 0 {
            let (state, code) = if *runs { ("run", 2) } else { ("idle", 0) };
            writeln!(
                text,
                "{},{state},{code},{accel},{steps}",
                t_s(tick, shift_ns)
            )
            .unwrap();
        }
    }
    text
}

fn run(name: &str, text: &str) -> Run {
    let path = PathBuf::from(name);
    let trace = Trace::parse(&path, text).unwrap();
    Run::of_trace(path, trace)
}

fn compared(first: &str, second: &str, origin: Origin, tolerances: &Tolerances) -> Comparison {
    let (a, b) = (run("a", first), run("b", second));
    compare([&a, &b], origin, tolerances).unwrap()
}

fn at_power_up(first: &str, second: &str) -> Comparison {
    compared(first, second, Origin::PowerUp, &Tolerances::default())
}

fn steady(length: usize) -> Ticks {
    (0..length)
        .map(|i| (i >= 10, (i as f64 * 0.7).sin(), 3 * i as i64))
        .collect()
}

/// Computes everything that the summary of a column states from the text alone. It compares every row of one file with
/// every row of the other.
fn judged(
    first: &str,
    second: &str,
    column: usize,
    tolerance: f64,
) -> Option<(usize, f64, f64, Option<String>)> {
    let rows = |text: &str| -> Vec<Vec<String>> {
        let lines = text.lines().skip(1);
        lines
            .map(|line| line.split(',').map(str::to_owned).collect())
            .collect()
    };
    let others: BTreeMap<String, Vec<String>> = rows(second)
        .into_iter()
        .map(|row| (row[0].clone(), row))
        .collect();
    let mut differences = Vec::new();
    for row in rows(first) {
        if let Some(other) = others.get(&row[0]) {
            let number = |text: &str| text.parse::<f64>().unwrap();
            differences.push((
                row[0].clone(),
                number(&other[column]) - number(&row[column]),
            ));
        }
    }
    let count = differences.len();
    let max = differences.iter().map(|(_, d)| d.abs()).reduce(f64::max)?;
    let mean_square = differences.iter().map(|(_, d)| d * d).sum::<f64>() / count as f64;
    let exceeds = differences.iter().find(|(_, d)| d.abs() > tolerance);
    Some((
        count,
        max,
        mean_square.sqrt(),
        exceeds.map(|(t_s, _)| t_s.clone()),
    ))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn compared_columns_match_a_direct_computation(
        length in 30_usize..200,
        every in (1_u64..6, 1_u64..6),
        changes in prop::collection::vec((0_usize..200, -3.0_f64..3.0, -2_i64..3), 0..6),
        tolerance in 0.0_f64..2.0,
    ) {
        let ticks = steady(length);
        let mut others = ticks.clone();
        for (at, accel, steps) in changes {
            if let Some(tick) = others.get_mut(at) {
                tick.1 += accel;
                tick.2 += steps;
            }
        }
        let (first, second) = (csv(&ticks, every.0, 0), csv(&others, every.1, 0));
        let tolerances = Tolerances::new([("accel_mps2".to_owned(), tolerance)]);
        let comparison = compared(&first, &second, Origin::PowerUp, &tolerances);
        let mut parts = Vec::new();
        for (name, column, tolerance) in [("accel_mps2", 3, tolerance), ("steps_0", 4, 0.0)] {
            let (count, max, rms, exceeds) = judged(&first, &second, column, tolerance).unwrap();
            let found = comparison.columns.iter().find(|found| found.name == name).unwrap();
            prop_assert_eq!(comparison.matching, Matching::CommonRows);
            prop_assert_eq!(found.compared, count);
            prop_assert!((found.max.unwrap().abs() - max).abs() <= 1e-12);
            prop_assert!((found.rms.unwrap() - rms).abs() <= 1e-12);
            let exceeds = exceeds.map(|t_s| t_s.parse::<f64>().unwrap());
            prop_assert_eq!(found.exceeds_at_s.is_some(), exceeds.is_some());
            if let (Some(found), Some(expected)) = (found.exceeds_at_s, exceeds) {
                prop_assert!((found - expected).abs() < 1e-9);
                parts.push(expected);
            }
        }
        // The ends of the files differ by less than the distance of two rows, so no other difference exists.
        let first_part = parts.into_iter().reduce(f64::min);
        prop_assert_eq!(comparison.parts.is_some(), first_part.is_some());
        if let (Some(part), Some(expected)) = (&comparison.parts, first_part) {
            prop_assert!((part.at_s - expected).abs() < 1e-9);
        }
    }

    /// Edges are at least 1000 ns apart and shifted by at most 400 ns, so each one has a unique partner.
    #[test]
    fn every_lost_and_shifted_edge_is_counted(
        edges in prop::collection::vec((1_000_u64..5_000, 0_u8..10, -400_i64..400), 4..200),
        tolerance in 0_i64..500,
    ) {
        let folder = tempfile::tempdir().unwrap();
        // Pulses last 300 ns. In the second file some are missing, and others are shifted as a whole.
        let (mut first, mut second) = (Vec::new(), Vec::new());
        let (mut equal, mut shifted, mut lost, mut first_differs) = (0, 0, 0, None);
        let mut at = 100_000_u64;
        for (distance, fate, shift) in edges {
            at += distance;
            first.push(at);
            let differs = match fate {
                0 => { lost += 1; true }
                1 => {
                    second.push(at.checked_add_signed(shift).unwrap());
                    let is_equal = shift.abs() <= tolerance;
                    equal += usize::from(is_equal);
                    shifted += usize::from(!is_equal);
                    !is_equal
                }
                _ => { second.push(at); equal += 1; false }
            };
            if differs && first_differs.is_none() {
                first_differs = Some(if fate == 0 { at } else { at.min(*second.last().unwrap()) });
            }
        }
        let end = at + 100_000;
        let text = csv(&steady(20), 1, 0);
        let folders = [("a", first), ("b", second)].map(|(name, pulses)| {
            let folder = folder.path().join(name);
            std::fs::create_dir(&folder).unwrap();
            std::fs::write(folder.join("trace.csv"), &text).unwrap();
            std::fs::write(folder.join("steps.vcd"), vcd(&pulses, end)).unwrap();
            folder
        });
        let [a, b] = folders.map(|folder| Run::read(&folder).unwrap());
        let tolerances = Tolerances::new([("edges_ns".to_owned(), tolerance as f64)]);
        let comparison = compare([&a, &b], Origin::PowerUp, &tolerances).unwrap();
        let found = comparison.edges.unwrap();
        // The two edges of a pulse are lost or shifted together.
        prop_assert_eq!(found.total(|wire| wire.equal), 2 * equal);
        prop_assert_eq!(found.total(|wire| wire.shifted), 2 * shifted);
        prop_assert_eq!(found.total(|wire| wire.only_first), 2 * lost);
        prop_assert_eq!(found.total(|wire| wire.only_second), 0);
        let part = comparison.parts.map(|part| (part.at_s * 1e9).round() as u64);
        prop_assert_eq!(part, first_differs);
    }
}

/// Returns a file with one wire of pulses that are 300 ns long.
fn vcd(pulses: &[u64], end: u64) -> String {
    let mut text = "$timescale 1 ns $end\n$scope module cophase $end\n$var wire 1 ! step_0 $end\n$upscope $end\n\
                    $enddefinitions $end\n#0\n$dumpvars\n0!\n$end\n"
        .to_owned();
    for at in pulses {
        write!(text, "#{at}\n1!\n#{}\n0!\n", at + 300).unwrap();
    }
    writeln!(text, "#{end}").unwrap();
    text
}

#[test]
fn delayed_runs_differ_unless_times_count_from_the_start() {
    let ticks = steady(100);
    let mut late: Ticks = vec![(false, ticks[0].1, ticks[0].2); 7];
    late.extend(ticks.iter().copied());
    let (first, second) = (csv(&ticks, 1, 0), csv(&late, 1, 0));
    let parted = at_power_up(&first, &second);
    assert!(
        (parted.parts.as_ref().unwrap().at_s - 0.001).abs() < 1e-12,
        "{parted:?}"
    );
    let text = summary(&parted);
    assert!(
        text.contains("A leaves idle at 0.005 s, and B at 0.0085 s; --from start"),
        "{text}"
    );
    let equal = compared(&first, &second, Origin::Start, &Tolerances::default());
    assert_eq!(equal.parts, None, "{}", summary(&equal));
}

/// A file that ends early counts as different only if something happens after its end.
#[test]
fn missing_rows_count_only_if_something_happens_in_them() {
    let mut ticks = steady(100);
    let at_rest = *ticks.last().unwrap();
    ticks.extend(vec![at_rest; 20]);
    let all = csv(&ticks, 1, 0);
    let without_rest = csv(&ticks[..105].to_vec(), 1, 0);
    let cut = csv(&ticks[..60].to_vec(), 1, 0);
    for (a, b) in [(&all, &without_rest), (&without_rest, &all)] {
        let comparison = at_power_up(a, b);
        assert_eq!(comparison.parts, None);
        assert_eq!(comparison.surplus.len(), 1);
    }
    for (a, b) in [(&all, &cut), (&cut, &all)] {
        let comparison = at_power_up(a, b);
        let part = comparison.parts.as_ref().unwrap();
        assert!((part.at_s - 0.0305).abs() < 1e-12, "{part:?}");
        assert!(summary(&comparison).contains("covers 0.0305 to 0.06 s; accel_mps2 changes"));
    }
}

/// Without a common time, numbers are interpolated. Integers and states are not.
#[test]
fn integers_are_not_interpolated_between_rows() {
    let ramp: Ticks = (0..40)
        .map(|i| (i >= 20, f64::from(i), i64::from(i)))
        .collect();
    let (first, second) = (csv(&ramp, 1, 0), csv(&ramp, 1, TICK_NS / 4));
    let comparison = at_power_up(&first, &second);
    assert_eq!(comparison.matching, Matching::BetweenRowsOfSecond);
    let column = |name: &str| comparison.columns.iter().find(|c| c.name == name).unwrap();
    // With a delay of a quarter of a tick, a slope of 1 a tick gives a quarter less. The last whole number is one
    // less.
    let accel = column("accel_mps2");
    assert!((accel.max.unwrap() + 0.25).abs() < 1e-9 && (accel.rms.unwrap() - 0.25).abs() < 1e-9);
    assert_eq!(column("steps_0").max, Some(-1.0));
    // At only one row, A is in the run state and B is not yet.
    assert_eq!(column("state").beyond, 1);
    assert_eq!(column("state").compared, 39);
    assert!(summary(&comparison).contains("are held"));
}

#[test]
fn a_column_without_values_is_not_compared() {
    let empty = "t_s,state,state_code,accel_mps2,steps_0\n0.0005,idle,0,,0\n0.001,idle,0,,0\n";
    let full = "t_s,state,state_code,accel_mps2,steps_0\n0.0005,idle,0,5,0\n0.001,idle,0,6,0\n";
    let comparison = at_power_up(empty, full);
    assert_eq!(comparison.parts, None);
    assert_eq!(comparison.columns[2].compared, 0);
    assert!(summary(&comparison).contains("accel_mps2             not compared"));
}

#[test]
fn not_a_number_differs_from_a_number_and_not_from_itself() {
    let with = |accel: &str| format!("{HEADER}0.0005,idle,0,{accel},0\n0.001,idle,0,{accel},0\n");
    assert_eq!(at_power_up(&with("NaN"), &with("NaN")).parts, None);
    assert_eq!(at_power_up(&with("inf"), &with("inf")).parts, None);
    for other in ["5", "inf"] {
        let comparison = at_power_up(&with("NaN"), &with(other));
        assert_eq!(comparison.columns[2].max, Some(f64::INFINITY));
        assert!(comparison.parts.is_some());
    }
}

#[test]
fn incomparable_runs_are_refused_with_a_reason() {
    let good = csv(&steady(20), 1, 0);
    let refused = |second: &str, tolerance: Option<&str>| {
        let tolerances = Tolerances::new(tolerance.map(|name| (name.to_owned(), 1.0)));
        let (a, b) = (run("first.csv", &good), run("second.csv", second));
        compare([&a, &b], Origin::PowerUp, &tolerances)
            .unwrap_err()
            .to_string()
    };
    let other_axes = good
        .replace("steps_0\n", "steps_0,steps_1\n")
        .replace(",0\n", ",0,0\n");
    let other_axes: String = other_axes
        .lines()
        .map(|line| {
            if line.matches(',').count() == 4 {
                format!("{line},0\n")
            } else {
                format!("{line}\n")
            }
        })
        .collect();
    let later = csv(&steady(20), 1, 1_000_000_000);
    for (second, tolerance, problem) in [
        (
            other_axes,
            None,
            "second.csv: it has 2 axes, and first.csv has 1",
        ),
        (
            good.replace("accel_mps2", "other_mps2"),
            None,
            "second.csv: column accel_mps2 of first.csv is missing",
        ),
        (later, None, "no time in common"),
        (
            good.clone(),
            Some("acel_mps2"),
            "--tolerance acel_mps2: the traces have no such column; did you mean `accel_mps2`?",
        ),
    ] {
        let error = refused(&second, tolerance);
        assert!(error.contains(problem), "{error}");
    }
    let error = Run::read(Path::new("/no/such/run"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("/no/such/run") && error.contains("give the folder of a run"),
        "{error}"
    );
}
