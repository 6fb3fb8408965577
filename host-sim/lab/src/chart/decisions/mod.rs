//! Decisions of methods: the error of each method in a threshold, not in a trajectory, against the step.
//!
//! A stable method may still give a wrong outcome. Three machines have an outcome that changes at a *threshold* of one number, the
//! *drive*: a screen is captured by its resonance or passes it ([`resonance`]), a stepper pulls out ([`pull_out`]), and a follower
//! lifts off its cam ([`lift_off`]).
//!
//! The search for the threshold of a method with a step begins at the reference's threshold. The distance is 1e-10 of it at first, and
//! ten times as large each time, until the outcome changes. Bisection follows between the last two. This gives the error to a
//! thousandth of itself. There is no threshold if the outcome is the same between half and twice the reference, or if the method
//! diverges or does not converge.
//!
//! A library's solvers gave the reference thresholds. The tests compute them again.

mod decision;
mod lift_off;
mod pull_out;
#[cfg(test)]
mod reference;
mod resonance;

use std::fmt::Write;

use cophase_methods::Scheme;

use super::axis::Axis;
use super::picture::{Line, Panel, Picture, render};
use super::{ChartError, Drawn, Progress, Size};
use decision::{Decision, NoOutcome};
use lift_off::LiftOff;
use pull_out::PullsOut;
use resonance::Resonance;

/// Threshold of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Found {
    threshold: f64,
    /// Relative error, without sign.
    error: f64,
    /// Evaluations of the machine in a run at the threshold.
    evaluations: u64,
}

/// Least and greatest relative distance from the reference at which the outcome is computed.
const NEAREST: f64 = 1e-10;
const FARTHEST: f64 = 0.5;
/// Number of bisections, on a logarithmic scale, of the decade in which the outcome changes: to 0.06 % of the error.
const HALVINGS: u32 = 12;

/// Returns the threshold of a method with a step that is nearest to the reference's; `None` if there is none within half and twice it.
fn threshold(
    decision: &dyn Decision,
    scheme: Scheme,
    step_s: f64,
) -> Result<Option<Found>, NoOutcome> {
    let reference = decision.reference();
    let outcome = |drive: f64| decision.beyond(scheme, step_s, drive);
    // If the method is beyond its threshold at the reference's, its own threshold is lower.
    let (is_lower, _) = outcome(reference)?;
    let mut evaluations;
    // Downwards to half, upwards to twice.
    let at = |off: f64| {
        if is_lower {
            reference * (1.0 - off)
        } else {
            reference / (1.0 - off)
        }
    };
    let (mut same, mut other) = (NEAREST / 10.0, NEAREST);
    loop {
        let (beyond, evaluated) = outcome(at(other))?;
        evaluations = evaluated;
        if beyond != is_lower {
            break;
        }
        if other >= FARTHEST {
            return Ok(None);
        }
        same = other;
        other = (10.0 * other).min(FARTHEST);
    }
    for _ in 0..HALVINGS {
        let middle = (same * other).sqrt();
        let (beyond, evaluated) = outcome(at(middle))?;
        evaluations = evaluated;
        if beyond == is_lower {
            same = middle;
        } else {
            other = middle;
        }
    }
    let threshold = at(other);
    Ok(Some(Found {
        threshold,
        error: (threshold / reference - 1.0).abs(),
        evaluations,
    }))
}

/// Returns the decisions of the chart.
fn decisions() -> [Box<dyn Decision>; 3] {
    [
        Box::new(Resonance),
        Box::new(PullsOut::new()),
        Box::new(LiftOff),
    ]
}

