//! Error against cost of each method: on this project's machines, and on problems whose answers are published.
//!
//! - [`problems`]: the problems, and the accuracy of their solutions;
//! - [`measure`]: cost and error for a series of step lengths;
//! - [`of_scene`]: the chart of a user's scene.

mod counted;
pub mod measure;
pub mod of_scene;
pub mod problems;

pub use counted::Counted;

use std::fmt::Write;

use cophase_methods::Scheme;

use super::axis::Axis;
use super::picture::{Level, Line, Panel, Picture, render};
use super::yardstick::Yardstick;
use super::{ChartError, Drawn, Progress, Size};
use measure::Curve;
use problems::Problem;

/// Smallest error that is shown, relative to the required error.
const MIN: f64 = 1e-5;
/// Largest error that is shown, relative to the required error.
const MAX: f64 = 1e4;
/// Ratio of the smallest error shown to the difference of two references, at least.
const UNCERTAINTY_MARGIN: f64 = 10.0;

impl Problem {
    /// Returns the smallest and the largest error that is shown.
    pub fn shown(&self) -> (f64, f64) {
        (
            (UNCERTAINTY_MARGIN * self.uncertainty).max(MIN * self.required_error),
            MAX * self.required_error,
        )
    }
}

/// Makes the chart.
pub fn draw(size: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let problems = problems::all()?;
    let of = (problems.len() * Scheme::ALL.len()) as u64;
    let mut done = 0;
    let mut csv =
        "problem,method,default,steps,evaluations,error,unit,reference_uncertainty,timing\n"
            .to_owned();
    let mut panels = Vec::new();
    let mut cheapest = Cheapest::default();
    for problem in &problems {
        let yardstick = Yardstick::measure();
        let mut curves = Vec::new();
        for scheme in Scheme::ALL {
            if scheme.suits(problem.equations[0].as_ref()) {
                let curve = Curve::measure(problem, scheme, size, yardstick)?;
                write_rows(&mut csv, problem, &curve);
                curves.push(curve);
            }
            done += 1;
            progress(done, of);
        }
        cheapest.inspect(problem, &curves);
        panels.push(panel(
            problem,
            &curves,
            problem.shown(),
            [
                "evaluations of the machine",
                "largest error at the end",
                "good enough",
            ],
        ));
    }
    let says = cheapest.says();
    let svg = render(Picture {
        title: "Methods: error against cost".to_owned(),
        says: says.clone(),
        columns: 3,
        chosen_is: "default",
        panels,
    });
    Ok(Drawn::one(csv, svg, says))
}

fn write_rows(csv: &mut String, problem: &Problem, curve: &Curve) {
    for run in &curve.runs {
        // Writing to a string cannot fail.
        let _ = writeln!(
            csv,
            "\"{}\",{},{},{},{},{:e},{},{:e},{:.2}",
            problem.name,
            curve.scheme.facts().name,
            problem.default == Some(curve.scheme),
            run.steps,
            run.evaluations,
            run.error,
            problem.unit,
            problem.uncertainty,
            run.sines_an_evaluation,
        );
    }
}

/// Makes the panel of a problem with a range of errors, and the labels of cost, error, and required error.
fn panel(
    problem: &Problem,
    curves: &[Curve],
    (from, to): (f64, f64),
    [cost, error, required]: [&str; 3],
) -> Panel {
    let costs = curves.iter().flat_map(|curve| &curve.runs);
    let costs = costs.filter(|run| (from..=to).contains(&run.error));
    let costs = costs.map(|run| run.evaluations as f64);
    let (min, max) = costs.fold((f64::INFINITY, 0.0_f64), |(min, max), cost| {
        (min.min(cost), max.max(cost))
    });
    // If all methods failed, the panel has axes without curves.
    let costs = if min < max {
        (0.7 * min, 1.4 * max)
    } else {
        (1.0, 10.0)
    };
    let line = |curve: &Curve| Line {
        chosen: problem.default == Some(curve.scheme),
        ..Line::of_scheme(curve.scheme, curve.points())
    };
    Panel {
        title: problem.name.to_owned(),
        x: Axis::log(cost, costs.0, costs.1),
        y: Axis::log(format!("{error}, {}", problem.unit), from, to),
        lines: curves.iter().map(line).collect(),
        levels: vec![Level::at_y(problem.required_error, required)],
    }
}

/// Cheapest method for the required error of each problem.
#[derive(Default)]
struct Cheapest {
    /// Cheapest methods, each with its problems.
    of: Vec<(Scheme, Vec<&'static str>)>,
    /// Largest ratio of the default method's cost to that of the cheapest.
    default_at_worst: f64,
}

impl Cheapest {
    fn inspect(&mut self, problem: &Problem, curves: &[Curve]) {
        let cost = |curve: &Curve| curve.cost_of(problem.required_error);
        let costs = curves
            .iter()
            .filter_map(|curve| Some((curve.scheme, cost(curve)?)));
        let Some((best, min)) = costs.clone().min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return;
        };
        match self.of.iter_mut().find(|(scheme, _)| *scheme == best) {
            Some((_, wins)) => wins.push(problem.name),
            None => self.of.push((best, vec![problem.name])),
        }
        for (scheme, cost) in costs {
            if problem.default == Some(scheme) {
                self.default_at_worst = self.default_at_worst.max(cost / min);
            }
        }
    }

    fn says(&self) -> String {
        let of: Vec<_> = self
            .of
            .iter()
            .map(|(scheme, wins)| format!("{scheme} ({})", wins.join("; ")))
            .collect();
        let default = if self.default_at_worst < 1.05 {
            "is the cheapest there".to_owned()
        } else {
            format!(
                "costs up to {:.1} times the cheapest",
                self.default_at_worst
            )
        };
        format!(
            "The cheapest to an error that is good enough: {}. What a scene takes unless it says otherwise {default}. What diverged \
             has a row in the data and no point here.",
            of.join(", "),
        )
    }
}
