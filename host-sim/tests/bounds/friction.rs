//! Random machines with much friction, run as `auto` runs them, against RK4 with [`JUDGE_STEPS`] steps a tick.
//!
//! A run tests 10 machines. This command tests as many as the documentation quotes:
//!
//!     COPHASE_FRICTION_SCENES=500 COPHASE_SEED=7000000 cargo test --release -p host-sim --test bounds friction -- --nocapture

use std::fmt::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use cophase_scene::file::MethodName;
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::fidelity::{Answers, check};
use host_sim::output::Output;
use host_sim::simulated_machine::SimulatedMachine;

use super::{machines, number, run};

/// Steps per tick of the judge.
const JUDGE_STEPS: u32 = 500;

/// Difference that counts as none, in the unit of an output (°, mrad, %): that of rounding, as in the bounds.
const ROUNDING: f64 = 1e-6;

/// Counts of findings.
#[derive(Default)]
struct Tally {
    /// Machines that the judge ran, and those of them in which a motor slipped.
    judged: u32,
    slipped: u32,
    /// Machines for which the judge's step is too long, and machines that were refused.
    too_fast: u32,
    refused: u32,
    /// Machines that `auto` gave to SDIRK4.
    implicit: u32,
    /// Answers compared, and the largest of their differences, as a part of the printed error.
    answers: u32,
    max_part: f64,
    wrong: Vec<String>,
}

/// If this fails, friction makes a machine diverge, or the printed error of the step is smaller than its error.
#[test]
fn machines_with_friction_run_and_agree_within_the_printed_step_error() {
    let machines = number("COPHASE_FRICTION_SCENES", 10);
    let first = number("COPHASE_SEED", 1);
    let (next, tally) = (AtomicU64::new(first), Mutex::new(Tally::default()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + machines {
                        return;
                    }
                    judge(seed, &tally);
                    if (seed - first) % 50 == 49 {
                        eprintln!("{} of {machines} machines", seed - first + 1);
                    }
                }
            });
        }
    });
    let tally = tally.into_inner().unwrap();
    println!(
        "{machines} machines with friction from seed {first}: the judge ran {}, {} of them slip; its step is too long for {}; {} are \
         refused; {} by SDIRK4; {} answers, off by up to {:.2} of the printed step error; {} wrong",
        tally.judged,
        tally.slipped,
        tally.too_fast,
        tally.refused,
        tally.implicit,
        tally.answers,
        tally.max_part,
        tally.wrong.len()
    );
    assert!(tally.wrong.is_empty(), "{}", tally.wrong.join("\n"));
    assert!(2 * tally.judged > machines as u32, "too little is compared");
}

fn judge(seed: u64, tally: &Mutex<Tally>) {
    let text = machines::rubbing(seed);
    let scene = load::parse(&text).unwrap_or_else(|error| panic!("{seed}: {error}\n{text}"));
    let taken = match Checked::new(scene).and_then(check) {
        Ok(taken) => taken,
        Err(error) => {
            eprintln!("{seed}: {error}");
            tally.lock().unwrap().refused += 1;
            return;
        }
    };
    let (answers, diverged) = run(&taken);
    let method = SimulatedMachine::new(&taken).unwrap().method();
    let right = judged(&taken);
    let mut tally = tally.lock().unwrap();
    let mut wrong = String::new();
    if method.is_some_and(|(scheme, _)| scheme == cophase_methods::Scheme::Sdirk4) {
        tally.implicit += 1;
    }
    match right {
        None => tally.too_fast += 1,
        Some((_, true)) => {}
        Some((right, false)) => {
            tally.judged += 1;
            if diverged {
                let _ = writeln!(wrong, "  it diverged");
            } else if answers.is_regular() && right.is_regular() {
                compare(&taken, &answers, &right, &mut tally, &mut wrong);
            } else {
                tally.slipped += 1;
            }
        }
    }
    if !wrong.is_empty() {
        if std::env::var_os("COPHASE_SHOW").is_some() {
            eprintln!("{text}");
        }
        let level = taken.fidelity.name();
        tally
            .wrong
            .push(format!("seed {seed}, {level}, {method:?}:\n{wrong}"));
    }
}

/// Returns the answers of RK4 on the model level that was taken, and whether it diverged. `None` if its step is too long.
fn judged(taken: &Checked) -> Option<(Answers, bool)> {
    let mut scene = taken.scene.clone();
    scene.fidelity = taken.fidelity;
    scene.method.name = MethodName::Rk4;
    scene.method.steps_per_tick = Some(JUDGE_STEPS);
    Some(run(&Checked::new(scene).ok()?))
}

fn compare(
    taken: &Checked,
    answers: &Answers,
    right: &Answers,
    tally: &mut Tally,
    wrong: &mut String,
) {
    let choice = taken.choice.as_ref().expect("it was requested");
    for judged in choice
        .judged
        .iter()
        .filter(|judged| judged.output != Output::Slips)
    {
        let Some(printed) = judged.step_error else {
            continue;
        };
        let (Some(found), Some(right)) = (answers.of(judged.output), right.of(judged.output))
        else {
            let _ = writeln!(wrong, "  {}: no answer", judged.output.key());
            continue;
        };
        let off = judged.output.difference(found, right);
        let allowed = printed + ROUNDING;
        tally.answers += 1;
        tally.max_part = tally.max_part.max(off / allowed);
        if off > allowed {
            let _ = writeln!(
                wrong,
                "  {}: off by {off} of {found}, printed {printed}; required to {}",
                judged.output.key(),
                judged.tolerance
            );
        }
    }
}
