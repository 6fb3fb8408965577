//! Error against cost, on problems whose answers are published or a formula.

use std::fmt::Write;

use cophase_methods::problems::{Andrews, Hires, Oscillator};
use cophase_methods::{Equations, Scheme, advance};

use super::axis::Axis;
use super::counted::Counted;
use super::picture::{Line, Panel, Picture, render};
use super::{ChartError, Drawn, Progress, Size};

/// A problem with its answer.
struct Problem {
    name: &'static str,
    equations: Box<dyn Equations>,
    start: Vec<f64>,
    end_s: f64,
    /// What the first components are at the end.
    answer: Vec<f64>,
    /// Steps to the end: the fewest, and how often they are doubled.
    steps: (u32, u32),
    /// What is shown of cost and error. Errors end where the answer itself is no longer known well enough: what is
    /// published of the squeezing mechanism differs from all good methods alike by 1.5e-9.
    x: (f64, f64),
    y: (f64, f64),
}

fn problems() -> Vec<Problem> {
    let oscillator = Oscillator {
        omega_rad_s: 100.0,
        zeta: 0.05,
        force: 1.0,
        drive_rad_s: 30.0,
    };
    let mut andrews = Andrews::START.to_vec();
    andrews.resize(2 * Andrews::START.len(), 0.0);
    vec![
        Problem {
            name: "driven oscillator, linear",
            start: vec![1e-3, 0.0],
            answer: oscillator.exact(1.0, [1e-3, 0.0])[..1].to_vec(),
            equations: Box::new(oscillator),
            end_s: 1.0,
            steps: (64, 10),
            x: (50.0, 1e6),
            y: (1e-10, 1.0),
        },
        Problem {
            name: "Andrews’ squeezing mechanism",
            equations: Box::new(Andrews),
            start: andrews,
            end_s: Andrews::END_S,
            answer: Andrews::PUBLISHED.to_vec(),
            steps: (256, 9),
            x: (200.0, 1e6),
            y: (1e-8, 10.0),
        },
        Problem {
            name: "HIRES, stiff",
            equations: Box::new(Hires),
            start: Hires::START.to_vec(),
            end_s: Hires::END,
            answer: Hires::PUBLISHED.to_vec(),
            steps: (128, 11),
            x: (1000.0, 1e7),
            y: (1e-10, 1e-2),
        },
    ]
}

/// Makes the chart.
pub fn draw(_: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let mut csv = "problem,method,steps,evaluations,error\n".to_owned();
    let mut panels = Vec::new();
    let problems = problems();
    let of = (problems.len() * Scheme::ALL.len()) as u64;
    let mut done = 0;
    for problem in problems {
        let mut lines = Vec::new();
        for scheme in Scheme::ALL {
            let points = measure(&problem, scheme, &mut csv);
            if !points.is_empty() {
                lines.push(Line::of_scheme(scheme, points));
            }
            done += 1;
            progress(done, of);
        }
        panels.push(Panel {
            title: problem.name.to_owned(),
            x: Axis::log("evaluations of the machine", problem.x.0, problem.x.1),
            y: Axis::log(
                "largest error, in the unit of the answer",
                problem.y.0,
                problem.y.1,
            ),
            lines,
            levels: Vec::new(),
        });
    }
    let says = "Where the step resolves the fastest mode RK4 is the cheapest for any accuracy worth having. On the stiff problem \
               explicit methods diverge until the step is far shorter than accuracy asks for; there SDIRK4 is \
               the cheapest below errors of some 1e-4, and implicit midpoint above. On the linear machine exact discretisation errs \
               by its input alone. What diverged or did not converge has a row in the data and no point.";
    let svg = render(Picture {
        title: "Methods: error against cost".to_owned(),
        says: says.to_owned(),
        columns: 3,
        chosen_is: "default",
        panels,
    });
    Ok(Drawn {
        csv,
        svg,
        says: says.to_owned(),
    })
}

/// Cost and error at each number of steps that leads to an end; a row each.
fn measure(problem: &Problem, scheme: Scheme, csv: &mut String) -> Vec<(f64, f64)> {
    let (fewest, doublings) = problem.steps;
    let mut points = Vec::new();
    for doubling in 0..=doublings {
        let steps = fewest << doubling;
        let counted = Counted::new(problem.equations.as_ref());
        let Ok(mut method) = scheme.prepare(&counted, problem.end_s / f64::from(steps)) else {
            return points; // not for this machine
        };
        let mut y = problem.start.clone();
        let done = advance(method.as_mut(), &counted, 0.0, steps, &mut y);
        let error = match done {
            Ok(()) => {
                let off = y
                    .iter()
                    .zip(&problem.answer)
                    .map(|(y, right)| (y - right).abs());
                off.fold(0.0, f64::max)
            }
            Err(_) => f64::INFINITY, // it diverged: the row says so, and no point is drawn
        };
        // Writing to a string does not fail.
        let _ = writeln!(
            csv,
            "\"{}\",{},{steps},{},{error:e}",
            problem.name,
            scheme.facts().name,
            counted.asked()
        );
        if error.is_finite() {
            points.push((counted.asked() as f64, error));
        }
    }
    points
}
