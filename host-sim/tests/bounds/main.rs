//! Answers of `auto` on random machines, against converged solutions. No bound is violated, no tolerance is missed, and no bound is printed
//! where none is known. `auto` takes at most one model level too many.
//!
//! A run tests 60 machines. This command tests more, and others:
//!
//!     COPHASE_MACHINES=10000 COPHASE_SEED=1000000 cargo test --release -p host-sim --test bounds -- --nocapture

mod friction;
mod machines;

use std::fmt::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use cophase_scene::file::{Fidelity, MethodName, Questions};
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::checked::Choice;
use host_sim::dynamics::MAX_STEPS;
use host_sim::fidelity::{Answers, answered, check};
use host_sim::model_level::{Bounds, available, questions};
use host_sim::output::Output;
use host_sim::sim::simulate;
use host_sim::simulated_machine::SimulatedMachine;

/// A solution has converged if half its step changes it by at most this part of each tolerance.
const CONVERGED: f64 = 0.02;

/// Error of a converged solution, as a part of the tolerance. Extremes between steps converge quadratically.
const LEFT: f64 = CONVERGED;

/// The part of a tolerance that a model level may use for the effects that it omits. Its step has the rest.
const WELL_WITHIN: f64 = 0.9;

/// Counts of findings.
#[derive(Default)]
struct Tally {
    /// Answers that were compared with a converged solution, and the count of those that have a bound.
    answers: u32,
    bounded: u32,
    /// Machines whose motors slipped, machines whose solution did not converge, and machines that were refused.
    slipped: u32,
    not_converged: u32,
    refused: u32,
    /// Machines by the number of model levels that `auto` was too high.
    too_high: [u32; 5],
    /// Violated bounds of model levels that `auto` did not take.
    not_taken: u32,
    /// Claims that are wrong.
    wrong: Vec<String>,
}

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| {
        text.parse()
            .unwrap_or_else(|_| panic!("{name} is {text}; give a whole number"))
    })
}

/// Known machines whose bounds were wrong once. Each output is judged like those of random machines.
#[test]
fn bounds_hold_for_machines_that_failed_before() {
    let known = [
        include_str!("known/amplitude-near-limit.toml"),
        include_str!("known/cranks-apart.toml"),
        include_str!("known/friction.toml"),
        include_str!("known/ground.toml"),
        include_str!("known/on-a-frame.toml"),
        include_str!("known/slips-and-tolerance.toml"),
        include_str!("known/slips.toml"),
        include_str!("known/torque-near-limit.toml"),
    ];
    let tally = Mutex::new(Tally::default());
    for (seed, text) in (0..).zip(known) {
        judge(seed, text, &tally);
    }
    let wrong = tally.into_inner().unwrap().wrong;
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn answers_are_as_good_as_claimed() {
    let machines = number("COPHASE_MACHINES", 60);
    hold_to_claims(machines, number("COPHASE_SEED", 1), machines::slider_crank);
}

/// Crank-rockers, whose motion is not symmetric about the dead centres. `COPHASE_VARIATIONS` sets their count.
#[test]
fn answers_on_crank_rockers_are_as_good_as_claimed() {
    let machines = number("COPHASE_VARIATIONS", 10);
    hold_to_claims(machines, number("COPHASE_SEED", 1), machines::crank_rocker);
}

/// Variations of the built-in scenes of machines that are no platform on cranks. `COPHASE_VARIATIONS` sets the count for each scene (docs
/// quote 20). Only followers have bounds. For the others, the answers of the level that `auto` takes must be within the tolerances.
#[test]
fn answers_on_other_machines_are_as_good_as_claimed() {
    let variations = number("COPHASE_VARIATIONS", 3);
    let first = number("COPHASE_SEED", 1);
    for scene in [
        machines::screen,
        machines::crusher,
        machines::five_bar,
        machines::wrapper,
    ] {
        hold_to_claims(variations, first, scene);
    }
}

fn hold_to_claims(machines: u64, first: u64, scene: fn(u64) -> String) {
    let tally = judge_all(machines, first, scene);
    println!(
        "{machines} machines from seed {first}: {} answers against converged solutions, {} of them bounded; {} machines slip, {} do \
         not converge, {} are refused; model levels too high: {:?}; bounds of levels not taken that do not hold: {}",
        tally.answers,
        tally.bounded,
        tally.slipped,
        tally.not_converged,
        tally.refused,
        tally.too_high,
        tally.not_taken
    );
    let wrong = tally.wrong.join("\n");
    assert!(
        tally.wrong.is_empty(),
        "{} wrong:\n{wrong}",
        tally.wrong.len()
    );
    // A sample rejects these bounds before they are claimed.
    assert!(
        50 * tally.not_taken <= tally.answers,
        "{} of bounds of levels not taken do not hold",
        tally.not_taken
    );
    assert!(
        2 * tally.answers > machines as u32,
        "too little is compared"
    );
}

/// Judges the machines of these seeds.
fn judge_all(machines: u64, first: u64, scene: fn(u64) -> String) -> Tally {
    let next = AtomicU64::new(first);
    let tally = Mutex::new(Tally::default());
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + machines {
                        return;
                    }
                    judge(seed, &scene(seed), &tally);
                    let done = seed - first;
                    if done % 500 == 499 {
                        eprintln!("{} of {machines} machines", done + 1);
                    }
                }
            });
        }
    });
    tally.into_inner().unwrap()
}

