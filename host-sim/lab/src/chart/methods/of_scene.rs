//! Error against cost of each method on the equations of a user's scene.
//!
//! The sample of the scene is run once, without its faults. The commands of the turn around its top speed are recorded, and each method
//! then integrates the scene's equations under these commands. So a method is not judged by what the controller decides on its account.

use std::collections::VecDeque;
use std::fmt::Write;

use cophase_methods::problems::Chain;
use cophase_methods::{Equations, Scheme};
use cophase_scene::SceneError;
use host_sim::checked::Checked;
use host_sim::fidelity::sample;
use host_sim::model_level::STEP_PART;
use host_sim::output::Output;
use host_sim::sim::{Moment, Observer, simulate};

use super::measure::{Curve, Run};
use super::problems::Problem;
use super::{UNCERTAINTY_MARGIN, panel};
use crate::chart::ink::{Ink, Stroke};
use crate::chart::integrated::{Integrated, chain_of};
use crate::chart::picture::{Level, Line, Picture, render};
use crate::chart::yardstick::Yardstick;
use crate::chart::{ChartError, Drawn, Progress, Size};

/// Ticks of the recorded part, at least and at most.
const TICKS: (f64, f64) = (40.0, 400.0);
/// Ratio of the scene's own step to the longest and to the shortest one, as powers of two.
const LONGER: u32 = 3;
const SHORTER: u32 = 5;
/// Steps in a tick that suffice for the shortest step, unless the scene itself makes about as many.
const SUFFICIENT: u32 = 512;
/// Number of steps of a reference, unless fewer than the least number of ticks are left.
const MAX_REFERENCE_STEPS: u32 = 500_000;
/// Number of the references' steps to that of the finest measured steps.
const FINER: u32 = 4;
/// Methods that may compute the reference: the first gives the answer, and the second its uncertainty, with steps of another length. A method
/// that diverges is left out.
const REFERENCES: [Scheme; 3] = [Scheme::Rk4, Scheme::Sdirk4, Scheme::ImplicitMidpoint];

/// Makes the chart of a scene.
pub fn draw(checked: &Checked, size: Size, progress: Progress) -> Result<Drawn, SceneError> {
    let scene = Integrated::new(checked)?;
    let schemes: Vec<_> = scene.schemes().collect();
    let of = schemes.len() as u64 + 1;
    let wrong = |error: ChartError| SceneError::for_key("method", error.to_string());
    let mut problem = problem(&scene)?;
    let references = solve(&scene, &mut problem).map_err(wrong)?;
    progress(1, of);
    let yardstick = Yardstick::measure();
    let window_s = problem.end_s;
    let a_second = |run: Run| Run {
        evaluations: (run.evaluations as f64 / window_s).round() as u64,
        ..run
    };
    let own = problem.run(scene.scheme, scene.steps, yardstick);
    let own = own.map(a_second).map_err(wrong)?;
    let resolved = UNCERTAINTY_MARGIN * problem.uncertainty;
    if !own.error.is_finite() {
        return Err(SceneError::for_key(
            "method",
            format!(
                "{} diverges with {} steps a tick at the top speed of the scene; give more steps, or leave method out",
                scene.scheme, scene.steps
            ),
        ));
    }
    let own_error = own.error.max(resolved);
    let target = Target::new(&scene, own_error, own.error >= resolved);
    problem.required_error = target.error;
    let mut curves = Vec::new();
    for (done, &scheme) in schemes.iter().enumerate() {
        let mut curve = Curve::measure(&problem, scheme, size, yardstick).map_err(wrong)?;
        curve.runs = curve.runs.into_iter().map(a_second).collect();
        curves.push(curve);
        progress(done as u64 + 2, of);
    }
    let says = says(&scene, &problem, &own, &curves, (&target, references));
    let mut panel = panel(
        &problem,
        &curves,
        range(&curves, resolved, own_error.max(target.error)),
        [
            "evaluations in a simulated second",
            "largest error",
            target.label,
        ],
    );
    for line in &mut panel.lines {
        line.points.retain(|(_, error)| *error >= resolved);
    }
    panel.lines.push(Line {
        stroke: Stroke::None,
        names: vec![steps_a_tick(scene.steps)],
        ..Line::new(
            "the scene’s step",
            Ink::Black,
            vec![(own.evaluations as f64, own_error)],
        )
    });
    panel.levels.push(Level::at_y(resolved, "10 × uncertainty"));
    let svg = render(Picture {
        title: format!(
            "{}: error of each method against its cost",
            checked.scene.name
        ),
        says: says.clone(),
        columns: 1,
        chosen_is: "taken by the scene",
        panels: vec![panel],
    });
    Ok(Drawn::one(csv(&scene, &problem, &own, &curves), svg, says))
}

