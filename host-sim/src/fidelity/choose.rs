//! Which model level, by what is known without a run.

use super::choice::{Choice, Judged};
use super::{Bounds, Output};
use crate::machine::RESOLUTION;
use crate::scene::file::{Fidelity, Questions};
use crate::scene::{Checked, SceneError};

/// Part of each tolerance that the method's step may use up.
pub(super) const STEP_PART: f64 = 0.1;

/// All model levels, the lowest first.
pub const LADDER: [Fidelity; 5] = [
    Fidelity::Kinematic,
    Fidelity::QuasiStatic,
    Fidelity::Rigid,
    Fidelity::Phased,
    Fidelity::Elastic,
];

/// What a scene asks: what it declares, or else whether its motors keep step, if it says what they can.
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

/// How well a model level answers what is required, with a method of that resolution.
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

/// The lowest model level whose bounds are within what is required, of those that a scene says enough for. The level is chosen as if
/// nothing disturbed the machine; if something does, no bound is claimed.
///
/// # Errors
/// A question that only model levels answer for which the scene lacks something.
pub fn choose(checked: &Checked) -> Result<Choice, SceneError> {
    let mut choice = choose_undisturbed(checked)?;
    if !is_undisturbed(checked) {
        for judged in &mut choice.judged {
            judged.bound = None;
        }
    }
    Ok(choice)
}

/// True if nothing happens to the machine that bounds do not know of.
pub(super) fn is_undisturbed(checked: &Checked) -> bool {
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
        // Of servos the torques cannot be compared without rotors.
        Err(_) if checked.scene.questions.is_none() && checked.scene.axes.pull_out.is_empty() => {
            return Ok(without_questions(checked));
        }
        // Nothing was requested explicitly: the torques are compared, and that is said.
        Err(_) if checked.scene.questions.is_none() => {
            return Ok(Choice {
                model_level: Fidelity::QuasiStatic,
                why: "the scene gives the motors' pull-out torque, so whether they keep in step is required; what oscillation \
                      adds to torque is not known, as it gives no rotor inertia"
                    .to_owned(),
                judged: judge(None, &questions, Fidelity::QuasiStatic, RESOLUTION),
                resolution: RESOLUTION,
            });
        }
        // Nothing is lacking: what it says of the method, or of cranks apart, does not go.
        Err(wrong)
            if ["method", "axes.offset_deg", "axes.ratio"]
                .iter()
                .any(|key| wrong.key.starts_with(key)) =>
        {
            return Err(wrong);
        }
        Err(lacking) => {
            let requested = judge(None, &questions, Fidelity::Rigid, RESOLUTION);
            let key = requested.first().map_or("", |judged| judged.output.key());
            return Err(SceneError::at(
                format!("questions.{key}"),
                format!(
                    "cannot be answered: {} is needed for that ({}); give it, or leave the question out",
                    lacking.key,
                    what_is_needed(&lacking.problem)
                ),
            ));
        }
    };
    // A method or step of the scene's own is as good as it is.
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
                    model_level,
                    model_levels.last() == Some(&model_level),
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
        why: "no model level's bounds are within what is required; this is the highest that the scene says enough for".to_owned(),
        judged: judge(Some(&bounds), &questions, top, resolution),
        resolution,
    })
}

/// Part of a model level's error text that says what to give, without what it says of the model level.
fn what_is_needed(problem: &str) -> &str {
    let given = problem.split("so give ").nth(1).unwrap_or(problem);
    given.split(", or let fidelity").next().unwrap_or(given)
}

/// How well a method has to follow what swings, as far as that is known without a run: to [`STEP_PART`] of the tightest tolerance, by
/// what torque does to that output at most. Never worse than a percent, as what slips is a matter of more than its size, nor better than
/// is ever seen.
fn resolution(bounds: &Bounds, questions: &Questions) -> f64 {
    let parts = Output::ALL.into_iter().filter_map(|output| {
        let whole = bounds.of(Fidelity::QuasiStatic, output)?;
        let tolerance = output.tolerance(questions)?;
        (output != Output::Slips).then_some(STEP_PART * tolerance / whole)
    });
    parts.fold(1e-2, f64::min).max(1e-6)
}

/// Nothing is required: cranks are where commanded, and followers, where the scene gives their masses and springs, what these
/// make of the law.
fn without_questions(checked: &Checked) -> Choice {
    let gives = checked.cam.is_some_and(|cam| cam.links.is_some());
    let (model_level, why) = if gives {
        (
            Fidelity::Elastic,
            "the scene gives the followers' masses and springs, so what these make of the law is required",
        )
    } else if checked.cam.is_some() {
        (
            Fidelity::Kinematic,
            "the scene says nothing of what gives between cam and pusher, so only phases and the law are required",
        )
    } else {
        (
            Fidelity::Kinematic,
            "the scene asks nothing of torque, so only phases and what follows from them are required",
        )
    };
    Choice {
        model_level,
        why: why.to_owned(),
        judged: Vec::new(),
        resolution: RESOLUTION,
    }
}

fn why(bounds: &Bounds, model_level: Fidelity, is_top: bool) -> String {
    let numbers = bounds.numbers();
    if is_top {
        format!("the model levels below may be off by more than is required: {numbers}")
    } else {
        let name = model_level.name();
        format!("what {name} leaves out stays within the tolerances: {numbers}")
    }
}

/// Model levels that the scene says enough for, the lowest first.
pub fn available(checked: &Checked) -> Vec<Fidelity> {
    LADDER
        .into_iter()
        .filter(|&model_level| checked.on(model_level).is_ok())
        .collect()
}
