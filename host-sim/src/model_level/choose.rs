//! Choice of a model level without a run.

use cophase_scene::SceneError;
use cophase_scene::file::{Fidelity, Questions};

use super::Bounds;
use crate::checked::Checked;
use crate::checked::{Choice, Judged};
use crate::dynamics::RESOLUTION;
use crate::output::Output;

/// Part of each tolerance that the method's step may use.
pub const STEP_PART: f64 = 0.1;

/// All model levels, the lowest first.
pub const LADDER: [Fidelity; 5] = [
    Fidelity::Kinematic,
    Fidelity::QuasiStatic,
    Fidelity::Rigid,
    Fidelity::Phased,
    Fidelity::Elastic,
];

/// Returns the questions of a scene. Without any, the question is which motors slip, if the scene has their torque limits.
pub fn questions(checked: &Checked) -> Questions {
    let declared = checked.scene.questions;
    let axes = &checked.scene.axes;
    let limits_servos = axes.servo.is_some_and(|servo| servo.limit_nm.is_some());
    if declared.is_none() && (limits_servos || !axes.pull_out.is_empty()) {
        return Questions {
            slips: Some(true),
            ..declared
        };
    }
    declared
}

/// Judges each requested output of a model level, with a method of that resolution.
pub fn judge(
    bounds: Option<&Bounds>,
    questions: &Questions,
    model_level: Fidelity,
    resolution: f64,
) -> Vec<Judged> {
    let requested = Output::ALL
        .into_iter()
        .filter_map(|output| Some((output, output.tolerance(questions)?)));
    requested
        .map(|(output, tolerance)| Judged {
            output,
            tolerance,
            bound: bounds.and_then(|bounds| bounds.with_steps(model_level, output, resolution)),
            value: None,
            measured: None,
            step_error: None,
        })
        .collect()
}

/// Chooses the lowest model level whose bounds are within the tolerances, of those for which a scene has enough data. The choice
/// assumes an undisturbed machine. A disturbed one has no bounds.
///
/// # Errors
/// A question needs a model level for which the scene lacks data.
pub fn choose(checked: &Checked) -> Result<Choice, SceneError> {
    let mut choice = choose_undisturbed(checked)?;
    if !is_undisturbed(checked) {
        for judged in &mut choice.judged {
            judged.bound = None;
        }
    }
    Ok(choice)
}

/// Returns true if no fault or noise of the load disturbs the machine. Bounds do not include these.
pub fn is_undisturbed(checked: &Checked) -> bool {
    checked.scene.fault.is_empty() && checked.scene.noise.load_nm == 0.0
}

fn choose_undisturbed(checked: &Checked) -> Result<Choice, SceneError> {
    let questions = questions(checked);
    if Output::ALL
        .iter()
        .all(|output| output.tolerance(&questions).is_none())
    {
        return Ok(without_questions(checked));
    }
    let bounds = Bounds::new(checked);
    let bounds = match bounds {
        Ok(bounds) => bounds,
        // Without rotors, torques cannot be compared, except on a level without inertia, which takes the pull-out torque of steppers.
        Err(_)
            if checked.scene.questions.is_none()
                && (checked.scene.axes.pull_out.is_empty()
                    || !checked.machine.levels().contains(&Fidelity::QuasiStatic)) =>
        {
            return Ok(without_questions(checked));
        }
        // There is no explicit question, so the torques are compared. The reason says so.
        Err(_) if checked.scene.questions.is_none() => {
            return Ok(Choice {
                model_level: Fidelity::QuasiStatic,
                why: "the scene gives the motors' pull-out torque, so the question is whether they keep in step; the torque of \
                      oscillations is unknown, as it gives no rotor inertia"
                    .to_owned(),
                judged: judge(None, &questions, Fidelity::QuasiStatic, RESOLUTION),
                resolution: RESOLUTION,
            });
        }
        // No data is missing, but the method, the cranks' phases or a fault are invalid.
        Err(wrong)
            if ["method", "fault"]
                .iter()
                .any(|table| wrong.key.starts_with(table))
                || ["offset_deg", "trim_deg", "ratio"]
                    .iter()
                    .any(|name| wrong.key.ends_with(name)) =>
        {
            return Err(wrong);
        }
        Err(lacking) => {
            let requested = judge(None, &questions, Fidelity::Rigid, RESOLUTION);
            let key = requested.first().map_or("", |judged| judged.output.key());
            return Err(SceneError::for_key(
                format!("questions.{key}"),
                format!(
                    "cannot be answered: {} is needed for that ({}); give it, or leave the question out",
                    lacking.key,
                    what_is_needed(&lacking.problem)
                ),
            ));
        }
    };
    // A method or step that the scene sets is not changed.
    let resolution = bounds
        .imposed()
        .unwrap_or_else(|| resolution(&bounds, &questions));
    let model_levels = available(checked);
    for &model_level in &model_levels {
        let judged = judge(Some(&bounds), &questions, model_level, resolution);
        if judged.iter().all(Judged::is_bounded) {
            return Ok(Choice {
                why: why(
                    &bounds,
                    model_levels.last() == Some(&model_level),
                    is_undisturbed(checked),
                ),
                model_level,
                judged,
                resolution,
            });
        }
    }
    let top = model_levels.last().copied().unwrap_or(Fidelity::Kinematic);
    Ok(Choice {
        model_level: top,
        why: "no model is accurate to the scene's tolerances by calculation; this is the most detailed one for which the scene has data".to_owned(),
        judged: judge(Some(&bounds), &questions, top, resolution),
        resolution,
    })
}

/// Returns the part of a model level's error text that says which data to give.
fn what_is_needed(problem: &str) -> &str {
    let given = problem.split("so give ").nth(1).unwrap_or(problem);
    given.split(", or let fidelity").next().unwrap_or(given)
}

/// Returns the permitted relative error of oscillations, as far as it is known without a run. It makes at most [`STEP_PART`] of the
/// tightest tolerance, by the largest effect of torque on that output. It is at most a percent, as slipping depends on more than the
/// amplitude, and at least 1e-6, below which no difference shows.
fn resolution(bounds: &Bounds, questions: &Questions) -> f64 {
    let parts = Output::ALL.into_iter().filter_map(|output| {
        let whole = bounds.of(Fidelity::QuasiStatic, output)?;
        let tolerance = output.tolerance(questions)?;
        (output != Output::Slips).then_some(STEP_PART * tolerance / whole)
    });
    parts.fold(1e-2, f64::min).max(1e-6)
}

/// Returns the choice for a scene without questions.
fn without_questions(checked: &Checked) -> Choice {
    let (model_level, why) = checked.machine.level_without_questions();
    Choice {
        model_level,
        why: why.to_owned(),
        judged: Vec::new(),
        resolution: RESOLUTION,
    }
}

fn why(bounds: &Bounds, is_top: bool, is_undisturbed: bool) -> String {
    let reason = if is_top {
        "every simpler model may be off by more than the scene's tolerances, by calculation"
    } else {
        "the simplest one that is accurate to the scene's tolerances, by calculation"
    };
    let without = if is_undisturbed {
        ""
    } else {
        " without the scene's faults and noise"
    };
    format!("{reason}{without}: {}", bounds.numbers())
}

/// Returns the model levels for which the scene has enough data, the lowest first.
pub fn available(checked: &Checked) -> Vec<Fidelity> {
    LADDER
        .into_iter()
        .filter(|&model_level| checked.on(model_level).is_ok())
        .collect()
}
