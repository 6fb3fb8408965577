//! Error against cost of the model levels, for each built-in scene or for a user's, and the model level that `auto` takes.

use std::fmt::Write;
use std::time::Instant;

use cophase_scene::SceneError;
use cophase_scene::file::Fidelity;
use cophase_scene::library::{BuiltIn, SCENES};
use host_sim::checked::Checked;
use host_sim::checked::Judged;
use host_sim::fidelity::{Answers, answers, check, compare};
use host_sim::model_level::{Bounds, available, judge, questions};
use host_sim::output::Output;
use host_sim::simulated_machine::SimulatedMachine;

use super::axis::Axis;
use super::ink::{Ink, Stroke};
use super::picture::{Level, Line, Panel, Picture, render};
use super::yardstick::Yardstick;
use super::{ChartError, Drawn, Progress, Size};

/// Range of error over tolerance that is shown; smaller values are drawn at the bottom.
const SHOWN: (f64, f64) = (1e-4, 1e2);
const COST: &str = "crank evaluations a tick";

/// Model level of a scene.
struct ModelLevel {
    fidelity: Fidelity,
    cost: f64,
    judged: Vec<Judged>,
    answers: Answers,
    timing: f64,
}

/// Scene on all its model levels.
struct Ladder {
    name: String,
    chosen: Fidelity,
    model_levels: Vec<ModelLevel>,
}

impl Ladder {
    /// Returns the model level that `auto` takes.
    fn taken(&self) -> &ModelLevel {
        let levels = &self.model_levels;
        let taken = levels.iter().find(|level| level.fidelity == self.chosen);
        taken.unwrap_or(&levels[0])
    }
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
        let ladder = Checked::new(scene.scene())
            .and_then(|checked| climb(checked, yardstick, &mut |_, _| {}));
        let ladder = ladder.map_err(|error| ChartError(error.in_file(scene.name).to_string()))?;
        ladders.push(ladder);
    }
    let says = says(&ladders);
    let svg = render(Picture {
        title: "Fidelity: error against cost of the model levels".to_owned(),
        says: says.clone(),
        columns: 3,
        chosen_is: "taken by auto",
        panels: ladders.iter().map(panel).collect(),
    });
    Ok(Drawn::one(csv(&ladders), svg, says))
}

/// Makes the chart of a scene.
///
/// # Errors
/// The scene requests no output, or lacks data for it.
pub fn draw_scene(checked: &Checked, _: Size, progress: Progress) -> Result<Drawn, SceneError> {
    let set = checked.scene.fidelity;
    let mut open = checked.scene.clone();
    open.fidelity = Fidelity::Auto;
    let open = Checked::new(open)?;
    let questions = questions(&open);
    if Output::ALL
        .iter()
        .all(|output| output.tolerance(&questions).is_none())
    {
        return Err(SceneError::for_key(
            "questions",
            "the scene requests no output whose error could be compared with its tolerance; give one, such as \
             questions.lag_deg = 1",
        ));
    }
    let ladder = climb(open, Yardstick::measure(), progress)?;
    let says = scene_says(&ladder, set);
    let svg = render(Picture {
        title: format!("{}: error against cost of its model levels", ladder.name),
        says: says.clone(),
        columns: 1,
        chosen_is: "taken by auto",
        panels: vec![scene_panel(&ladder)],
    });
    Ok(Drawn::one(csv(&[ladder]), svg, says))
}

/// Colours of the outputs, in the order of [`Output::ALL`].
const INKS: [Ink; Output::ALL.len()] = [
    Ink::Blue,
    Ink::Vermilion,
    Ink::Green,
    Ink::Orange,
    Ink::Purple,
    Ink::Sky,
    Ink::Grey,
];