/// Error up to which methods are compared.
struct Target {
    error: f64,
    label: &'static str,
    /// Its meaning, within a sentence.
    words: String,
}

impl Target {
    /// Returns the part of the tightest tolerance of the shafts' angles that a run allows the step, or the scene's own error if that is
    /// larger, or if the scene has no such tolerance. An error that the reference does not resolve is only known to be smaller.
    fn new(scene: &Integrated, own_error: f64, is_resolved: bool) -> Self {
        let questions = scene.checked.scene.questions;
        let tolerances = [Output::Lag, Output::Spread].map(|output| output.tolerance(&questions));
        let tightest_deg = tolerances.into_iter().flatten().min_by(f64::total_cmp);
        let part_rad = |deg: f64| STEP_PART * deg.to_radians();
        match tightest_deg {
            Some(deg) if scene.checked.moves_by_torque() && part_rad(deg) >= own_error => Self {
                error: part_rad(deg),
                label: "what the tolerance allows",
                words: format!("an error below {STEP_PART} of the tolerance of {deg}°"),
            },
            _ => Self {
                error: own_error,
                label: "as accurate as the scene",
                words: if is_resolved {
                    "as small an error".to_owned()
                } else {
                    format!("an error below {own_error:.1e} {}", scene.unit)
                },
            },
        }
    }
}

/// Returns the range of errors that has the uncertainty, the scene's own and the target, and those of the curves that mean something.
fn range(curves: &[Curve], resolved: f64, max_error: f64) -> (f64, f64) {
    let errors = curves.iter().flat_map(|curve| &curve.runs);
    let errors = errors
        .map(|run| run.error)
        .filter(|error| *error < MEANINGLESS);
    (0.5 * resolved, 3.0 * errors.fold(max_error, f64::max))
}

/// Error of a method that does not follow the machine at all, rad or m.
const MEANINGLESS: f64 = 1.0;

/// Part of a run in one tick.
struct Tick {
    /// Equations under the commands of the tick.
    equations: Box<dyn Equations>,
    /// State before the tick.
    start: Vec<f64>,
}

/// Records successive ticks around the first one in which the master has its highest speed.
struct Recorder {
    /// Chain behind the cam of axis 0, if torque does not move the shafts.
    chain: Option<Chain>,
    /// Last ticks, up to `length`.
    last: VecDeque<Tick>,
    /// Ticks around the one with the highest speed, once half of `length` has passed since.
    recorded: VecDeque<Tick>,
    /// Number of ticks to record.
    length: usize,
    /// Ticks since that with the highest speed.
    since: usize,
    top_turns: f64,
    tick_s: f64,
    /// Phases of the master and of axis 0 before the tick, turns.
    before: Option<(f64, f64)>,
}

/// Relative difference above which one speed is higher than another.
const HIGHER: f64 = 1e-6;

impl Observer for Recorder {
    fn tick(&mut self, moment: &Moment<'_>) {
        let now = (moment.master_turns, moment.actual_turns[0]);
        let before = self.before.replace(now).unwrap_or(now);
        let tick = match &self.chain {
            Some(chain) => Some(following(chain, before.1, now.1, self.tick_s)),
            None => moment.machine.rotors().and_then(|rotors| {
                let first = rotors.within().next()?;
                Some(Tick {
                    equations: Box::new(first.driven.clone()),
                    start: first.state.to_vec(),
                })
            }),
        };
        self.last.extend(tick);
        if self.last.len() > self.length {
            self.last.pop_front();
        }
        let travel_turns = (now.0 - before.0).abs();
        if travel_turns > self.top_turns * (1.0 + HIGHER) {
            (self.top_turns, self.since) = (travel_turns, 0);
            self.recorded.clear();
        }
        self.since += 1;
        if self.since == self.length / 2 && self.top_turns > 0.0 {
            self.recorded = std::mem::take(&mut self.last);
        }
    }
}