/// Runs a scene. Returns its answers, and whether the run diverged.
fn run(checked: &Checked) -> (Answers, bool) {
    let mut answers = Answers::default();
    let outcome = simulate(checked, &mut answers, |_, _| {}).unwrap();
    (answers, outcome.diverged.is_some())
}

fn judge(seed: u64, text: &str, tally: &Mutex<Tally>) {
    let scene = load::parse(text).unwrap_or_else(|error| panic!("{seed}: {error}\n{text}"));
    let checked = match Checked::new(scene) {
        Ok(checked) => checked,
        Err(error) => {
            eprintln!("{seed}: {error}");
            tally.lock().unwrap().refused += 1;
            return;
        }
    };
    let model_levels = available(&checked);
    let top = *model_levels.last().expect("kinematic is always there");
    let questions = questions(&checked);
    let taken = check(checked.clone()).unwrap();
    let (answers, diverged) = run(&taken);
    let has_slipped = answers.of(Output::Slips) != Some(0.0);
    let taken = answered(taken, &answers);
    let choice = taken.choice.as_ref().expect("it was requested");
    let right = converged(&checked, top, &questions);
    let mut tally = tally.lock().unwrap();
    let mut wrong = String::new();
    let unbounded = choice.judged.iter().all(|judged| judged.bound.is_none());
    if has_slipped || diverged {
        tally.slipped += 1;
        if !unbounded {
            let _ = writeln!(wrong, "  a bound beside a slip");
        }
    }
    match right {
        None => {
            tally.not_converged += 1;
            if !unbounded {
                let _ = writeln!(wrong, "  a bound where nothing converges");
            }
        }
        Some(_) if has_slipped || diverged => {}
        Some(right) => {
            let is_open = checked.chosen().is_open();
            compare(choice, is_open, &answers, &right, &mut tally, &mut wrong);
            let lowest = lowest(&checked, &model_levels, &questions, &right, &mut tally);
            let place = model_levels
                .iter()
                .position(|&level| level == choice.model_level);
            let too_high = place.unwrap_or(0).saturating_sub(lowest);
            tally.too_high[too_high] += 1;
            if too_high > 1 && is_open {
                let _ = writeln!(
                    wrong,
                    "  {} taken, {} would do",
                    choice.model_level.name(),
                    model_levels[lowest].name()
                );
            }
        }
    }
    if !wrong.is_empty() {
        if std::env::var_os("COPHASE_SHOW").is_some() {
            eprintln!("{text}");
        }
        tally.wrong.push(format!(
            "seed {seed}, {} ({}, {:?}):\n{wrong}",
            choice.model_level.name(),
            choice.why,
            SimulatedMachine::new(&taken).unwrap().method()
        ));
    }
}

