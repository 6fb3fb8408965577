//! Every printed amplitude, speed and limit is the crank's.
//!
//! The judge knows the scene file, `docs/formats.md`, and what one turn of a crank is. It takes the platform's height and the cranks' turns
//! from the trace of a kinematic run. Where the speed is steady it differentiates the height twice, numerically, and compares amplitude and
//! speed with the program, the trace, the report, the text, and the limits. It knows no mechanism and no formula of the program.

mod height;
mod limits;
mod stated;
mod trace;

use std::fs;
use std::path::Path;

use cophase::Status;
use serde_json::Value;

use self::height::{Height, Peak};
use self::stated::Stated;
use self::trace::{Trace, apart};
use super::command::{Fate, Run, run, settings};
use super::{files, refusal};

/// Standard gravity, in which `amax_g` is stated.
const G_MPS2: f64 = 9.80665;

/// Largest error with which an amplitude is judged, of itself.
const WORST: f64 = 5e-3;

/// Rows of a steady speed from which the height is found.
const ROWS: usize = 3000;

/// Ticks at either end of a steady speed that are left out.
const MARGIN: usize = 3;

/// A steady speed of a run, and what the platform does there.
struct Steady {
    rows: std::ops::Range<usize>,
    /// Speed of the cranks, rev/s, and its error of itself.
    hz: f64,
    hz_error: f64,
    peak: Peak,
    /// Amplitude of the platform's acceleration, m/s², and its error of itself.
    amax_mps2: f64,
    error: f64,
}

/// Runs a scene and judges it. It returns the number of steady speeds that were judged.
pub fn play(scene: &Path, folder: &Path) -> Result<(Fate, u64), String> {
    let text = fs::read_to_string(scene).map_err(|error| error.to_string())?;
    let stated = Stated::read(&text).ok_or("a scene without its keys")?;
    let out = folder.join("out");
    let run = run(scene, &out, &["--every", "1", "--trace", "csv"]);
    if run.status == Status::BadInput {
        refusal::check(&run.err, scene)?;
        if stated.turns_otherwise && !run.err.contains("gear = [") {
            return Err(format!("a ratio is refused without its fix: {}", run.err));
        }
        if stated.turns_otherwise && settings(scene, folder) != Status::BadInput {
            return Err("the settings of a board may have a ratio".to_owned());
        }
        return Ok((Fate::Refused, 0));
    }
    if stated.turns_otherwise {
        return Err("cranks under a platform may turn otherwise than the master".to_owned());
    }
    if run.status != Status::Done {
        return Ok((Fate::Fault, 0));
    }
    let trace = Trace::read(&out)?;
    limits::check(&stated, &trace)?;
    let steady = steady(&stated, &trace)?;
    for one in &steady {
        check_trace(&stated, &trace, one)?;
        check_program(&stated, one)?;
    }
    check_report(&stated, &trace, &steady, &out, &run)?;
    if let Some(peak) = steady.first().map(|one| one.peak) {
        check_limit(&stated, &text, peak, folder)?;
    }
    Ok((Fate::Done, steady.len() as u64))
}

/// Checks that two numbers are equal up to a share of the second.
fn equal(what: &str, printed: f64, measured: f64, error: f64) -> Result<(), String> {
    if (printed - measured).abs() <= error * measured.abs() {
        Ok(())
    } else {
        Err(format!(
            "{what} is {printed}, and the cranks make {measured} (±{:.4} %)",
            100.0 * error
        ))
    }
}

/// The steady speeds of a run that the trace resolves.
fn steady(stated: &Stated, trace: &Trace) -> Result<Vec<Steady>, String> {
    let commanded = trace.column("amax_commanded_mps2")?;
    let omega = trace.column("omega_rad_s")?;
    let is_level = |row: usize| trace.states[row] == "run" && commanded[row] > 0.0;
    let is_equal =
        |row: usize| commanded[row] == commanded[row - 1] && omega[row] == omega[row - 1];
    let mut found = Vec::new();
    let mut from = 0;
    for row in 1..=commanded.len() {
        let goes_on = row < commanded.len() && is_level(row) && is_equal(row);
        if !goes_on {
            if row > from + 2 * MARGIN + 40 && is_level(from) {
                found.extend(measure(stated, trace, from + MARGIN..row - MARGIN)?);
            }
            from = row;
        }
    }
    Ok(found)
}

