//! Cost and error of a method on a problem, for a series of step lengths.

use std::time::{Duration, Instant};

use cophase_methods::{Scheme, StepError, advance};

use super::counted::Counted;
use super::problems::Problem;
use crate::chart::yardstick::Yardstick;
use crate::chart::{ChartError, Size};

/// Solution of a problem with one step length.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Number of steps in each part of the problem.
    pub steps: u32,
    /// Number of evaluations of the machine.
    pub evaluations: u64,
    /// Largest error of the compared components; infinite if it diverged or did not converge.
    pub error: f64,
    /// Duration of an evaluation with the method's own work, in sines.
    pub sines_an_evaluation: f64,
}

/// Results of a method on a problem, from the longest step to the shortest.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Method.
    pub scheme: Scheme,
    /// Solutions with increasing numbers of steps.
    pub runs: Vec<Run>,
}

/// Fewest step lengths of a curve.
const MIN: usize = 6;
/// Most step lengths of a curve in a small chart.
const SMALL: usize = 7;

impl Curve {
    /// Halves the step until further points would be outside the chart, with at least `MIN` lengths.
    pub fn measure(
        problem: &Problem,
        scheme: Scheme,
        size: Size,
        yardstick: Yardstick,
    ) -> Result<Self, ChartError> {
        let (min, doublings) = problem.steps;
        let mut runs: Vec<Run> = Vec::new();
        for doubling in 0..=doublings {
            // One error below the range may be a zero crossing of the curve. Two errors below the range are its end.
            let unresolved = |run: &Run| run.error < problem.shown().0;
            let is_over = runs.len() >= 2 && runs[runs.len() - 2..].iter().all(unresolved);
            if runs.len() >= MIN && is_over || size == Size::Small && runs.len() >= SMALL {
                break;
            }
            runs.push(problem.run(scheme, min << doubling, yardstick)?);
        }
        Ok(Self { scheme, runs })
    }

    /// Returns cost and error, as drawn.
    pub fn points(&self) -> Vec<(f64, f64)> {
        let points = self.runs.iter().filter(|run| run.error.is_finite());
        points
            .map(|run| (run.evaluations as f64, run.error))
            .collect()
    }

    /// Returns the number of evaluations from which on the error is at most this, by a straight line between two step lengths on
    /// logarithmic axes; `None` if there is none.
    pub fn cost_of(&self, error: f64) -> Option<f64> {
        let below = self.runs.iter().rposition(|run| run.error > error);
        let first = self.runs.get(below.map_or(0, |last| last + 1))?;
        let cost = first.evaluations as f64;
        let before = below
            .map(|last| self.runs[last])
            .filter(|run| run.error.is_finite());
        let Some(before) = before else {
            return Some(cost);
        };
        let part = (before.error / error).ln() / (before.error / first.error).ln();
        let dearer = cost / before.evaluations as f64;
        Some(before.evaluations as f64 * dearer.powf(part.clamp(0.0, 1.0)))
    }
}

impl Problem {
    /// Solves the problem with `steps` steps in each of its parts. `each` receives the state at the end of each part.
    fn solve(
        &self,
        scheme: Scheme,
        steps: u32,
        mut each: impl FnMut(&[f64]),
    ) -> Result<Solved, ChartError> {
        let parts: Vec<_> = (self.equations.iter())
            .map(|equations| Counted::new(equations.as_ref()))
            .collect();
        let part_s = self.end_s / parts.len() as f64;
        let mut method = scheme
            .prepare(&parts[0], part_s / f64::from(steps))
            .map_err(|refused| ChartError(format!("{}: {refused}", self.name)))?;
        let mut y = self.start.clone();
        let began = Instant::now();
        let done = parts.iter().try_for_each(|part| {
            advance(method.as_mut(), part, 0.0, steps, &mut y)?;
            each(&y);
            Ok::<_, StepError>(())
        });
        Ok(Solved {
            is_done: done.is_ok(),
            evaluations: parts.iter().map(Counted::evaluations).sum(),
            took: began.elapsed(),
        })
    }

    /// Solves the problem, and compares the states at the ends of its parts with the answer.
    pub fn run(&self, scheme: Scheme, steps: u32, yardstick: Yardstick) -> Result<Run, ChartError> {
        let mut answers = self.answer.chunks(self.answer.len() / self.equations.len());
        let mut error = 0.0;
        let solved = self.solve(scheme, steps, |y| {
            let answer = answers.next().unwrap_or_default();
            let off = y.iter().zip(answer).map(|(y, a)| (y - a).abs());
            error = off.fold(error, f64::max);
        })?;
        Ok(Run {
            steps,
            evaluations: solved.evaluations,
            error: if solved.is_done { error } else { f64::INFINITY },
            sines_an_evaluation: yardstick.sines(solved.took) / solved.evaluations.max(1) as f64,
        })
    }

    /// Returns the first `compared` components of the state at the end of each part, as a method computes them; `None` if it diverges.
    pub fn trajectory(
        &self,
        scheme: Scheme,
        steps: u32,
        compared: usize,
    ) -> Result<Option<Vec<f64>>, ChartError> {
        let mut states = Vec::new();
        let solved = self.solve(scheme, steps, |y| states.extend_from_slice(&y[..compared]))?;
        Ok(solved.is_done.then_some(states))
    }
}

/// Effort of a solution.
struct Solved {
    is_done: bool,
    evaluations: u64,
    took: Duration,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the text under the chart names another method than the picture shows.
    #[test]
    fn costs_are_interpolated_between_points() {
        let run = |evaluations, error| Run {
            steps: 1,
            evaluations,
            error,
            sines_an_evaluation: 1.0,
        };
        let runs = vec![
            run(50, f64::INFINITY),
            run(100, 1e-2),
            run(200, 1e-4),
            run(400, 1e-6),
        ];
        let curve = Curve {
            scheme: Scheme::Rk4,
            runs,
        };
        assert!((curve.cost_of(1e-3).unwrap() - 100.0 * 2.0_f64.sqrt()).abs() < 1e-9);
        assert_eq!(curve.cost_of(1e-6), Some(400.0));
        assert_eq!(curve.cost_of(1.0), Some(100.0));
        assert_eq!(curve.cost_of(1e-7), None);
    }
}