/// Makes the panel of a scene, with a line for each output.
fn scene_panel(ladder: &Ladder) -> Panel {
    let levels = &ladder.model_levels;
    let mut lines = Vec::new();
    for (place, judged) in levels[0].judged.iter().enumerate() {
        let ink = INKS[judged.output as usize];
        let along = |of: fn(&Judged) -> Option<f64>| -> Vec<(f64, f64)> {
            let points = levels.iter().filter_map(|level| {
                let judged = &level.judged[place];
                Some((level.cost, shown(of(judged)? / judged.tolerance)))
            });
            points.collect()
        };
        lines.push(Line {
            stroke: Stroke::Dashed,
            marked: false,
            ..Line::new(
                format!("{}, bound", judged.output.key()),
                ink,
                along(|judged| judged.bound),
            )
        });
        lines.push(Line::new(judged.output.key(), ink, along(measured)));
    }
    let worst = |level: &ModelLevel| (level.cost, shown(part(&level.judged, measured)));
    lines.push(Line {
        stroke: Stroke::None,
        marked: false,
        names: levels
            .iter()
            .map(|level| level.fidelity.name().to_owned())
            .collect(),
        ..Line::new("", Ink::Black, levels.iter().map(worst).collect())
    });
    lines.push(Line {
        stroke: Stroke::None,
        chosen: true,
        ..Line::new("model level", Ink::Black, vec![worst(ladder.taken())])
    });
    let costs = levels.iter().map(|level| level.cost);
    let (min_cost, max_cost) = costs.fold((f64::INFINITY, 0.0_f64), |(min, max), cost| {
        (min.min(cost), max.max(cost))
    });
    Panel {
        title: "each output that the scene requests".to_owned(),
        x: Axis::log(COST, 0.5 * min_cost, 2.0 * max_cost),
        // Room for the marks at the bottom.
        y: Axis::log("error, of its tolerance", 0.5 * SHOWN.0, SHOWN.1),
        lines,
        levels: vec![Level::at_y(1.0, "tolerance")],
    }
}

/// Returns a summary of the data of one scene, whose file sets the model level `set`.
fn scene_says(ladder: &Ladder, set: Fidelity) -> String {
    let levels = &ladder.model_levels;
    let taken = ladder.taken();
    let top = levels.last().unwrap_or(taken);
    let error = if taken.fidelity == top.fidelity {
        "the most detailed one for which it has data".to_owned()
    } else {
        let worst = part(&taken.judged, measured);
        format!("with errors up to {worst:.3} of their tolerance")
    };
    let cheaper: Vec<_> = levels
        .iter()
        .filter(|level| level.cost < taken.cost)
        .collect();
    let sufficient = cheaper
        .iter()
        .find(|level| part(&level.judged, measured) <= 1.0);
    let compared = match sufficient {
        Some(level) => format!(
            "In the sample {} is within the tolerances at a lower cost.",
            level.fidelity.name()
        ),
        None if cheaper.is_empty() => "No level is cheaper.".to_owned(),
        None => "No cheaper level is within the tolerances in the sample.".to_owned(),
    };
    let sets = match set {
        Fidelity::Auto => String::new(),
        set => format!(" The scene sets {}.", set.name()),
    };
    format!(
        "For this scene auto takes the {} level, {error}, at {:.0} crank evaluations a tick. {compared}{sets} Errors are differences \
         from the {} level; what is below {:.0e} of its tolerance, or not off at all, stands at the bottom.",
        taken.fidelity.name(),
        taken.cost,
        top.fidelity.name(),
        SHOWN.0,
    )
}

/// Runs a scene's sample on each model level it has.
fn climb(checked: Checked, yardstick: Yardstick, progress: Progress) -> Result<Ladder, SceneError> {
    let questions = questions(&checked);
    // Bounds hold for an undisturbed machine.
    let is_disturbed = !checked.scene.fault.is_empty();
    let bounds = Bounds::new(&checked).ok().filter(|_| !is_disturbed);
    let fidelities = available(&checked);
    let top = fidelities.last().copied().unwrap_or(Fidelity::Auto);
    let right = answers(&checked, top)?;
    let mut model_levels = Vec::new();
    let of = fidelities.len() as u64 + 1;
    for (done, fidelity) in (1..).zip(fidelities) {
        progress(done, of);
        let began = Instant::now();
        let found = answers(&checked, fidelity)?;
        let timing = yardstick.sines(began.elapsed());
        let mut judged = judge(bounds.as_ref(), &questions, fidelity, checked.resolution);
        compare(&mut judged, &found, &right, top);
        model_levels.push(ModelLevel {
            fidelity,
            cost: crank_evaluations(&checked, fidelity)?,
            judged,
            answers: found,
            timing,
        });
    }
    Ok(Ladder {
        name: checked.scene.name.clone(),
        chosen: check(checked)?.fidelity,
        model_levels,
    })
}

/// Returns the number of position evaluations of a crank or cam per tick: the sine and the root, or the law, which dominate the cost.
/// There is one per axis for the platform's position, one more for its torque and, on integrated levels, as many as the method
/// needs.
fn crank_evaluations(checked: &Checked, model_level: Fidelity) -> Result<f64, SceneError> {
    let on = checked.on(model_level)?;
    let axes = checked.scene.axes.count;
    let method = SimulatedMachine::new(&on)?.method();
    let evaluated = method.map_or(0, |(scheme, steps)| {
        let each = (steps * scheme.facts().evaluations) as usize;
        if model_level == Fidelity::Rigid {
            each
        } else {
            each * axes
        }
    });
    let compared = usize::from(model_level == Fidelity::QuasiStatic);
    Ok((axes + compared + evaluated) as f64)
}

