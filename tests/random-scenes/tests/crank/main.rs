//! Every printed amplitude, speed and limit is the crank's.
//!
//! Random scenes with cranks under a platform run on the kinematic level. The judge has the platform's own height alone: column `z_m` of
//! the trace over time. It finds the period of that motion and differentiates it twice ([`height`]). With that it compares the amplitude
//! and the speed that the summary, the report and the trace give, the limits of the scene, and the turns of each motor behind its gear.
//!
//! `COPHASE_CRANK_SCENES` is the number of scenes, and `COPHASE_RANDOM_SEED` the first seed.

mod height;

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use clap::Parser;
use cophase::{Command, Status};
use cophase_random_scenes::{Kinds, draw};
use height::Height;
use host_sim::design::STANDARD_GRAVITY_MPS2;
use host_sim::mechanism::{AnyMechanism, Configured, Mechanism};
use host_sim::scene::file::{Fidelity, Questions, Scene, Segment, Shape};
use host_sim::scene::{Checked, load};
use serde_json::Value;

/// Number of scenes if no other is requested.
const FEW: u64 = 16;
/// Turns of the cranks at the level that is judged, and in the judge's window.
const TURNS: f64 = 14.0;
const WINDOW_TURNS: f64 = 10.0;
/// Least ticks per turn at that level: enough to differentiate the height twice.
const TICKS_PER_TURN: f64 = 50.0;
/// Resolutions that are tried, steps per turn of the motor. Steps make the height of the platform coarse.
const STEPS: [u32; 5] = [102_400, 25_600, 12_800, 6400, 3200];
/// Least steps per turn of a crank with which the height is fine enough.
const LEAST_STEPS: f64 = 3000.0;
/// Relative tolerance of speeds, and that of accelerations without the effect of steps.
const SPEED_TOLERANCE: f64 = 1e-3;
const AMAX_TOLERANCE: f64 = 5e-3;

/// A drawn scene whose last level is held for some turns. `None` if the scene has no platform, or none of its cranks is fine enough.
fn scene(seed: u64) -> Option<(Scene, f64)> {
    let kinds = Kinds {
        disturbed: false,
        ..Kinds::QUESTIONS
    };
    let mut scene = load::parse(&draw(seed, kinds).text).expect("a drawn scene can be read");
    scene.machine.as_ref()?;
    (scene.fidelity, scene.questions) = (Fidelity::Kinematic, Questions::default());
    scene.axes.full_steps_per_turn = 200;
    // Cranks that are set apart lower the platform's amplitude, and a machine that trips holds no level.
    scene.axes.offset_deg = 0.0;
    (scene.correction, scene.drift, scene.noise) = Default::default();
    for own in &mut scene.axis {
        (own.offset_deg, own.steps_per_turn) = (None, None);
        (own.trim_deg, own.start_deg) = (0.0, 0.0);
    }
    let limits = &scene.limits;
    let platform = host_sim::scene::platform(scene.machine.as_ref()?, &scene.drift).ok()?;
    let mechanism = AnyMechanism::of(&platform.mechanism, platform.crank_radius_m);
    let part = 0.3 + 0.69 * (seed % 97) as f64 / 97.0;
    let fastest_hz = f64::from(scene.control.tick_hz) / TICKS_PER_TURN;
    let level_hz = (part * limits.speed_hz).min(fastest_hz);
    let ramp_s = 2.0 * limits.speed_hz / limits.acceleration_hz_per_s
        + 4.0 * limits.acceleration_hz_per_s / limits.jerk_hz_per_s2
        + 1.0;
    let amax_mps2 = mechanism.amax_mps2(level_hz * TAU);
    scene.program.push(Segment {
        amax_g: Some(amax_mps2 / STANDARD_GRAVITY_MPS2),
        ramp_s: Some(0.5),
        hold_s: Some(ramp_s + TURNS / level_hz),
        shape: Some(Shape::Smooth),
        ..Segment::default()
    });
    let fits = |steps: &u32| {
        scene.axes.steps_per_turn = *steps;
        Checked::new(scene.clone()).is_ok()
    };
    STEPS.into_iter().find(fits)?;
    let fine = (0..scene.axes.count).all(|i| scene.steps_per_crank_turn(i) >= LEAST_STEPS);
    fine.then_some((scene, level_hz))
}