/// Measures what the platform does in rows of one speed, if they resolve it.
fn measure(
    stated: &Stated,
    trace: &Trace,
    rows: std::ops::Range<usize>,
) -> Result<Option<Steady>, String> {
    let angles = &trace.angle(stated.count)?[rows.clone()];
    let heights_m = &trace.column("z_m")?[rows.clone()];
    let step = stated
        .steps
        .iter()
        .fold(0.0, |max, steps| f64::max(max, 1.0 / steps));
    let (Some(first), Some(last)) = (angles.first(), angles.last()) else {
        return Ok(None);
    };
    let time_s = (angles.len() - 1) as f64 * stated.tick_s;
    let turns = last - first;
    let offset = stated.offset_turns(step, time_s);
    let (hz, hz_error) = (turns / time_s, (step + offset + 2e-9) / turns.max(1e-9));
    let stride = angles.len().div_ceil(ROWS);
    let some = |column: &[f64]| column.iter().copied().step_by(stride).collect::<Vec<f64>>();
    let (angles, heights_m) = (some(angles), some(heights_m));
    let Some((height, peak)) = Height::fit(&angles, &heights_m) else {
        return Ok(None);
    };
    let error = peak.error_m / peak.m + 2.0 * hz_error;
    if error > WORST {
        return Ok(None);
    }
    if height.residual_m > 2e-9 + 0.02 * height.range_m {
        return Err(format!(
            "the platform's height is no function of the cranks' angle: off by {} m of {} m",
            height.residual_m, height.range_m
        ));
    }
    Ok(Some(Steady {
        rows,
        hz,
        hz_error,
        peak,
        amax_mps2: peak.m * (hz * std::f64::consts::TAU).powi(2),
        error: error + 1e-6,
    }))
}

/// Checks the columns of the trace.
fn check_trace(stated: &Stated, trace: &Trace, steady: &Steady) -> Result<(), String> {
    let row = steady.rows.start;
    let commanded = trace.column("amax_commanded_mps2")?[row];
    // The column has four decimals.
    let error = steady.error + 6e-5 / steady.amax_mps2;
    equal("amax_commanded_mps2", commanded, steady.amax_mps2, error)?;
    // The column has six decimals.
    let hz = trace.column("omega_rad_s")?[row] / std::f64::consts::TAU;
    let rounded = 1e-7 / steady.hz;
    equal(
        "omega_rad_s",
        hz,
        steady.hz,
        steady.hz_error + rounded + 1e-6,
    )?;
    let accelerations = &trace.column("accel_mps2")?[steady.rows.clone()];
    let max = accelerations
        .iter()
        .fold(0.0, |max: f64, one| max.max(one.abs()));
    if max > steady.amax_mps2 * (1.0 + error) {
        return Err(format!(
            "accel_mps2 reaches {max}, and the platform accelerates by {}",
            steady.amax_mps2
        ));
    }
    let time_s = (steady.rows.len() - 1) as f64 * stated.tick_s;
    let cranks = trace.cranks(stated.count)?;
    for (axis, turns) in cranks.iter().enumerate() {
        let turned = turns[steady.rows.end - 1] - turns[row];
        let step = 1.0 / stated.steps[axis];
        let error = (step + stated.offset_turns(step, time_s) + 2e-9) / time_s;
        if (turned / time_s - hz).abs() > error + 1e-6 * hz {
            return Err(format!(
                "omega_rad_s is {hz} rev/s, and crank {axis} makes {} (±{error})",
                turned / time_s
            ));
        }
        let steps = trace.column(&format!("steps_{axis}"))?;
        let stepped = (steps[steady.rows.end - 1] - steps[row]).abs();
        let due = turned * stated.steps[axis];
        if (stepped - due).abs() > 1.0 + 1e-8 * due {
            return Err(format!(
                "axis {axis} makes {stepped} steps for {turned} turns of its crank, which are {due}"
            ));
        }
        let off = apart(turns[row], cranks[0][row]).abs();
        if off > 1.0 / stated.steps[axis] + 1.0 / stated.steps[0] + 1.0 / 360.0 {
            return Err(format!("cranks 0 and {axis} are {off} turns apart"));
        }
    }
    Ok(())
}

/// Checks that a speed is that of a level of the program, or lies at the edge of a forbidden band.
fn check_program(stated: &Stated, steady: &Steady) -> Result<(), String> {
    for (from_hz, to_hz) in &stated.bands {
        let error = steady.hz_error + 1e-6;
        if steady.hz > from_hz * (1.0 + error) && steady.hz < to_hz * (1.0 - error) {
            return Err(format!(
                "the cranks dwell at {} rev/s in the band from {from_hz} to {to_hz}",
                steady.hz
            ));
        }
    }
    let at_level = |level: &f64| (level - steady.amax_mps2).abs() <= steady.error * level;
    let at_edge = |(from_hz, to_hz): &(f64, f64)| {
        let at = |edge: f64| (steady.hz - edge).abs() <= (steady.hz_error + 1e-3) * edge;
        at(*from_hz) || at(*to_hz)
    };
    if stated.levels_mps2.iter().any(at_level) || stated.bands.iter().any(at_edge) {
        Ok(())
    } else {
        Err(format!(
            "the platform accelerates by {} m/s² (±{:.4} %), and the program has {:?}",
            steady.amax_mps2,
            100.0 * steady.error,
            stated.levels_mps2
        ))
    }
}