/// Returns the largest error of an output, relative to its tolerance.
fn part(judged: &[Judged], of: impl Fn(&Judged) -> Option<f64>) -> f64 {
    let parts = judged
        .iter()
        .map(|judged| of(judged).map_or(f64::INFINITY, |off| off / judged.tolerance));
    parts.fold(0.0, f64::max)
}

fn measured(judged: &Judged) -> Option<f64> {
    judged.measured.map(|(off, _)| off)
}

/// Returns a relative error at which it is drawn.
fn shown(off: f64) -> f64 {
    off.clamp(SHOWN.0, SHOWN.1)
}

fn panel(ladder: &Ladder) -> Panel {
    let along = |of: fn(&Judged) -> Option<f64>| -> Vec<(f64, f64)> {
        let points = ladder
            .model_levels
            .iter()
            .map(|model_level| (model_level.cost, shown(part(&model_level.judged, of))));
        points.collect()
    };
    let names = ladder
        .model_levels
        .iter()
        .map(|model_level| model_level.fidelity.name());
    let found = Line {
        names: names.map(str::to_owned).collect(),
        ..Line::new(
            "measured, against the top model level",
            Ink::Blue,
            along(measured),
        )
    };
    let bound = Line {
        stroke: Stroke::Dashed,
        ..Line::new("bound", Ink::Vermilion, along(|judged| judged.bound))
    };
    let taken = ladder
        .model_levels
        .iter()
        .filter(|model_level| model_level.fidelity == ladder.chosen);
    let taken = Line {
        stroke: Stroke::None,
        chosen: true,
        ..Line::new(
            "model level",
            Ink::Black,
            taken
                .map(|model_level| (model_level.cost, shown(part(&model_level.judged, measured))))
                .collect(),
        )
    };
    Panel {
        title: ladder.name.clone(),
        x: Axis::log(COST, 1.0, 1000.0),
        y: Axis::log("worst error, of its tolerance", SHOWN.0, SHOWN.1),
        lines: vec![bound, found, taken],
        levels: vec![Level::at_y(1.0, "tolerance")],
    }
}

fn csv(ladders: &[Ladder]) -> String {
    let mut csv =
        "scene,model_level,taken,crank_evaluations,output,unit,found,tolerance,bound,off_top,timing\n"
            .to_owned();
    let number = |value: Option<f64>| match value {
        Some(value) if value.is_finite() => format!("{value:.6e}"),
        _ => String::new(),
    };
    for ladder in ladders {
        for model_level in &ladder.model_levels {
            for judged in &model_level.judged {
                // Writing to a string cannot fail.
                let _ = writeln!(
                    csv,
                    "{},{},{},{},{},{},{},{},{},{},{:.0}",
                    ladder.name,
                    model_level.fidelity.name(),
                    model_level.fidelity == ladder.chosen,
                    model_level.cost,
                    judged.output.key(),
                    judged.output.unit(),
                    number(model_level.answers.of(judged.output)),
                    judged.tolerance,
                    number(judged.bound),
                    number(measured(judged)),
                    model_level.timing,
                );
            }
        }
    }
    csv
}

/// Returns a summary of the data with counts.
fn says(ladders: &[Ladder]) -> String {
    let taken = |ladder: &Ladder| {
        ladder
            .model_levels
            .iter()
            .position(|model_level| model_level.fidelity == ladder.chosen)
            .unwrap_or(0)
    };
    let within = ladders.iter().filter(|ladder| {
        let model_level = &ladder.model_levels[taken(ladder)];
        part(&model_level.judged, measured) <= 1.0
    });
    let lowest = ladders.iter().filter(|ladder| {
        let found = ladder
            .model_levels
            .iter()
            .position(|model_level| part(&model_level.judged, measured) <= 1.0);
        found == Some(taken(ladder))
    });
    format!(
        "Of {} scenes auto answers {} within their tolerances, {} of these on the lowest model level that does. Errors are of the worst output requested; \
         what is below {:.0e} of its tolerance, or not off at all, stands at the bottom.",
        ladders.len(),
        within.count(),
        lowest.count(),
        SHOWN.0
    )
}