/// Makes the chart. It takes seconds at any size.
pub fn draw(_: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let mut csv =
        "scene,method,step_s,step_times_frequency,threshold,error,evaluations\n".to_owned();
    let mut panels = Vec::new();
    let mut worst: Vec<Worst> = Vec::new();
    let decisions = decisions();
    let of = decisions.len() as u64;
    for (done, decision) in (0..).zip(decisions) {
        progress(done, of);
        let (panel, scene_worst) = measure(decision.as_ref(), &mut csv);
        panels.push(panel);
        worst.push(scene_worst);
    }
    let says = says(&worst);
    let svg = render(Picture {
        title: "Decisions: error of the threshold at which the outcome turns over".to_owned(),
        says: says.clone(),
        columns: 3,
        chosen_is: "default",
        panels,
    });
    Ok(Drawn::one(csv, svg, says))
}

/// Summary of a scene.
#[derive(Clone, Copy, Debug)]
struct Worst {
    name: &'static str,
    /// Largest error, with its sign, of a method that no step makes unstable, and its step × frequency.
    stable: (Scheme, f64, f64),
    /// Largest error of RK4 up to half a radian a step, where it is stable.
    rk4: f64,
}

/// Largest step of RK4 that counts as fine, rad.
const FINE_RAD: f64 = 0.5;

fn measure(decision: &dyn Decision, csv: &mut String) -> (Panel, Worst) {
    let mut lines = Vec::new();
    let steps_s = decision.steps_s();
    let omega = decision.omega_rad_s();
    let mut worst = Worst {
        name: decision.name(),
        stable: (Scheme::Exact, 0.0, 0.0),
        rk4: 0.0,
    };
    for scheme in Scheme::ALL {
        let mut points = Vec::new();
        for &step_s in &steps_s {
            let found = match threshold(decision, scheme, step_s) {
                Err(NoOutcome::Unsuited) => break,
                Err(NoOutcome::Broke) => None,
                Ok(found) => found,
            };
            let h_omega = step_s * omega;
            let result = found.map_or_else(
                || "none,inf,".to_owned(),
                |found| {
                    format!(
                        "{:.12},{:.3e},{}",
                        found.threshold, found.error, found.evaluations
                    )
                },
            );
            // Writing to a string cannot fail.
            let _ = writeln!(
                csv,
                "\"{}\",{},{step_s:.6e},{h_omega:.4},{result}",
                decision.name(),
                scheme.facts().name
            );
            let Some(found) = found else { continue };
            points.push((h_omega, found.error));
            if scheme.stability_limit(0.0).is_none() && found.error > worst.stable.2.abs() {
                let error = found.threshold / decision.reference() - 1.0;
                worst.stable = (scheme, h_omega, error);
            }
            if scheme == Scheme::Rk4 && h_omega <= FINE_RAD {
                worst.rk4 = worst.rk4.max(found.error);
            }
        }
        if !points.is_empty() {
            lines.push(Line::of_scheme(scheme, points));
        }
    }
    let span = |bound: fn(f64, f64) -> f64, from: f64| steps_s.iter().copied().fold(from, bound);
    let panel = Panel {
        title: decision.title().to_owned(),
        x: Axis::log(
            "step × frequency, rad",
            span(f64::min, f64::INFINITY) * omega / 1.5,
            span(f64::max, 0.0) * omega * 1.5,
        ),
        // Errors below that of the reference are not shown.
        y: Axis::log(
            "error of the threshold, relative",
            10.0 * decision.uncertainty(),
            1.0,
        ),
        lines,
        levels: Vec::new(),
    };
    (panel, worst)
}

fn says(worst: &[Worst]) -> String {
    let parts: Vec<String> = worst
        .iter()
        .map(|worst| {
            let (scheme, h_omega, error) = worst.stable;
            format!(
                "In {}, {scheme} at {h_omega:.1} rad a step has the threshold {:.0} % too {}, and RK4 up to {FINE_RAD} rad within {:.0e}.",
                worst.name,
                error.abs() * 100.0,
                if error < 0.0 { "low" } else { "high" },
                worst.rk4
            )
        })
        .collect();
    format!(
        "A method can be stable and wrong about what happens. These are farthest off of the methods that are stable at any step. {} RK4 is \
         stable up to there. Without a point there is no threshold between half and twice the right one, or no outcome.",
        parts.join(" ")
    )
}