/// Runs a scene into a folder; `None` if it ends in a fault or is refused. Returns the summary.
fn run(scene: &Scene, folder: &Path) -> Option<String> {
    let path = folder.join("scene.toml");
    fs::write(&path, toml::to_string(scene).expect("a scene as text")).expect("a file");
    let (path, out) = (
        path.display().to_string(),
        folder.join("out").display().to_string(),
    );
    let arguments = ["cophase", "run", &path, "--every", "1", "--out", &out];
    let command = Command::try_parse_from(arguments).expect("arguments");
    let (mut printed, mut errors) = (Vec::new(), Vec::new());
    match command.carry_out(&mut printed, &mut errors) {
        Status::Done => Some(String::from_utf8(printed).expect("UTF-8")),
        Status::Fault | Status::BadInput => None,
    }
}

/// The two numbers of "at most A g, at V rev/s".
fn printed(summary: &str) -> Option<(f64, f64)> {
    let (_, rest) = summary.split_once("; at most ")?;
    let (amax_g, rest) = rest.split_once(" g, at ")?;
    let (speed_hz, _) = rest.split_once(" rev/s")?;
    Some((amax_g.parse().ok()?, speed_hz.parse().ok()?))
}

fn near(what: &str, stated: f64, found: f64, tolerance: f64) -> Result<(), String> {
    if (stated - found).abs() <= tolerance {
        return Ok(());
    }
    Err(format!(
        "{what}: {stated}, and the platform's own height gives {found} (± {tolerance:.3e})"
    ))
}

/// Compares what a run states with the motion of the platform.
fn judge(scene: &Scene, folder: &Path, summary: &str, level_hz: f64) -> Result<(), String> {
    let trace = fs::read_to_string(folder.join("out/trace.csv")).map_err(|e| e.to_string())?;
    let report = fs::read_to_string(folder.join("out/report.json")).map_err(|e| e.to_string())?;
    let report: Value = serde_json::from_str(&report).map_err(|e| e.to_string())?;
    let column = |name: &str| -> Result<Vec<f64>, String> {
        let place = trace
            .lines()
            .next()
            .and_then(|head| head.split(',').position(|it| it == name));
        let place = place.ok_or_else(|| format!("no column {name}"))?;
        let values = trace
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(place)?.parse().ok());
        values
            .collect::<Option<_>>()
            .ok_or_else(|| format!("{name} is no number"))
    };
    let (t_s, z_m) = (column("t_s")?, column("z_m")?);
    let whole = Height::new(&t_s, &z_m);
    // The level ends where the program does. The stop begins there.
    let end = trace
        .lines()
        .skip(1)
        .rposition_of(",run,")
        .ok_or("it never runs")?;
    let begin = t_s.partition_point(|t| *t < t_s[end] - WINDOW_TURNS / level_hz);
    let level = Height::new(&t_s[begin..=end], &z_m[begin..=end]);
    let found_hz = level
        .frequency_hz()
        .ok_or("the platform does not oscillate")?;
    let found_mps2 = level.amax_mps2(found_hz);
    let least = (0..scene.axes.count).map(|i| scene.steps_per_crank_turn(i));
    let least = least.fold(f64::INFINITY, f64::min);
    let amax_tolerance = (AMAX_TOLERANCE + 60.0 / least) * found_mps2;
    let speed_tolerance = SPEED_TOLERANCE * found_hz;

    let omega_hz = column("omega_rad_s")?[end] / TAU;
    near(
        "omega_rad_s of the trace, rev/s",
        omega_hz,
        found_hz,
        speed_tolerance,
    )?;
    let commanded = column("amax_commanded_mps2")?[end];
    near(
        "amax_commanded_mps2 of the trace",
        commanded,
        found_mps2,
        amax_tolerance,
    )?;
    let accelerations = column("accel_mps2")?;
    let largest = accelerations[begin..=end]
        .iter()
        .fold(0.0_f64, |most, a| most.max(a.abs()));
    // Between two rows the acceleration may be larger.
    near(
        "accel_mps2 of the trace",
        largest,
        found_mps2,
        amax_tolerance + 0.02 * found_mps2,
    )?;

    let number = |key: &str| {
        report[key]
            .as_f64()
            .ok_or_else(|| format!("{key} is no number"))
    };
    let (top_hz, top_mps2) = (number("speed_top_hz")?, number("amax_top_mps2")?);
    // Amplitude goes with the square of the speed. Levels before may be higher than the last.
    let scale = (top_hz / found_hz).powi(2);
    near(
        "amax_top_mps2 of the report",
        top_mps2,
        found_mps2 * scale,
        amax_tolerance * scale,
    )?;
    if top_hz < found_hz - speed_tolerance {
        return Err(format!(
            "speed_top_hz is {top_hz}, and the platform makes {found_hz} strokes a second"
        ));
    }
    let (amax_g, speed_hz) = printed(summary).ok_or("the summary has no amplitude")?;
    near("speed of the summary", speed_hz, top_hz, 0.005 + 1e-9)?;
    let amax_mps2 = amax_g * STANDARD_GRAVITY_MPS2;
    let rounding = 0.05 * STANDARD_GRAVITY_MPS2;
    near(
        "amplitude of the summary",
        amax_mps2,
        found_mps2 * scale,
        amax_tolerance * scale + rounding,
    )?;

    let limits = &scene.limits;
    if found_hz > limits.speed_hz + speed_tolerance {
        return Err(format!(
            "{found_hz} strokes a second, above limits.speed_hz = {}",
            limits.speed_hz
        ));
    }
    for band in &limits.band {
        let inside = band.from_hz + speed_tolerance..band.to_hz - speed_tolerance;
        if inside.contains(&found_hz) {
            return Err(format!(
                "it dwells at {found_hz} in the band from {} to {}",
                band.from_hz, band.to_hz
            ));
        }
    }
    for number in 0..scene.axes.count {
        let steps = report["axes"][number]["steps"].as_f64().ok_or("no steps")?;
        let own = scene.axis.iter().find(|own| own.number == number);
        let (motor, crank) = own.and_then(|own| own.gear).unwrap_or(scene.axes.gear);
        let per_turn = f64::from(scene.axes.steps_per_turn) * f64::from(motor) / f64::from(crank);
        near(
            &format!("turns of crank {number} by its steps"),
            steps / per_turn,
            whole.strokes(),
            1.6,
        )?;
    }
    Ok(())
}