/// Returns a tick of a chain whose cam turns evenly, with all masses on the cam's law before it.
fn following(chain: &Chain, from_turns: f64, to_turns: f64, tick_s: f64) -> Tick {
    let mut chain = chain.clone();
    chain.cam.start_rad = from_turns.rem_euclid(1.0) * std::f64::consts::TAU;
    chain.cam.speed_rad_s = (to_turns - from_turns) * std::f64::consts::TAU / tick_s;
    let law = chain.cam.at(0.0);
    Tick {
        start: [[law.displacement; 3], [law.velocity; 3]].concat(),
        equations: Box::new(chain),
    }
}

/// Returns the numbers of steps in a tick: of the longest step, of the shortest, and of the references.
fn steps(scene: &Integrated) -> [u32; 3] {
    let min_steps = (scene.steps >> LONGER).max(1);
    let max_steps = (scene.steps << SHORTER).min(SUFFICIENT.max(4 * scene.steps));
    let doublings = max_steps.div_ceil(min_steps).ilog2();
    let max_steps = min_steps << doublings;
    [min_steps, max_steps, FINER * max_steps]
}

/// Runs the sample of a scene without faults, and records it in successive ticks.
fn record(scene: &Integrated) -> Result<VecDeque<Tick>, SceneError> {
    let checked = &scene.checked;
    let mut undisturbed = checked.clone();
    undisturbed.scene.fault.clear();
    let sample = sample::on(&undisturbed, checked.fidelity)?;
    let [.., finest] = steps(scene);
    let turn_ticks = 1.0 / (checked.top_speed_hz() * scene.tick_s);
    let affordable = f64::from(MAX_REFERENCE_STEPS / finest);
    let chain = (!checked.moves_by_torque())
        .then(|| chain_of(&checked.scene))
        .transpose()?;
    let mut recorder = Recorder {
        chain,
        last: VecDeque::new(),
        recorded: VecDeque::new(),
        length: turn_ticks.min(affordable).ceil().clamp(TICKS.0, TICKS.1) as usize,
        since: 0,
        top_turns: 0.0,
        tick_s: scene.tick_s,
        before: None,
    };
    simulate(&sample, &mut recorder, |_, _| {})?;
    Ok(if recorder.recorded.is_empty() {
        recorder.last // the run ended soon after its highest speed
    } else {
        recorder.recorded
    })
}

/// Returns the problem of a scene, without its answer.
fn problem(scene: &Integrated) -> Result<Problem, SceneError> {
    let ticks = record(scene)?;
    let Some(first) = ticks.front() else {
        return Err(SceneError::for_key(
            "program",
            "nothing moves in it, so that methods cannot be compared; give an amplitude above 0",
        ));
    };
    let [min_steps, max_steps, _] = steps(scene);
    Ok(Problem {
        name: "the turn around its top speed",
        unit: scene.unit,
        start: first.start.clone(),
        end_s: ticks.len() as f64 * scene.tick_s,
        equations: ticks.into_iter().map(|tick| tick.equations).collect(),
        answer: Vec::new(),
        uncertainty: f64::INFINITY,
        required_error: f64::INFINITY,
        steps: (min_steps, (max_steps / min_steps).ilog2()),
        default: Some(scene.scheme),
    })
}

/// Computes the answer of a problem, and its uncertainty. Returns the two methods.
fn solve(scene: &Integrated, problem: &mut Problem) -> Result<[Scheme; 2], ChartError> {
    let [.., finest] = steps(scene);
    let mut found = Vec::new();
    for scheme in REFERENCES {
        let steps = match found.len() {
            0 => finest,
            1 => finest / FINER * (FINER - 1),
            _ => break,
        };
        if let Some(trajectory) = problem.trajectory(scheme, steps, scene.compared)? {
            found.push((scheme, trajectory));
        }
    }
    let Ok([(one, answer), (other, check)]) = <[_; 2]>::try_from(found) else {
        return Err(ChartError(
            "no two methods follow this scene with fine steps, so that there is no reference; raise control.tick_hz, of whose tick a step is a part, or let fidelity be another level".to_owned(),
        ));
    };
    let off = answer.iter().zip(&check).map(|(a, b)| (a - b).abs());
    problem.uncertainty = off.fold(f64::MIN_POSITIVE, f64::max);
    problem.answer = answer;
    Ok([one, other])
}

