//! Whether the model level that was chosen does, by running a sample of the scene on it and on others; and whether the method's
//! step does, by running the sample with half of it.

use super::choice::{Choice, Judged};
use super::choose::{STEP_PART, available, judge, questions};
use super::{Answers, Bounds, Output, sample};
use crate::machine::Machine;
use crate::scene::file::{Fidelity, Questions};
use crate::scene::{Checked, SceneError};
use crate::sim::simulate;

/// A model level below the chosen one is taken if the sample shows no more of a difference than this part of each tolerance: what
/// the rest of the scene may add has the other part.
const WELL_WITHIN: f64 = 0.5;

/// Steps are halved so often at most: what they still change then is not a matter of the step.
const MOST_HALVINGS: u32 = 6;

/// A method of order 1 is off by twice what half its step changes, and those of higher orders by less than that.
const OF_HALF_A_STEP: f64 = 2.0;

/// The sample of a scene, run on one of its model levels.
///
/// # Errors
/// The scene lacks what the model level needs.
pub fn answers(checked: &Checked, model_level: Fidelity) -> Result<Answers, SceneError> {
    let mut sample = sample::of(&checked.scene);
    sample.fidelity = model_level;
    let mut sample = Checked::new(sample)?;
    sample.resolution = checked.resolution;
    sample.halvings = checked.halvings;
    let mut answers = Answers::default();
    simulate(&sample, &mut answers, |_, _| {})?;
    Ok(answers)
}

/// A scene on the model level, and with the step, that its sample bears out. It is the same as before if the scene itself requires a
/// model level, or nothing.
///
/// # Errors
/// A model level that cannot be run after all.
pub fn check(mut checked: Checked) -> Result<Checked, SceneError> {
    let Some(choice) = checked.choice.take_if(|choice| !choice.judged.is_empty()) else {
        return Ok(checked);
    };
    let sampled = Sampled::new(&checked, choice.resolution);
    let model_levels = available(&checked);
    let Some((&top, below)) = model_levels.split_last() else {
        checked.choice = Some(choice);
        return Ok(checked);
    };
    let is_lowest = below.first() == Some(&choice.model_level);
    if is_lowest && sampled.judge(choice.model_level).iter().all(is_plain) {
        checked.choice = Some(choice);
        return Ok(checked);
    }
    let right = answers(&checked, top)?;
    // The lowest first: bounds are wide.
    for &model_level in below {
        let mut judged = sampled.judge(model_level);
        let found = answers(&checked, model_level)?;
        compare(&mut judged, &found, &right, top);
        if judged.iter().all(|judged| sampled.is_fair(judged)) {
            return with_short_steps(taken(checked, &choice, model_level, judged), found);
        }
    }
    let judged = sampled.judge(top);
    with_short_steps(taken(checked, &choice, top, judged), right)
}

/// What the sample of a scene is evidence of.
struct Sampled {
    questions: Questions,
    /// Bounds of the scene's machine; none where something happens to it that they do not know of.
    bounds: Option<Bounds>,
    resolution: f64,
    /// Whether the sample is all of the scene.
    is_whole: bool,
    /// Whether the method is the scene's own: both runs have its steps, so that the sample does not show what these are off by.
    is_imposed: bool,
}

impl Sampled {
    fn new(checked: &Checked, resolution: f64) -> Self {
        Self {
            questions: questions(checked),
            is_imposed: !checked.chosen().is_open(),
            bounds: Bounds::new(checked)
                .ok()
                .filter(|_| is_undisturbed(checked)),
            resolution,
            is_whole: sample::of(&checked.scene) == checked.scene,
        }
    }

    fn judge(&self, model_level: Fidelity) -> Vec<Judged> {
        judge(
            self.bounds.as_ref(),
            &self.questions,
            model_level,
            self.resolution,
        )
    }

    /// Whether an output is known to be within its tolerance, and no sample denies it.
    fn is_fair(&self, judged: &Judged) -> bool {
        let is_known = judged.is_bounded() || !self.is_imposed && self.is_borne_out(judged);
        is_known && !is_denied(judged)
    }

