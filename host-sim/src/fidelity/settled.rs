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

/// Answers of a scene on a model level, and how much of them is due to the method's step.
pub(super) struct Settled {
    checked: Checked,
    /// Its answers.
    pub answers: Answers,
    /// All is regular, with this step and with half of it.
    pub is_regular: bool,
    /// Answers with half the step; none before that was run, and where nothing is integrated.
    finer: Option<Answers>,
    /// Half the step changes no answer by more than its part of the tolerance; always so of a step of the scene's own, which
    /// is as good as it is.
    is_short: bool,
}

impl Settled {
    /// With the step that the scene has.
    pub fn new(checked: Checked) -> Result<Self, SceneError> {
        let answers = run(&checked)?;
        Ok(Self {
            is_regular: answers.is_regular(),
            answers,
            finer: None,
            is_short: true,
            checked,
        })
    }

    /// How often the step that theory has was halved.
    pub fn halvings(&self) -> u32 {
        self.checked.halvings
    }

    /// The same with a step that is halved until half of it changes no answer by more than [`STEP_PART`] of its tolerance. A step of the
    /// scene's own stays.
    pub fn settled(mut self, questions: &Questions) -> Result<Self, SceneError> {
        if Machine::new(&self.checked)?.method().is_none() {
            return Ok(self);
        }
        let is_imposed = !self.checked.chosen().is_open();
        loop {
            let mut half = self.checked.clone();
            half.halvings += 1;
            let finer = run(&half)?;
            self.is_regular &= finer.is_regular();
            self.finer = Some(finer);
            self.is_short = is_imposed || self.is_short_for(questions);
            if self.is_short || self.halvings() == MOST_HALVINGS {
                return Ok(self);
            }
            self.checked = half;
            self.answers = finer;
        }
    }

    fn step_error(&self, output: Output) -> Option<f64> {
        let both = self.answers.of(output).zip(self.finer?.of(output));
        both.map(|(found, finer)| output.difference(found, finer))
    }

    fn is_short_for(&self, questions: &Questions) -> bool {
        Output::ALL.into_iter().all(|output| {
            // Otherwise which motors slip is all that can be compared.
            let is_compared = output == Output::Slips || self.is_regular;
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
            let is_known = self.is_short && self.is_regular;
            let both = judged.bound.zip(judged.step_error).filter(|_| is_known);
            judged.bound = both.map(|(bound, error)| bound + OF_HALF_A_STEP * error);
        }
    }
}