/// Checks the report and the text.
fn check_report(
    stated: &Stated,
    trace: &Trace,
    steady: &[Steady],
    out: &Path,
    run: &Run,
) -> Result<(), String> {
    let report: Value = serde_json::from_str(&files::read(out, "report.json")?)
        .map_err(|error| error.to_string())?;
    let figure = |value: &Value, name: &str| {
        let figure = value[name].as_f64();
        figure.ok_or_else(|| format!("report.json has no {name}"))
    };
    let commanded = trace.column("amax_commanded_mps2")?;
    let top = commanded.iter().copied().fold(0.0, f64::max);
    let Some(fastest) = steady.iter().find(|one| commanded[one.rows.start] == top) else {
        return Ok(());
    };
    equal(
        "amax_top_mps2",
        figure(&report, "amax_top_mps2")?,
        fastest.amax_mps2,
        fastest.error,
    )?;
    equal(
        "speed_top_hz",
        figure(&report, "speed_top_hz")?,
        fastest.hz,
        fastest.hz_error + 1e-6,
    )?;
    for (axis, entry) in report["axes"].as_array().into_iter().flatten().enumerate() {
        let Some(rate_hz) = entry["motor"]["step_rate_max_hz"].as_f64() else {
            continue;
        };
        let rows = &fastest.rows;
        let steps = trace.column(&format!("steps_{axis}"))?;
        let stepped = (steps[rows.end - 1] - steps[rows.start]).abs();
        let time_s = (rows.len() - 1) as f64 * stated.tick_s;
        let at_limit_hz = stepped / time_s * stated.speed_hz / fastest.hz;
        let offset = stated.offset_turns(1.0 / stated.steps[axis], time_s) * stated.steps[axis];
        let error = fastest.hz_error + (1.0 + offset) / stepped;
        equal("step_rate_max_hz", rate_hz, at_limit_hz, error + 1e-6)?;
    }
    let printed = |line: &str| {
        let (_, rest) = line
            .strip_prefix("The commanded amax was held for ")?
            .split_once("at most ")?;
        let (amax_g, rest) = rest.split_once(" g, at ")?;
        let (hz, _) = rest.split_once(" rev/s")?;
        Some((amax_g.parse().ok()?, hz.parse().ok()?))
    };
    if let Some((amax_g, hz)) = run.out.lines().find_map(printed) {
        let (amax_g, hz): (f64, f64) = (amax_g, hz);
        let measured_g = fastest.amax_mps2 / G_MPS2;
        let rounded = 0.051 / measured_g;
        equal(
            "the summary's amax in g",
            amax_g,
            measured_g,
            fastest.error + rounded,
        )?;
        let rounded = 0.0051 / fastest.hz;
        equal(
            "the summary's speed",
            hz,
            fastest.hz,
            fastest.hz_error + rounded,
        )?;
    }
    Ok(())
}

/// Checks that the largest amplitude that a refusal allows is that of the cranks at the limit of their speed.
fn check_limit(stated: &Stated, text: &str, peak: Peak, folder: &Path) -> Result<(), String> {
    let limit_g = peak.m * (stated.speed_hz * std::f64::consts::TAU).powi(2) / G_MPS2;
    let error = peak.error_m / peak.m;
    let amax_g = limit_g * (1.0 + error) * 1.01 + 0.01;
    if amax_g * G_MPS2 >= 1e4 {
        return Ok(());
    }
    let mut table: toml::Table = text.parse().map_err(|error| format!("{error}"))?;
    let level = toml::toml! { hold_s = 0.1 };
    let level = level
        .into_iter()
        .chain([("amax_g".to_owned(), amax_g.into())]);
    let program = toml::Value::Array(vec![toml::Value::Table(level.collect())]);
    table.insert("program".to_owned(), program);
    let scene = folder.join("over.toml");
    fs::write(&scene, table.to_string()).map_err(|error| error.to_string())?;
    let run = run(&scene, &folder.join("over"), &[]);
    let printed = run.err.split_once("give at most ").and_then(|(_, rest)| {
        let (amax_g, _) = rest.split_once(" g")?;
        amax_g.parse::<f64>().ok()
    });
    match (run.status, printed) {
        (Status::BadInput, Some(max_g)) => {
            let rounded = 0.011 / limit_g;
            equal(
                "the largest amax_g of a refusal",
                max_g,
                limit_g,
                error + rounded,
            )
        }
        _ => Err(format!(
            "{amax_g} g is more than the cranks make at speed_hz, {limit_g} g, and: {}",
            run.err
        )),
    }
}