fn steps_a_tick(steps: u32) -> String {
    let plural = if steps == 1 { "" } else { "s" };
    format!("{steps} step{plural} a tick")
}

fn csv(scene: &Integrated, problem: &Problem, own: &Run, curves: &[Curve]) -> String {
    let mut csv = "method,taken,steps_per_tick,step_s,evaluations_per_s,error,unit,reference_uncertainty,timing\n".to_owned();
    let own = (scene.scheme, own, true);
    let others = curves
        .iter()
        .flat_map(|curve| curve.runs.iter().map(|run| (curve.scheme, run, false)));
    for (scheme, run, taken) in std::iter::once(own).chain(others) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            csv,
            "{},{taken},{},{:e},{},{:e},{},{:e},{:.2}",
            scheme.facts().name,
            run.steps,
            scene.tick_s / f64::from(run.steps),
            run.evaluations,
            run.error,
            problem.unit,
            problem.uncertainty,
            run.sines_an_evaluation,
        );
    }
    csv
}

/// Ratio of two costs below which the lower one counts as cheaper.
const CHEAPER: f64 = 0.95;

/// Returns a summary of the data.
fn says(
    scene: &Integrated,
    problem: &Problem,
    own: &Run,
    curves: &[Curve],
    (target, [reference, check]): (&Target, [Scheme; 2]),
) -> String {
    let unit = problem.unit;
    let resolved = UNCERTAINTY_MARGIN * problem.uncertainty;
    let error = if own.error < resolved {
        format!("an error below {resolved:.1e} {unit}")
    } else {
        format!("an error of {:.1e} {unit}", own.error)
    };
    let costs = curves
        .iter()
        .filter_map(|curve| Some((curve.scheme, curve.cost_of(problem.required_error)?)));
    let cheapest = costs.min_by(|a, b| a.1.total_cmp(&b.1));
    let ratio = |cost: f64| cost / own.evaluations as f64;
    let compared = match cheapest.filter(|(_, cost)| ratio(*cost) < CHEAPER) {
        Some((scheme, cost)) => format!(
            "The cheapest method with {} is {scheme}, at {:.2} times that cost.",
            target.words,
            ratio(cost)
        ),
        None => format!("No method with {} is cheaper.", target.words),
    };
    format!(
        "In the turn around its top speed the scene takes {} with {}: {error} at {} evaluations in a simulated second. {compared} The reference is {reference}; {check} \
         differs from it by {:.1e} {unit}, and nothing is drawn below ten times that.",
        scene.scheme,
        steps_a_tick(scene.steps),
        own.evaluations,
        problem.uncertainty,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_methods::advance;
    use cophase_scene::file::Fidelity;
    use cophase_scene::library;

    /// If this fails, the chart is about another motion than that of the scene: ticks are missing, or the equations of a tick are not those
    /// under its commands.
    #[test]
    fn recorded_ticks_replay_the_run() {
        // Its program has several levels, each with its own highest speed.
        let mut scene = library::find("default").unwrap().scene();
        scene.fidelity = Fidelity::Phased;
        let scene = Integrated::new(&Checked::new(scene).unwrap()).unwrap();
        let ticks = record(&scene).unwrap();
        let turn_ticks = 1.0 / (scene.checked.top_speed_hz() * scene.tick_s);
        assert_eq!(ticks.len(), turn_ticks.ceil() as usize);
        let first = scene
            .scheme
            .prepare(ticks[0].equations.as_ref(), scene.step_s());
        let mut method = first.unwrap();
        for pair in ticks.iter().collect::<Vec<_>>().windows(2) {
            let (tick, mut y) = (pair[0].equations.as_ref(), pair[0].start.clone());
            advance(method.as_mut(), tick, 0.0, scene.steps, &mut y).unwrap();
            assert_eq!(y, pair[1].start);
        }
    }
}
