//! How short a method's step has to be: it is halved until half of it changes no answer any more.

use super::check::run;
use super::choice::Judged;
use super::choose::STEP_PART;
use super::{Answers, Output};
use crate::machine::Machine;
use crate::scene::file::Questions;
use crate::scene::{Checked, SceneError};

/// Steps are halved so often at most: what they still change then is not a matter of the step.
const MOST_HALVINGS: u32 = 6;

/// A method of order 1 is off by twice what half its step changes, and those of higher orders by less than that.
const OF_HALF_A_STEP: f64 = 2.0;

/// A scene on a model level, with a step that is short enough.
pub(super) struct Settled {
    /// How often the step that theory has was halved.
    pub halvings: u32,
    /// What the scene comes to.
    pub answers: Answers,
    /// Whether a motor fell out of step, with this step or with half of it.
    pub has_slipped: bool,
    /// What it comes to with half the step; none where nothing is integrated.
    finer: Option<Answers>,
    /// Whether half the step changes no answer by more than its part of the tolerance; always so of a step of the scene's own, which
    /// is as good as it is.
    is_short: bool,
}

/// Halves the step until half of it changes no answer by more than [`STEP_PART`] of its tolerance. A step of the scene's own stays.
pub(super) fn settle(mut checked: Checked, questions: &Questions) -> Result<Settled, SceneError> {
    let is_integrated = Machine::new(&checked)?.method().is_some();
    let is_imposed = !checked.chosen().is_open();
    let mut settled = Settled {
        halvings: checked.halvings,
        answers: run(&checked)?,
        has_slipped: false,
        finer: None,
        is_short: true,
    };
    settled.has_slipped = settled.answers.has_slipped();
    while is_integrated {
        checked.halvings += 1;
        let finer = run(&checked)?;
        settled.has_slipped |= finer.has_slipped();
        settled.finer = Some(finer);
        settled.is_short = is_imposed || settled.is_short_for(questions);
        if settled.is_short || settled.halvings == MOST_HALVINGS {
            break;
        }
        settled.halvings = checked.halvings;
        settled.answers = finer;
    }
    Ok(settled)
}

impl Settled {
    fn step_error(&self, output: Output) -> Option<f64> {
        let both = self.answers.of(output).zip(self.finer?.of(output));
        both.map(|(found, finer)| output.difference(found, finer))
    }

    fn is_short_for(&self, questions: &Questions) -> bool {
        Output::ALL.into_iter().all(|output| {
            // With a slip, a shorter step may well be followed by another: which motors slip is all that can be compared.
            let is_compared = output == Output::Slips || !self.has_slipped;
            let allowed = output.tolerance(questions).filter(|_| is_compared);
            let both = allowed.zip(self.step_error(output));
            both.is_none_or(|(tolerance, error)| error <= STEP_PART * tolerance)
        })
    }

    /// Puts the step's errors beside bounds, and adds them.
    pub fn add_steps(&self, judged: &mut [Judged]) {
        if self.finer.is_none() {
            return;
        }
        for judged in judged {
            judged.step_error = self.step_error(judged.output);
            let is_known = self.is_short && !self.has_slipped;
            let both = judged.bound.zip(judged.step_error).filter(|_| is_known);
            judged.bound = both.map(|(bound, error)| bound + OF_HALF_A_STEP * error);
        }
    }
}
