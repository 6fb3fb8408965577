//! Whether the rung that was chosen does, by running a sample of the scene on it and on others.

use super::choice::{Choice, Judged};
use super::choose::{available, judge, questions};
use super::{Answers, Bounds, Output, sample};
use crate::scene::file::Fidelity;
use crate::scene::{Checked, SceneError};
use crate::sim::simulate;

/// A rung below the chosen one is taken if the sample shows no more of a difference than this part of each tolerance: what
/// the rest of the scene may add has the other part.
const WELL_WITHIN: f64 = 0.5;

/// The sample of a scene, run on one of its rungs.
///
/// # Errors
/// The scene lacks what the rung needs.
pub fn answers(checked: &Checked, rung: Fidelity) -> Result<Answers, SceneError> {
    let mut sample = sample::of(&checked.scene);
    sample.fidelity = rung;
    let mut sample = Checked::new(sample)?;
    sample.resolution = checked.resolution;
    let mut answers = Answers::default();
    simulate(&sample, &mut answers, |_, _| {})?;
    Ok(answers)
}

/// A scene on the rung that its sample bears out. It is the same as before if the scene itself asks for a rung, or for nothing.
///
/// # Errors
/// A rung that cannot be run after all.
pub fn check(mut checked: Checked) -> Result<Checked, SceneError> {
    let Some(choice) = checked.choice.take_if(|choice| !choice.judged.is_empty()) else {
        return Ok(checked);
    };
    let rungs = available(&checked);
    let questions = questions(&checked);
    let bounds = Bounds::new(&checked).ok();
    let judge = |rung| judge(bounds.as_ref(), &questions, rung, choice.resolution);
    // Both runs have the steps that the scene asks for: what these are off by, no sample shows.
    let imposed = bounds.as_ref().and_then(Bounds::imposed);
    let Some((&top, below)) = rungs.split_last() else {
        checked.choice = Some(choice);
        return Ok(checked);
    };
    let right = answers(&checked, top)?;
    // The lowest first: bounds are wide.
    for &rung in below {
        let mut judged = judge(rung);
        compare(&mut judged, &answers(&checked, rung)?, &right, top);
        let is_fair = |judged: &Judged| {
            let is_known = judged.is_bounded() || imposed.is_none() && is_borne_out(judged);
            is_known && !is_denied(judged)
        };
        if judged.iter().all(is_fair) {
            return Ok(taken(checked, &choice, rung, judged));
        }
    }
    let judged = judge(top);
    Ok(taken(checked, &choice, top, judged))
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

/// Whether the sample is farther off than is asked, or than the bound has it.
fn is_denied(judged: &Judged) -> bool {
    judged.measured.is_none_or(|(off, _)| {
        off > judged.tolerance || judged.bound.is_some_and(|bound| off > bound)
    })
}

fn taken(mut checked: Checked, choice: &Choice, rung: Fidelity, judged: Vec<Judged>) -> Checked {
    checked.fidelity = rung;
    checked.choice = Some(Choice {
        rung,
        why: why(choice, rung),
        judged,
        resolution: choice.resolution,
    });
    checked
}

fn why(choice: &Choice, rung: Fidelity) -> String {
    if rung == choice.rung {
        choice.why.clone()
    } else if rung < choice.rung {
        "its bounds go beyond what is asked, but a sample of the scene differs from the top rung by less than half of each tolerance"
            .to_owned()
    } else {
        format!(
            "the rung that its bounds would allow, {}, was off by more than its tolerance, or its bound, in a sample of the scene",
            choice.rung.name()
        )
    }
}

/// Puts how far a run's answers are off another's, on the rung `against`, beside each bound.
pub fn compare(judged: &mut [Judged], found: &Answers, right: &Answers, against: Fidelity) {
    for judged in judged {
        let output = judged.output;
        let both = found.of(output).zip(right.of(output));
        judged.measured = both.map(|(found, right)| (output.difference(found, right), against));
    }
}
