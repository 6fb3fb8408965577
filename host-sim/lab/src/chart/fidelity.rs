//! Error against cost of the rungs, for each built-in scene: what a scene pays for, and which rung `auto` takes.

use std::fmt::Write;
use std::time::Instant;

use super::axis::Axis;
use super::ink::{Ink, Stroke};
use super::picture::{At, Level, Line, Panel, Picture, render};
use super::yardstick::Yardstick;
use super::{ChartError, Drawn, Progress, Size};
use host_sim::fidelity::{
    Answers, Bounds, Judged, answers, available, check, compare, judge, questions,
};
use host_sim::machine::Machine;
use host_sim::scene::file::Fidelity;
use host_sim::scene::library::{BuiltIn, SCENES};
use host_sim::scene::{Checked, SceneError};

/// What is shown of error over tolerance; less is drawn at the bottom.
const SHOWN: (f64, f64) = (1e-4, 1e2);

/// One rung of a scene.
struct Rung {
    fidelity: Fidelity,
    cost: f64,
    judged: Vec<Judged>,
    answers: Answers,
    timing: f64,
}

/// A scene on all its rungs.
struct Ladder {
    name: &'static str,
    chosen: Fidelity,
    rungs: Vec<Rung>,
}

/// Makes the chart.
pub fn draw(size: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let yardstick = Yardstick::measure();
    let scenes: Vec<&BuiltIn> = match size {
        Size::Small => SCENES.iter().rev().take(2).collect(),
        Size::Full => SCENES.iter().collect(),
    };
    let mut ladders = Vec::new();
    for (done, scene) in scenes.iter().enumerate() {
        progress(done as u64, scenes.len() as u64);
        let ladder = climb(scene, yardstick)
            .map_err(|error| ChartError(error.in_file(scene.name).to_string()))?;
        ladders.push(ladder);
    }
    let says = says(&ladders);
    Ok(Drawn {
        csv: csv(&ladders),
        svg: render(Picture {
            title: "Fidelity: error against cost of the rungs".to_owned(),
            says: says.clone(),
            columns: 3,
            chosen_is: "taken by auto",
            panels: ladders.iter().map(panel).collect(),
        }),
        says,
    })
}

/// Runs a scene's sample on each rung it has.
fn climb(scene: &BuiltIn, yardstick: Yardstick) -> Result<Ladder, SceneError> {
    let checked = Checked::new(scene.scene())?;
    let questions = questions(&checked);
    let bounds = Bounds::new(&checked).ok();
    let fidelities = available(&checked);
    let top = fidelities.last().copied().unwrap_or_default();
    let right = answers(&checked, top)?;
    let mut rungs = Vec::new();
    for fidelity in fidelities {
        let began = Instant::now();
        let found = answers(&checked, fidelity)?;
        let timing = yardstick.sines(began.elapsed());
        let mut judged = judge(bounds.as_ref(), &questions, fidelity, checked.resolution);
        compare(&mut judged, &found, &right, top);
        rungs.push(Rung {
            fidelity,
            cost: crank_evaluations(&checked, fidelity)?,
            judged,
            answers: found,
            timing,
        });
    }
    Ok(Ladder {
        name: scene.name,
        chosen: check(checked)?.fidelity,
        rungs,
    })
}

/// How often a tick asks where a crank or cam is: the sine and the root, or the law, that all else is little beside. Once an
/// axis for the platform's place, once more for the torque that it asks for, and on rungs that are integrated as often as the
/// method asks.
fn crank_evaluations(checked: &Checked, rung: Fidelity) -> Result<f64, SceneError> {
    let on = checked.on(rung)?;
    let axes = checked.scene.axes.count;
    let method = Machine::new(&on)?.method();
    let asked = method.map_or(0, |(scheme, steps)| {
        let each = (steps * scheme.facts().evaluations) as usize;
        if rung == Fidelity::Rigid {
            each
        } else {
            each * axes
        }
    });
    let compared = usize::from(rung == Fidelity::QuasiStatic);
    Ok((axes + compared + asked) as f64)
}