/// Place of the last line with a text.
trait LastWith {
    fn rposition_of(self, text: &str) -> Option<usize>;
}

impl<'a, I: Iterator<Item = &'a str>> LastWith for I {
    fn rposition_of(self, text: &str) -> Option<usize> {
        let found = self.enumerate().filter(|(_, line)| line.contains(text));
        found.map(|(place, _)| place).last()
    }
}

fn number(variable: &str, default: u64) -> u64 {
    std::env::var(variable).map_or(default, |value| value.parse().expect("a whole number"))
}

/// If this fails, a figure is that of the motor, or of a shaft that the platform does not follow.
#[test]
fn every_printed_amplitude_speed_and_limit_is_the_cranks() {
    let count = number("COPHASE_CRANK_SCENES", FEW);
    let first = number("COPHASE_RANDOM_SEED", 0);
    let (mut judged, mut geared, mut wrong) = (0, 0, Vec::new());
    for seed in first..first + 40 * count {
        if judged == count {
            break;
        }
        let Some((scene, level_hz)) = scene(seed) else {
            continue;
        };
        let folder = tempfile::tempdir().expect("a folder");
        let Some(summary) = run(&scene, folder.path()) else {
            continue;
        };
        judged += 1;
        geared += u64::from(scene.axes.gear != (1, 1));
        if let Err(reason) = judge(&scene, folder.path(), &summary, level_hz) {
            let kept = folder.keep();
            wrong.push(format!("seed {seed}, kept in {}: {reason}", kept.display()));
        }
    }
    println!("{judged} scenes judged, {geared} with a gear");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(
        judged == count && geared * 5 >= count,
        "{judged} scenes, {geared} with a gear"
    );
}
