//! Conservation of energy by each method: the drift of the energy of a free, frictionless machine over 10,000 turns.
//!
//! The energy that a method conserves ripples around the true one within each turn, which is harmless; a drift is not. So the energy is
//! averaged over the first and the last hundredth of the run ([`Ends`]).

use std::f64::consts::TAU;
use std::fmt::Write;

use cophase_methods::Scheme;
use cophase_methods::drift::Ends;
use host_sim::dynamics::{Driven, Dynamics, Rigid};

use super::axis::Axis;
use super::methods::problems;
use super::picture::{Level, Line, Panel, Picture, render};
use super::{ChartError, Drawn, Progress, Size};

/// Largest relative drift that counts as conserved.
const KEPT: f64 = 1e-6;
/// Speed at the start, turns per second. It stays about the same.
const TURNS_PER_S: f64 = 10.0;
/// Numbers of steps per turn. With fewer, some methods lock into an orbit that the machine does not have.
const STEPS_A_TURN: [u32; 6] = [16, 32, 64, 128, 256, 512];
/// Relative loss or gain of energy at which a run ends: the machine is at rest, or has diverged, and further turns show nothing
/// more about the method.
const LOST: f64 = 0.5;
/// Range that is shown, from rounding errors upwards.
const SHOWN: (f64, f64) = (1e-14, 2.0);
/// Length of the run over that of the averaged parts.
const WINDOW: u32 = 100;

/// Makes the chart.
pub fn draw(size: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let turns = match size {
        Size::Small => 300,
        Size::Full => 10_000,
    };
    let shaft = Rigid::new(problems::body()?);
    let free = Driven::new(Box::new(shaft.clone()), problems::motors()?);
    let schemes = Scheme::ALL.into_iter().filter(|scheme| scheme.suits(&free));
    let of = schemes.clone().count() as u64;
    let mut csv = "method,default,steps_a_turn,turns,drift\n".to_owned();
    let mut lines = Vec::new();
    let (mut keep, mut lose) = (Vec::new(), Vec::new());
    for (done, scheme) in schemes.enumerate() {
        progress(done as u64, of);
        let is_default = scheme == problems::default_of(&free)?;
        let mut points = Vec::new();
        for steps in STEPS_A_TURN {
            let drift = drift(scheme, &free, &shaft, steps, turns)?;
            // Writing to a string cannot fail.
            let _ = writeln!(csv, "{scheme},{is_default},{steps},{turns},{drift:e}");
            points.push((f64::from(steps), drift));
        }
        // Conserved from some step on, and not at one step by chance.
        let after = points.iter().rposition(|(_, drift)| *drift >= KEPT);
        match points.get(after.map_or(0, |last| last + 1)) {
            Some((steps, _)) => keep.push(format!("{scheme} (from {steps} steps a turn)")),
            None => lose.push(scheme.to_string()),
        }
        lines.push(Line {
            chosen: is_default,
            ..Line::of_scheme(scheme, points)
        });
    }
    progress(of, of);
    let lost = match lose.as_slice() {
        [] => String::new(),
        _ => format!("; {} do not, at any step shown", lose.join(", ")),
    };
    let says = format!(
        "A shaft that nothing drives or brakes keeps its energy to {KEPT:e} over {turns} turns with {}{lost}.",
        keep.join(", "),
    );
    let panel = Panel {
        title: format!("one shaft with its platform, undamped, {turns} turns"),
        x: Axis::log("steps a turn", 14.0, 1000.0),
        y: Axis::log("change of the mean energy, relative", SHOWN.0, SHOWN.1),
        lines,
        levels: vec![
            Level::at_y(KEPT, "below: kept"),
            Level::at_y(LOST, "followed no further"),
        ],
    };
    let svg = render(Picture {
        title: "Energy: which methods keep it".to_owned(),
        says: says.clone(),
        columns: 1,
        chosen_is: "default",
        panels: vec![panel],
    });
    Ok(Drawn::one(csv, svg, says))
}

/// Returns the change of the mean energy over a number of turns, relative to the initial kinetic energy; infinite if a step failed.
fn drift(
    scheme: Scheme,
    free: &Driven,
    shaft: &Rigid,
    steps_a_turn: u32,
    turns: u32,
) -> Result<f64, ChartError> {
    let omega = TAU * TURNS_PER_S;
    let step_s = 1.0 / (TURNS_PER_S * f64::from(steps_a_turn));
    let mut method = scheme.prepare(free, step_s)?;
    let mut state = [0.0, omega];
    let kinetic_j = 0.5 * shaft.inertia_kgm2(0.0) * omega * omega;
    let start_j = shaft.energy_j(&state[..1], &state[1..2]);
    let steps = steps_a_turn * turns;
    let mut ends = Ends::new(steps, steps / WINDOW);
    for step in 0..steps {
        let energy_j = shaft.energy_j(&state[..1], &state[1..2]);
        let changed = (energy_j - start_j).abs() / kinetic_j;
        if changed > LOST {
            return Ok(changed);
        }
        ends.add(step, energy_j);
        // Angles are kept small, as only the angle within a turn matters.
        state[0] %= TAU;
        if method.step(free, 0.0, &mut state).is_err() {
            return Ok(f64::INFINITY);
        }
    }
    let (first, last) = ends.means();
    Ok((last - first).abs() / kinetic_j)
}
