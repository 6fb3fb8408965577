//! Whether the rung that was chosen does, by running a sample of the scene on it and on others.

use super::choose::{available, judge, questions};
use super::{Answers, Bounds, Choice, Judged, Output, sample};
use crate::scene::file::Fidelity;
use crate::scene::{Checked, SceneError};
use crate::sim::simulate;
use crate::with_axes;

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
    with_axes!(sample.scene.axes.count, N => {
        let mut answers = Answers::default();
        simulate::<N>(&sample, &mut answers, |_, _| {})?;
        Ok(answers)
    })
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
    let place = rungs.iter().position(|&rung| rung == choice.rung);
    let mut runs = Runs::default();
    for ceiling in place.unwrap_or(0)..rungs.len() {
        let knows = |rung: Fidelity| {
            let judged = judge(bounds.as_ref(), &questions, rung, choice.resolution);
            moves(rung) && judged.iter().all(Judged::is_bounded)
        };
        let above = &rungs[ceiling + 1..];
        let knowing = above.iter().find(|&&rung| knows(rung));
        // Where none is bounded, the top knows best.
        let against = *knowing.or(above.last()).unwrap_or(&rungs[ceiling]);
        let right = runs.answers(&checked, against)?;
        // The lowest first: bounds are wide.
        for &rung in &rungs[..=ceiling] {
            let mut judged = judge(bounds.as_ref(), &questions, rung, choice.resolution);
            if rung != against {
                compare(&mut judged, &runs.answers(&checked, rung)?, &right, against);
            }
            let part = if rung < choice.rung { WELL_WITHIN } else { 1.0 };
            let is_off = |judged: &Judged| {
                // A slip that comes a turn after the sample is another answer altogether: there only the bound counts.
                let is_guess = judged.output == Output::Slips && !judged.is_bounded();
                let measured = judged.measured;
                is_guess || measured.is_none_or(|(off, _)| off > part * judged.tolerance)
            };
            if rung == against || !judged.iter().any(is_off) {
                let why = why(&choice, rung, against);
                checked.fidelity = rung;
                checked.why.clone_from(&why);
                checked.choice = Some(Choice {
                    rung,
                    why,
                    judged,
                    ..choice
                });
                return Ok(checked);
            }
        }
    }
    checked.choice = Some(choice);
    Ok(checked)
}

/// Whether torque moves the cranks. Quasi-static ones go where kinematic ones do: they cannot tell each other wrong.
fn moves(rung: Fidelity) -> bool {
    rung >= Fidelity::Rigid
}

fn why(choice: &Choice, rung: Fidelity, against: Fidelity) -> String {
    let other = against.name();
    if rung == choice.rung {
        choice.why.clone()
    } else if rung < choice.rung {
        format!(
            "its bounds go beyond what is asked, but a sample of the scene differs from {other} by less than half of each tolerance"
        )
    } else {
        format!(
            "the rung that its bounds would allow, {}, was off by more than its tolerance in a sample of the scene",
            choice.rung.name()
        )
    }
}

fn compare(judged: &mut [Judged], found: &Answers, right: &Answers, against: Fidelity) {
    for judged in judged {
        let output = judged.output;
        let both = found.of(output).zip(right.of(output));
        judged.measured = both.map(|(found, right)| (output.difference(found, right), against));
    }
}

/// Samples that were run, so that none is run twice.
#[derive(Default)]
struct Runs(Vec<(Fidelity, Answers)>);

impl Runs {
    fn answers(&mut self, checked: &Checked, rung: Fidelity) -> Result<Answers, SceneError> {
        if let Some((_, answers)) = self.0.iter().find(|(run, _)| *run == rung) {
            return Ok(*answers);
        }
        let found = answers(checked, rung)?;
        self.0.push((rung, found));
        Ok(found)
    }
}
