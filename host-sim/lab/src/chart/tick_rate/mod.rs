//! Benefit of a faster control tick, and its cost on the board.
//!
//! Scenes are run at every rate. The *played* motion is measured: the amplitude of the shaft's speed, compared with the program at
//! the same time since the deadline of the start command. So the lag of the loop counts, too: a tick is planned at one deadline and
//! played from the next.
//!
//! The cost of a rate follows from the emulated cycles of a tick (`docs/emulated.csv`).

mod ramp;

use std::fmt::Write;

use cophase_link::board::{Board, Rp2040};
use cophase_scene::library;
use host_sim::checked::Checked;
use host_sim::sim::simulate;

use super::axis::Axis;
use super::ink::{Ink, Stroke};
use super::picture::{Level, Line, Panel, Picture, render};
use super::{ChartError, Drawn, Progress, Size};
use ramp::{ProgramLevels, Ramp};

/// Rates of the loop, whose ticks are whole microseconds.
const RATES_HZ: [u32; 10] = [500, 800, 1000, 1600, 2000, 2500, 4000, 5000, 8000, 10_000];
/// Default rate of a scene.
const DEFAULT_HZ: u32 = 2000;
/// Scenes with steppers and servos at their commanded phases; and one in which torque moves the cranks, as otherwise no crank is out
/// of phase.
const SCENES: [(&str, Ink); 3] = [
    ("default", Ink::Blue),
    ("patent-3", Ink::Vermilion),
    ("stiff-bearing", Ink::Black),
];
const EMULATED: &str = include_str!("../../../../../docs/emulated.csv");

/// Results of a scene at a rate.
struct Run {
    tick_hz: u32,
    /// Largest relative error of a held amplitude.
    hold: f64,
    /// Root mean square error on ramps, relative to the highest level.
    ramp: f64,
    /// Largest difference between two cranks' errors of phase, degrees.
    spread_deg: f64,
}

/// Makes the chart.
pub fn draw(size: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let rates: Vec<u32> = match size {
        Size::Small => RATES_HZ.into_iter().step_by(4).collect(),
        Size::Full => RATES_HZ.to_vec(),
    };
    let of = (rates.len() * SCENES.len()) as u64;
    let mut done = 0;
    let mut csv =
        "scene,tick_hz,default,hold_error,ramp_error,spread_deg,cpu_mean,cpu_worst\n".to_owned();
    let cycles = [Cycles::read("mean")?, Cycles::read("worst")?];
    let mut runs = Vec::new();
    for (name, _) in SCENES {
        let mut of_scene = Vec::new();
        for &tick_hz in &rates {
            let run = play(name, tick_hz)?;
            // Writing to a string cannot fail.
            let _ = writeln!(
                csv,
                "{name},{tick_hz},{},{:e},{:e},{:.6},{:.4},{:.4}",
                tick_hz == DEFAULT_HZ,
                run.hold,
                run.ramp,
                run.spread_deg,
                cycles[0].share(tick_hz),
                cycles[1].share(tick_hz),
            );
            of_scene.push(run);
            done += 1;
            progress(done, of);
        }
        runs.push(of_scene);
    }
    let says = says(&runs, &cycles);
    let svg = render(Picture {
        title: "Tick rate: benefit and cost".to_owned(),
        says: says.clone(),
        columns: 2,
        chosen_is: "default",
        panels: panels(&runs, &cycles, &rates),
    });
    Ok(Drawn::one(csv, svg, says))
}

/// Runs a built-in scene at another rate than its own.
fn play(name: &str, tick_hz: u32) -> Result<Run, ChartError> {
    let failed =
        |error: &dyn std::fmt::Display| ChartError(format!("{name} at {tick_hz} Hz: {error}"));
    let at_rate = |tick_hz| {
        let built_in = library::find(name).ok_or_else(|| failed(&"there is no such scene"))?;
        let mut scene = built_in.scene();
        scene.control.tick_hz = tick_hz;
        Checked::new(scene).map_err(|error| failed(&error))
    };
    let levels = ProgramLevels::for_scene(&at_rate(ProgramLevels::TICK_HZ)?)
        .map_err(|error| failed(&error))?;
    let checked = at_rate(tick_hz)?;
    let mut ramp = Ramp::new(&checked, levels);
    let outcome = simulate(&checked, &mut ramp, |_, _| {}).map_err(|error| failed(&error))?;
    if let Some(fault) = outcome.fault {
        return Err(failed(&format!("ended in a fault, {}", fault.kind)));
    }
    let figures = &outcome.record.figures;
    Ok(Run {
        tick_hz,
        hold: figures.holding.unwrap_or_default().worst_relative_error,
        ramp: ramp.rms(),
        spread_deg: figures.phase_spread_worst_deg.unwrap_or(0.0),
    })
}