/// Checks answers against right ones. A step that the scene sets may miss a tolerance, and its bound states this.
fn compare(
    choice: &Choice,
    is_open: bool,
    answers: &Answers,
    right: &Answers,
    tally: &mut Tally,
    wrong: &mut String,
) {
    for judged in &choice.judged {
        let (Some(found), Some(right)) = (answers.of(judged.output), right.of(judged.output))
        else {
            let _ = writeln!(wrong, "  {}: no answer", judged.output.key());
            continue;
        };
        let off = judged.output.difference(found, right);
        let sure = LEFT * judged.tolerance;
        tally.answers += 1;
        if let Some(bound) = judged.bound {
            tally.bounded += 1;
            if off > bound + sure {
                let _ = writeln!(
                    wrong,
                    "  {}: off by {off}, at most {bound}; required to {}",
                    judged.output.key(),
                    judged.tolerance
                );
            }
        }
        if is_open && off > judged.tolerance + sure {
            let _ = writeln!(
                wrong,
                "  {}: off by {off} of {found}, required to {}",
                judged.output.key(),
                judged.tolerance
            );
        }
    }
}

/// Returns the top model level's answers by plain RK4. The step is halved until that has no effect. Returns `None` if it always has one.
fn converged(checked: &Checked, top: Fidelity, questions: &Questions) -> Option<Answers> {
    let mut scene = checked.scene.clone();
    scene.fidelity = top;
    scene.method.name = MethodName::Rk4;
    scene.method.steps_per_tick = None;
    let method = SimulatedMachine::new(&Checked::new(scene.clone()).ok()?)
        .ok()?
        .method();
    let mut steps = method.map_or(1, |(_, steps)| steps);
    let mut before: Option<Answers> = None;
    loop {
        scene.method.steps_per_tick = Some(steps);
        let (now, diverged) = run(&Checked::new(scene.clone()).ok()?);
        if diverged {
            return None;
        }
        let same = before.is_some_and(|before| {
            Output::ALL.into_iter().all(|output| {
                let Some(tolerance) = output.tolerance(questions) else {
                    return true;
                };
                let both = before.of(output).zip(now.of(output));
                both.is_some_and(|(before, now)| {
                    output.difference(before, now) <= CONVERGED * tolerance
                })
            })
        });
        if same {
            return Some(now);
        }
        steps *= 2;
        if steps > MAX_STEPS {
            return None;
        }
        before = Some(now);
    }
}

/// Returns the lowest model level whose answers are within the tolerances of the right ones. Also checks the bounds of all levels against
/// the right answers. No sample has checked these bounds yet.
fn lowest(
    checked: &Checked,
    model_levels: &[Fidelity],
    questions: &Questions,
    right: &Answers,
    tally: &mut Tally,
) -> usize {
    let bounds = Bounds::new(checked).expect("the top model level is there");
    let is_within: Vec<bool> = model_levels
        .iter()
        .map(|&model_level| {
            let mut scene = checked.scene.clone();
            scene.fidelity = model_level;
            let mut on = Checked::new(scene).expect("an available model level");
            on.resolution = checked.resolution;
            let (answers, _) = run(&on);
            Output::ALL.into_iter().fold(true, |is_within, output| {
                let Some(tolerance) = output.tolerance(questions) else {
                    return is_within;
                };
                let both = answers.of(output).zip(right.of(output));
                let off = both.map(|(found, right)| output.difference(found, right));
                let bound = bounds.with_steps(model_level, output, checked.resolution);
                let bound = bound.filter(|_| answers.is_regular() && right.is_regular());
                if let Some((off, bound)) = off.zip(bound)
                    && off > bound + LEFT * tolerance
                {
                    tally.not_taken += 1;
                }
                is_within && off.is_some_and(|off| off <= WELL_WITHIN * tolerance)
            })
        })
        .collect();
    let lowest = is_within.iter().position(|&is_within| is_within);
    lowest.unwrap_or(model_levels.len() - 1)
}
