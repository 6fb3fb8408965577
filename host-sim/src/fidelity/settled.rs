//! Step length of a method: it is halved until half of it changes no answer.
//!
//! Answers for comparison alone are found from coarse to fine, from one step a tick on. A run keeps the step from theory at least: users
//! read its trace, too, and not only its answers.

use cophase_scene::SceneError;
use cophase_scene::file::Questions;

use super::Answers;
use super::check::run;
use crate::checked::Checked;
use crate::checked::Judged;
use crate::model_level::STEP_PART;
use crate::output::Output;
use crate::simulated_machine::SimulatedMachine;

/// Limit of halvings. A change that remains after that does not come from the step.
const MAX_HALVINGS: u32 = 6;

/// Factor from the change by half a step to the error of the step. It is 2 for a method of order 1, and less for higher orders.
const OF_HALF_A_STEP: f64 = 2.0;

/// Answers of a scene on a model level, and their errors by the method's step.
pub(super) struct Settled {
    /// The scene with its own step.
    checked: Checked,
    /// Answers of the scene.
    pub answers: Answers,
    /// True if the runs with this step and with the one compared with it are regular.
    pub is_regular: bool,
    /// True if the answers stand with a step that is longer than the scene's.
    is_coarse: bool,
    /// Answers with half the step; `None` before that run, and if nothing is integrated.
    finer: Option<Answers>,
    /// True if half the step changes no answer by more than its part of the tolerance. Always true for a step that the scene sets,
    /// which is not changed.
    is_short: bool,
}

impl Settled {
    /// Runs a scene with its own step.
    pub fn new(checked: Checked) -> Result<Self, SceneError> {
        let answers = run(&checked)?;
        Ok(Self {
            is_regular: answers.is_regular(),
            answers,
            is_coarse: false,
            finer: None,
            is_short: true,
            checked,
        })
    }

    /// Runs a scene with one step a tick, then with twice as many, until the answers stand. If they do not stand before the scene's own step,
    /// continues with that one as [`Settled::settled`]. A step that the scene sets is not changed.
    pub fn from_coarse(checked: Checked, questions: &Questions) -> Result<Self, SceneError> {
        if checked.chosen().is_open()
            && let Some(coarse) = Self::coarse(&checked, questions)?
        {
            return Ok(coarse);
        }
        Self::new(checked)?.settled(questions)
    }

    /// Returns answers that stand with at most the scene's own number of steps. `None` if there are none, or if a motor slips: the step may
    /// decide which one does.
    fn coarse(checked: &Checked, questions: &Questions) -> Result<Option<Self>, SceneError> {
        let Some((scheme, max)) = SimulatedMachine::new(checked)?.method() else {
            return Ok(None);
        };
        let mut longer: Option<Answers> = None;
        for steps in (0..)
            .map(|doubled| 1 << doubled)
            .take_while(|steps| *steps <= max)
        {
            let mut coarse = checked.clone();
            coarse.scene.method.steps_per_tick = Some(steps);
            // A long step may be unstable, and the choice of the method depends on the step.
            let is_possible = SimulatedMachine::new(&coarse)
                .is_ok_and(|machine| machine.method() == Some((scheme, steps)));
            if !is_possible {
                continue;
            }
            let answers = run(&coarse)?;
            if !answers.is_regular() {
                return Ok(None);
            }
            let pair = longer.replace(answers).map(|longer| Self {
                checked: checked.clone(),
                answers: longer,
                is_regular: true,
                is_coarse: true,
                finer: Some(answers),
                is_short: true,
            });
            // The shorter step is nearer to the truth.
            if let Some(pair) = pair.filter(|pair| pair.is_short_for(questions)) {
                return Ok(Some(Self { answers, ..pair }));
            }
        }
        Ok(None)
    }

    /// Returns the answers with the scene's own step or a shorter one, whose errors are known.
    pub fn fine(self, questions: &Questions) -> Result<Self, SceneError> {
        if self.is_coarse {
            return Self::new(self.checked)?.settled(questions);
        }
        Ok(self)
    }

    /// Returns how often the step from theory was halved.
    pub fn halvings(&self) -> u32 {
        self.checked.halvings
    }

    /// Halves the step until half of it changes no answer by more than [`STEP_PART`] of its tolerance. A step that the scene sets is
    /// not changed.
    pub fn settled(mut self, questions: &Questions) -> Result<Self, SceneError> {
        if SimulatedMachine::new(&self.checked)?.method().is_none() {
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
            if self.is_short || self.halvings() == MAX_HALVINGS {
                return Ok(self);
            }
            self.checked = half;
            self.answers = finer;
        }
    }

    /// Returns the change of an answer by half the step.
    fn change(&self, output: Output) -> Option<f64> {
        let both = self.answers.of(output).zip(self.finer?.of(output));
        both.map(|(found, finer)| output.difference(found, finer))
    }

    /// Returns the error of an answer by the step: of the method, and by a peak between the ends of two steps. The peaks of both runs
    /// may be hidden equally, so the change does not show the second.
    fn step_error(&self, output: Output) -> Option<f64> {
        let (found, change) = self.answers.of(output).zip(self.change(output))?;
        let peak = output.difference(found + self.answers.hidden(output), found);
        Some(OF_HALF_A_STEP * change + peak)
    }

    fn is_short_for(&self, questions: &Questions) -> bool {
        Output::ALL.into_iter().all(|output| {
            // Otherwise only the set of slipping motors can be compared.
            let is_compared = output == Output::Slips || self.is_regular;
            let allowed = output.tolerance(questions).filter(|_| is_compared);
            let both = allowed.zip(self.change(output));
            both.is_none_or(|(tolerance, change)| change <= STEP_PART * tolerance)
        })
    }

    /// Adds the errors of the step to the bounds.
    pub fn add_steps(&self, judged: &mut [Judged]) {
        if self.finer.is_none() {
            return;
        }
        for judged in judged {
            judged.step_error = self.step_error(judged.output);
            let is_known = self.is_short && self.is_regular;
            let both = judged.bound.zip(judged.step_error).filter(|_| is_known);
            judged.bound = both.map(|(bound, error)| bound + error);
        }
    }
}