/// Cycles of a tick of four axes on the board.
struct Cycles(f64);

impl Cycles {
    fn read(which: &str) -> Result<Self, ChartError> {
        let figure = format!("tick of 4 axes, {which}, cycles");
        let missing = || ChartError(format!("docs/emulated.csv has no \"{figure}\""));
        csv::Reader::from_reader(EMULATED.as_bytes())
            .records()
            .filter_map(Result::ok)
            .find(|record| record.get(0) == Some(&figure))
            .and_then(|record| record.get(1)?.parse().ok())
            .map(Self)
            .ok_or_else(missing)
    }

    /// Returns the part of the processor's time at a rate.
    fn share(&self, tick_hz: u32) -> f64 {
        self.0 * f64::from(tick_hz) / f64::from(Rp2040::CLOCK_HZ)
    }
}

fn panels(runs: &[Vec<Run>], cycles: &[Cycles; 2], rates: &[u32]) -> Vec<Panel> {
    let panel = |title: &str, y: Axis, lines: Vec<Line>| Panel {
        title: title.to_owned(),
        x: Axis::log("control ticks a second, Hz", 450.0, 11_000.0),
        y,
        lines,
        levels: vec![Level::at_x(f64::from(DEFAULT_HZ), "default")],
    };
    let lines = |of: fn(&Run) -> f64| {
        let line = |((name, ink), runs): (&(&str, Ink), &Vec<Run>)| {
            let points = runs.iter().map(|run| (f64::from(run.tick_hz), of(run)));
            Line::new(format!("scene {name}"), *ink, points.collect())
        };
        SCENES.iter().zip(runs).map(line).collect()
    };
    let share = |cycles: &Cycles| {
        let points = rates
            .iter()
            .map(|&hz| (f64::from(hz), 100.0 * cycles.share(hz)));
        points.collect()
    };
    let cost = vec![
        Line::new("processor, mean tick", Ink::Green, share(&cycles[0])),
        Line {
            stroke: Stroke::Dashed,
            ..Line::new("processor, worst tick", Ink::Purple, share(&cycles[1]))
        },
    ];
    let max_deg = runs.iter().flatten().map(|run| run.spread_deg);
    let max_deg = max_deg.fold(0.01, f64::max);
    vec![
        panel(
            "held amplitude, worst error",
            Axis::log("of the amplitude", 1e-11, 1e-7),
            lines(|run| run.hold),
        ),
        panel(
            "ramps, rms error of what is played",
            Axis::log("of the highest amplitude", 5e-6, 2e-3),
            lines(|run| run.ramp),
        ),
        panel(
            "cranks out of phase, worst (0 where they are as commanded)",
            Axis::linear("spread, deg", 0.0, 1.3 * max_deg),
            lines(|run| run.spread_deg),
        ),
        panel(
            "cost on the board, 4 axes at 125 MHz",
            Axis::log("share of the processor, %", 1.0, 200.0),
            cost,
        ),
    ]
}

fn says(runs: &[Vec<Run>], cycles: &[Cycles; 2]) -> String {
    let ramp_at = |tick_hz| {
        let of_rate = runs.iter().flatten().filter(|run| run.tick_hz == tick_hz);
        100.0 * of_rate.map(|run| run.ramp).fold(0.0, f64::max)
    };
    let hold = runs
        .iter()
        .flatten()
        .map(|run| run.hold)
        .fold(0.0, f64::max);
    let share = |which: usize, hz| 100.0 * cycles[which].share(hz);
    format!(
        "Only ramps gain by a faster tick: at 500 Hz they are off by {:.3} % (rms, of the highest amplitude), at {DEFAULT_HZ} Hz by \
         {:.3} %, at 10 kHz by {:.3} %; a held amplitude is right to {hold:.0e} at any rate. The default takes {:.0} % of the \
         processor; at 10 kHz the mean tick takes {:.0} %, the worst {:.0} %.",
        ramp_at(500),
        ramp_at(DEFAULT_HZ),
        ramp_at(10_000),
        share(0, DEFAULT_HZ),
        share(0, 10_000),
        share(1, 10_000),
    )
}
