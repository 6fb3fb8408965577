//! Whether the model level that was chosen does, by running a sample of the scene on it and on others.

use super::choice::{Choice, Judged};
use super::choose::{available, judge, questions};
use super::{Answers, Bounds, Output, sample};
use crate::scene::file::Fidelity;
use crate::scene::{Checked, SceneError};
use crate::sim::simulate;

/// A model level below the chosen one is taken if the sample shows no more of a difference than this part of each tolerance: what
/// the rest of the scene may add has the other part.
const WELL_WITHIN: f64 = 0.5;

/// The sample of a scene, run on one of its model levels.
///
/// # Errors
/// The scene lacks what the model level needs.
pub fn answers(checked: &Checked, model_level: Fidelity) -> Result<Answers, SceneError> {
    let mut sample = sample::of(&checked.scene);
    sample.fidelity = model_level;
    let mut sample = Checked::new(sample)?;
    sample.resolution = checked.resolution;
    let mut answers = Answers::default();
    simulate(&sample, &mut answers, |_, _| {})?;
    Ok(answers)
}

/// A scene on the model level that its sample bears out. It is the same as before if the scene itself requires a model level, or nothing.
///
/// # Errors
/// A model level that cannot be run after all.
pub fn check(mut checked: Checked) -> Result<Checked, SceneError> {
    let Some(choice) = checked.choice.take_if(|choice| !choice.judged.is_empty()) else {
        return Ok(checked);
    };
    let model_levels = available(&checked);
    let questions = questions(&checked);
    let bounds = Bounds::new(&checked).ok();
    let judge = |model_level| judge(bounds.as_ref(), &questions, model_level, choice.resolution);
    // Both runs have the steps that the scene asks for: what these are off by, no sample shows.
    let imposed = bounds.as_ref().and_then(Bounds::imposed);
    let Some((&top, below)) = model_levels.split_last() else {
        checked.choice = Some(choice);
        return Ok(checked);
    };
    let is_lowest = below.first() == Some(&choice.model_level);
    if is_lowest && is_undisturbed(&checked) && judge(choice.model_level).iter().all(is_plain) {
        checked.choice = Some(choice);
        return Ok(checked);
    }
    let right = answers(&checked, top)?;
    // The lowest first: bounds are wide.
    for &model_level in below {
        let mut judged = judge(model_level);
        compare(&mut judged, &answers(&checked, model_level)?, &right, top);
        let is_fair = |judged: &Judged| {
            let is_known = judged.is_bounded() || imposed.is_none() && is_borne_out(judged);
            is_known && !is_denied(judged)
        };
        if judged.iter().all(is_fair) {
            return Ok(taken(checked, &choice, model_level, judged));
        }
    }
    let judged = judge(top);
    Ok(taken(checked, &choice, top, judged))
}

/// Whether the bound alone is enough for the lowest model level, which no sample can lower.
fn is_plain(judged: &Judged) -> bool {
    let bound = judged.bound.unwrap_or(f64::INFINITY);
    bound <= WELL_WITHIN * judged.tolerance
}

/// Whether nothing happens to the machine that bounds do not know of.
fn is_undisturbed(checked: &Checked) -> bool {
    checked.scene.fault.is_empty() && checked.scene.noise.load_nm == 0.0
}

/// Whether the sample shows an output to be well within its tolerance, where it may say so at all.
fn is_borne_out(judged: &Judged) -> bool {
    // Where nothing bounds it, and with a slip, what comes a turn after the sample is another answer altogether.
    let may_say = judged.output != Output::Slips && judged.bound.is_some_and(f64::is_finite);
    may_say
        && judged
            .measured
            .is_some_and(|(off, _)| off <= WELL_WITHIN * judged.tolerance)
}

/// Whether the sample is farther off than is required, or than the bound has it.
fn is_denied(judged: &Judged) -> bool {
    judged.measured.is_none_or(|(off, _)| {
        off > judged.tolerance || judged.bound.is_some_and(|bound| off > bound)
    })
}

fn taken(
    mut checked: Checked,
    choice: &Choice,
    model_level: Fidelity,
    judged: Vec<Judged>,
) -> Checked {
    checked.fidelity = model_level;
    checked.choice = Some(Choice {
        model_level,
        why: why(choice, model_level),
        judged,
        resolution: choice.resolution,
    });
    checked
}

fn why(choice: &Choice, model_level: Fidelity) -> String {
    if model_level == choice.model_level {
        choice.why.clone()
    } else if model_level < choice.model_level {
        "its bounds go beyond what is required, but a sample of the scene differs from the top model level by less than half of each tolerance"
            .to_owned()
    } else {
        format!(
            "the model level that its bounds would allow, {}, was off by more than its tolerance, or its bound, in a sample of the scene",
            choice.model_level.name()
        )
    }
}

/// A scene with the values that its run has for what was requested.
#[must_use]
pub fn answered(mut checked: Checked, answers: &Answers) -> Checked {
    let judged = checked
        .choice
        .iter_mut()
        .flat_map(|choice| &mut choice.judged);
    for judged in judged {
        let value = answers.of(judged.output);
        judged.value = match judged.output {
            Output::Slips => value.map(|axes| f64::from((axes as u64).count_ones())),
            _ => value,
        };
    }
    checked
}

/// Puts how far a run's answers are off another's, on the model level `against`, beside each bound.
pub fn compare(judged: &mut [Judged], found: &Answers, right: &Answers, against: Fidelity) {
    for judged in judged {
        let output = judged.output;
        let both = found.of(output).zip(right.of(output));
        judged.measured = both.map(|(found, right)| (output.difference(found, right), against));
    }
}
