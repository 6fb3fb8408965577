//! Check of the chosen model level: runs a sample of the scene on it and on other levels.

use cophase_scene::SceneError;
use cophase_scene::file::{Fidelity, Questions};

use super::settled::Settled;
use super::{Answers, sample};
use crate::checked::Checked;
use crate::checked::{Choice, Judged};
use crate::model_level::Bounds;
use crate::model_level::{STEP_PART, available, is_undisturbed, judge, questions};
use crate::output::Output;
use crate::sim::simulate;

/// Part of each tolerance that the difference in a sample may use, if it is to confirm a model level. The other part is for the rest
/// of the scene.
const WELL_WITHIN: f64 = 0.5;

/// Runs the sample of a scene on one of its model levels.
///
/// # Errors
/// The scene lacks what the model level needs.
pub fn answers(checked: &Checked, model_level: Fidelity) -> Result<Answers, SceneError> {
    run(&sample::on(checked, model_level)?)
}

/// Runs a scene, and returns its answers.
pub(super) fn run(checked: &Checked) -> Result<Answers, SceneError> {
    let mut answers = Answers::default();
    simulate(checked, &mut answers, |_, _| {})?;
    Ok(answers)
}

/// Returns a scene with the model level and the step that its sample confirms. The scene is unchanged if it sets its model level, or
/// has no questions.
///
/// # Errors
/// A model level cannot be run.
pub fn check(mut checked: Checked) -> Result<Checked, SceneError> {
    let Some(choice) = checked.choice.take_if(|choice| !choice.judged.is_empty()) else {
        return Ok(checked);
    };
    let model_levels = available(&checked);
    let levels = model_levels.split_last();
    let Some((&top, below)) = levels.filter(|_| needs_sample(&choice, &model_levels)) else {
        checked.choice = Some(choice);
        return Ok(checked);
    };
    let trial = Trial::new(&checked);
    let right = Settled::from_coarse(sample::on(&checked, top)?, &trial.questions)?;
    // The lowest first, as bounds are wide.
    for &model_level in below {
        let mut judged = trial.judge(model_level);
        let first = Settled::new(sample::on(&checked, model_level)?)?;
        compare(&mut judged, &first.answers, &right.answers, top);
        if !judged.iter().all(|judged| trial.is_fair(judged, &right)) {
            continue;
        }
        let found = first.settled(&trial.questions)?;
        found.add_steps(&mut judged);
        let why = trial.why(&choice, model_level);
        return Ok(taken(checked, choice, why, model_level, judged, &found));
    }
    let right = right.fine(&trial.questions)?;
    let mut judged = trial.judge(top);
    right.add_steps(&mut judged);
    let why = trial.why(&choice, top);
    Ok(taken(checked, choice, why, top, judged, &right))
}

/// Evidence from the sample of a scene.
struct Trial {
    questions: Questions,
    /// Bounds of the scene's machine; `None` for a disturbed machine.
    bounds: Option<Bounds>,
    resolution: f64,
    /// True if the sample is the whole scene.
    is_whole: bool,
    /// True if the scene sets the method. Then both runs have the same steps, and the sample does not show the errors of these.
    is_imposed: bool,
}

impl Trial {
    fn new(checked: &Checked) -> Self {
        Self {
            questions: questions(checked),
            is_imposed: !checked.chosen().is_open(),
            bounds: Bounds::new(checked)
                .ok()
                .filter(|_| is_undisturbed(checked)),
            resolution: checked.resolution,
            is_whole: sample::from_scene(&checked.scene) == checked.scene,
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

    /// Returns true if an output is known to be within its tolerance, and the sample does not contradict that.
    fn is_fair(&self, judged: &Judged, right: &Settled) -> bool {
        let is_known = judged.is_bounded() || !self.is_imposed && self.is_borne_out(judged, right);
        is_known && !is_denied(judged)
    }

    /// Returns true if the sample is evidence, and shows an output to be well within its tolerance.
    fn is_borne_out(&self, judged: &Judged, right: &Settled) -> bool {
        // A part of a scene is not evidence for an output without a bound, and not for motors that slip in the rest of the scene.
        let is_evidence = self.is_whole || judged.output != Output::Slips && judged.bound.is_some();
        // After a motor has slipped, runs are not comparable.
        right.is_regular
            && is_evidence
            && judged
                .measured
                .is_some_and(|(off, _)| off <= self.well_within() * judged.tolerance)
    }

    /// Returns the part of a tolerance that a difference in the sample may use.
    fn well_within(&self) -> f64 {
        if self.is_whole {
            1.0 - STEP_PART
        } else {
            WELL_WITHIN
        }
    }

    fn why(&self, choice: &Choice, model_level: Fidelity) -> String {
        if model_level == choice.model_level {
            choice.why.clone()
        } else if model_level < choice.model_level {
            format!(
                "its error may exceed the scene's tolerances by calculation, but a sample run differs from the most detailed model \
                 by less than {:.0} % of each tolerance",
                100.0 * self.well_within()
            )
        } else {
            format!(
                "the {} model would be accurate enough by calculation, but in a sample run its error exceeded a tolerance, or its \
                 calculated limit",
                choice.model_level.name()
            )
        }
    }
}

/// Returns false if a sample cannot change the choice: there is one model level only, or the bounds of the lowest are sufficient.
pub(super) fn needs_sample(choice: &Choice, model_levels: &[Fidelity]) -> bool {
    let is_plain = |judged: &Judged| {
        judged
            .bound
            .is_some_and(|bound| bound <= WELL_WITHIN * judged.tolerance)
    };
    let is_lowest = model_levels.first() == Some(&choice.model_level);
    !(is_lowest && (model_levels.len() == 1 || choice.judged.iter().all(is_plain)))
}

/// Returns true if the difference in the sample exceeds the tolerance, or the bound.
fn is_denied(judged: &Judged) -> bool {
    judged.measured.is_none_or(|(off, _)| {
        off > judged.tolerance || judged.bound.is_some_and(|bound| off > bound)
    })
}

fn taken(
    mut checked: Checked,
    choice: Choice,
    why: String,
    model_level: Fidelity,
    judged: Vec<Judged>,
    settled: &Settled,
) -> Checked {
    checked.fidelity = model_level;
    checked.halvings = settled.halvings();
    checked.choice = Some(Choice {
        why,
        model_level,
        judged,
        ..choice
    });
    checked
}

/// Returns a scene with the values of its run for each requested output. Bounds hold only for a regular run.
#[must_use]
pub fn answered(mut checked: Checked, answers: &Answers) -> Checked {
    let judged = checked
        .choice
        .iter_mut()
        .flat_map(|choice| &mut choice.judged);
    for judged in judged {
        judged.bound = judged.bound.filter(|_| answers.is_regular());
        let value = answers.of(judged.output);
        judged.value = match judged.output {
            Output::Slips => value.map(|axes| f64::from((axes as u64).count_ones())),
            _ => value,
        };
    }
    checked
}

/// Adds the difference between a run's answers and those of another run, on the model level `against`, to each bound.
pub fn compare(judged: &mut [Judged], found: &Answers, right: &Answers, against: Fidelity) {
    for judged in judged {
        let output = judged.output;
        let both = found.of(output).zip(right.of(output));
        judged.measured = both.map(|(found, right)| (output.difference(found, right), against));
    }
}