    /// Whether the sample shows an output to be well within its tolerance, where it may say so at all.
    fn is_borne_out(&self, judged: &Judged) -> bool {
        // Where nothing bounds it, and with a slip, what comes a turn after the sample is another answer altogether.
        let may_say = judged.output != Output::Slips && judged.bound.is_some();
        let part = match (self.is_whole, may_say) {
            (true, _) => 1.0,
            (false, true) => WELL_WITHIN,
            (false, false) => return false,
        };
        judged
            .measured
            .is_some_and(|(off, _)| off <= part * judged.tolerance)
    }
}

/// Whether the bound alone is enough for the lowest model level, which no sample can lower.
pub(super) fn is_plain(judged: &Judged) -> bool {
    judged
        .bound
        .is_some_and(|bound| bound <= WELL_WITHIN * judged.tolerance)
}

/// Whether nothing happens to the machine that bounds do not know of.
fn is_undisturbed(checked: &Checked) -> bool {
    checked.scene.fault.is_empty() && checked.scene.noise.load_nm == 0.0
}

/// Whether the sample is farther off than is required, or than the bound has it.
fn is_denied(judged: &Judged) -> bool {
    judged.measured.is_none_or(|(off, _)| {
        off > judged.tolerance || judged.bound.is_some_and(|bound| off > bound)
    })
}

/// A scene whose method's step is short enough for its tolerances: it is halved until half of it changes no answer over the sample by
/// more than [`STEP_PART`] of its tolerance. A step of the scene's own stays. `found` is what the sample comes to as it is.
fn with_short_steps(mut checked: Checked, mut found: Answers) -> Result<Checked, SceneError> {
    if Machine::new(&checked)?.method().is_none() {
        return Ok(checked);
    }
    let is_imposed = !checked.chosen().is_open();
    let each = |checked: &mut Checked, by: &mut dyn FnMut(&mut Judged)| {
        let judged = checked.choice.iter_mut();
        judged.flat_map(|choice| &mut choice.judged).for_each(by);
    };
    loop {
        checked.halvings += 1;
        let finer = answers(&checked, checked.fidelity)?;
        checked.halvings -= 1;
        // With a slip, a shorter step may well be followed by another slip: which motors do is all that can be compared.
        let has_slipped = [&found, &finer].iter().any(|answers| slipped(answers));
        let mut is_short = true;
        each(&mut checked, &mut |judged| {
            let both = found.of(judged.output).zip(finer.of(judged.output));
            judged.step_error = both.map(|(found, finer)| judged.output.difference(found, finer));
            let compared = judged.output == Output::Slips || !has_slipped;
            is_short &= !compared
                || judged
                    .step_error
                    .is_none_or(|off| off <= STEP_PART * judged.tolerance);
        });
        if is_short || is_imposed || checked.halvings == MOST_HALVINGS {
            each(&mut checked, &mut |judged| {
                let step_error = judged.step_error.filter(|_| is_short || is_imposed);
                judged.bound = judged
                    .bound
                    .filter(|_| judged.output == Output::Slips || !has_slipped)
                    .zip(step_error)
                    .map(|(bound, step_error)| bound + OF_HALF_A_STEP * step_error);
            });
            return Ok(checked);
        }
        checked.halvings += 1;
        found = finer;
    }
}

/// Whether a motor fell out of step.
fn slipped(answers: &Answers) -> bool {
    answers.of(Output::Slips).is_some_and(|axes| axes != 0.0)
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

/// A scene with the values that its run has for what was requested. A motor that slipped in the run voids the bounds, which are those
/// of motors that keep step.
#[must_use]
pub fn answered(mut checked: Checked, answers: &Answers) -> Checked {
    let judged = checked
        .choice
        .iter_mut()
        .flat_map(|choice| &mut choice.judged);
    let has_slipped = slipped(answers);
    for judged in judged {
        judged.bound = judged.bound.filter(|_| !has_slipped);
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