/// How far the worst output is off, as a part of its tolerance.
fn part(judged: &[Judged], of: impl Fn(&Judged) -> Option<f64>) -> f64 {
    let parts = judged
        .iter()
        .map(|judged| of(judged).map_or(f64::INFINITY, |off| off / judged.tolerance));
    parts.fold(0.0, f64::max)
}

fn measured(judged: &Judged) -> Option<f64> {
    judged.measured.map(|(off, _)| off)
}

fn panel(ladder: &Ladder) -> Panel {
    let shown = |off: f64| off.clamp(SHOWN.0, SHOWN.1);
    let along = |of: fn(&Judged) -> Option<f64>| -> Vec<(f64, f64)> {
        let points = ladder
            .rungs
            .iter()
            .map(|rung| (rung.cost, shown(part(&rung.judged, of))));
        points.collect()
    };
    let names = ladder.rungs.iter().map(|rung| rung.fidelity.name());
    let found = Line {
        names: names.map(str::to_owned).collect(),
        ..Line::new("measured, against the top rung", Ink::Blue, along(measured))
    };
    let bound = Line {
        stroke: Stroke::Dashed,
        ..Line::new("bound", Ink::Vermilion, along(|judged| judged.bound))
    };
    let taken = ladder
        .rungs
        .iter()
        .filter(|rung| rung.fidelity == ladder.chosen);
    let taken = Line {
        stroke: Stroke::None,
        chosen: true,
        ..Line::new(
            "rung",
            Ink::Black,
            taken
                .map(|rung| (rung.cost, shown(part(&rung.judged, measured))))
                .collect(),
        )
    };
    Panel {
        title: ladder.name.to_owned(),
        x: Axis::log("crank evaluations a tick", 1.0, 1000.0),
        y: Axis::log("worst error, of its tolerance", SHOWN.0, SHOWN.1),
        lines: vec![bound, found, taken],
        levels: vec![Level {
            at: At::Y(1.0),
            label: "tolerance".to_owned(),
        }],
    }
}

fn csv(ladders: &[Ladder]) -> String {
    let mut csv =
        "scene,rung,taken,crank_evaluations,output,unit,found,tolerance,bound,off_top,timing\n"
            .to_owned();
    let number = |value: Option<f64>| match value {
        Some(value) if value.is_finite() => format!("{value:.6e}"),
        _ => String::new(),
    };
    for ladder in ladders {
        for rung in &ladder.rungs {
            for judged in &rung.judged {
                // Writing to a string does not fail.
                let _ = writeln!(
                    csv,
                    "{},{},{},{},{},{},{},{},{},{},{:.0}",
                    ladder.name,
                    rung.fidelity.name(),
                    rung.fidelity == ladder.chosen,
                    rung.cost,
                    judged.output.key(),
                    judged.output.unit(),
                    number(rung.answers.of(judged.output)),
                    judged.tolerance,
                    number(judged.bound),
                    number(measured(judged)),
                    rung.timing,
                );
            }
        }
    }
    csv
}

/// What the data say, counted.
fn says(ladders: &[Ladder]) -> String {
    let taken = |ladder: &Ladder| {
        ladder
            .rungs
            .iter()
            .position(|rung| rung.fidelity == ladder.chosen)
            .unwrap_or(0)
    };
    let within = ladders.iter().filter(|ladder| {
        let rung = &ladder.rungs[taken(ladder)];
        part(&rung.judged, measured) <= 1.0
    });
    let lowest = ladders.iter().filter(|ladder| {
        let found = ladder
            .rungs
            .iter()
            .position(|rung| part(&rung.judged, measured) <= 1.0);
        found == Some(taken(ladder))
    });
    format!(
        "Of {} scenes auto answers {} within their tolerances, {} of these on the lowest rung that does. Errors are of the worst output asked for; \
         what is below {:.0e} of its tolerance, or not off at all, stands at the bottom.",
        ladders.len(),
        within.count(),
        lowest.count(),
        SHOWN.0
    )
}
