//! A step of a method on a machine with dry friction: it ends where a contact changes, and goes on from there.

use nalgebra::DMatrix;

use crate::equations::{Equations, Linear};
use crate::friction::{Contact, Contacts, DryFriction, EVENT_LIMIT, MAX_CONTACTS, Response};
use crate::rule::Rule;
use crate::{Needs, StepError};

/// Limit of iterations to locate an event.
const LOCATE_LIMIT: u32 = 60;

/// Uncertainty of the moment of an event, as a part of the step.
const LOCATE_PART: f64 = 1e-13;

/// Least distance from the ends of an interval at which it is divided, as a part of it.
const MARGIN: f64 = 1e-6;

/// Smooth equations: those of a machine whose contacts do not change.
struct Frozen<'a> {
    equations: &'a dyn Equations,
    machine: &'a dyn DryFriction,
    contacts: Contacts,
    zeros: &'a [f64],
}

impl Equations for Frozen<'_> {
    fn dimension(&self) -> usize {
        self.equations.dimension()
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        self.machine.rates_with(t_s, y, &self.contacts, rates);
    }

    fn is_second_order(&self) -> bool {
        self.equations.is_second_order()
    }

    fn linear(&self) -> Option<&dyn Linear> {
        self.equations.linear().is_some().then_some(self)
    }
}

/// While contacts do not change, a linear machine stays linear: a contact that sticks takes its speed out of the matrix.
impl Linear for Frozen<'_> {
    fn matrix(&self) -> DMatrix<f64> {
        let n = self.dimension();
        let mut matrix = DMatrix::zeros(n, n);
        let (mut y, mut input) = (vec![0.0; n], vec![0.0; n]);
        self.input(0.0, &mut input);
        for column in 0..n {
            y[column] = 1.0;
            self.rates(0.0, &y, matrix.column_mut(column).as_mut_slice());
            y[column] = 0.0;
            for (entry, input) in matrix.column_mut(column).iter_mut().zip(&input) {
                *entry -= input;
            }
        }
        matrix
    }

    fn input(&self, t_s: f64, input: &mut [f64]) {
        self.rates(t_s, self.zeros, input);
    }
}

/// Memory for steps with dry friction.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    start: Vec<f64>,
    rates: Vec<f64>,
    zeros: Vec<f64>,
    /// Step and contacts for which the rule has its matrix, if it has one; `None` before the first step.
    fitted: Option<(f64, Contacts)>,
}

impl Memory {
    pub fn new(dimension: usize) -> Self {
        Self {
            start: vec![0.0; dimension],
            rates: vec![0.0; dimension],
            zeros: vec![0.0; dimension],
            fitted: None,
        }
    }
}

/// A step of a rule on a machine with dry friction.
pub(crate) struct Step<'a, R> {
    pub rule: &'a mut R,
    pub memory: &'a mut Memory,
    pub equations: &'a dyn Equations,
    pub machine: &'a dyn DryFriction,
}

impl<R: Rule> Step<'_, R> {
    /// Writes the state at `t_s` + `h` into `next`, from the state `y` at `t_s`.
    pub fn make(&mut self, t_s: f64, h: f64, y: &[f64], next: &mut [f64]) -> Result<(), StepError> {
        // In most steps of a machine that turns, all contacts slide and go on to slide.
        let contacts = Contacts::in_state(self.machine, t_s, y, &mut self.memory.rates);
        if !contacts.contains(&Contact::Sticks) {
            self.advance(&contacts, t_s, h, y, next)?;
            let slides = |(contact, &speed): (&Contact, &usize)| match contact {
                Contact::Backwards => next[speed] <= 0.0,
                _ => next[speed] >= 0.0,
            };
            if contacts.iter().zip(self.machine.speeds()).all(slides) {
                return Ok(());
            }
        }
        self.make_in_parts(t_s, h, y, next)
    }

    /// Makes the same step in parts that end where a contact changes.
    #[cold]
    fn make_in_parts(
        &mut self,
        t_s: f64,
        h: f64,
        y: &[f64],
        next: &mut [f64],
    ) -> Result<(), StepError> {
        let mut start = core::mem::take(&mut self.memory.start);
        start.copy_from_slice(y);
        let made = self.make_parts(t_s, h, &mut start, next);
        self.memory.start = start;
        made
    }

    fn make_parts(
        &mut self,
        t_s: f64,
        h: f64,
        start: &mut [f64],
        next: &mut [f64],
    ) -> Result<(), StepError> {
        let mut from = 0.0;
        for _ in 0..EVENT_LIMIT {
            let contacts =
                Contacts::in_state(self.machine, t_s + from, start, &mut self.memory.rates);
            let rest = h - from;
            self.advance(&contacts, t_s + from, rest, start, next)?;
            let slack = self.slack(&contacts, t_s + h, next);
            if !slack.iter().any(|slack| *slack < 0.0) {
                return Ok(());
            }
            let (length, slack) = self.locate(&contacts, t_s + from, rest, slack, start, next)?;
            self.stop(&contacts, &slack, next);
            from += length;
            if h - from <= LOCATE_PART * h {
                return Ok(());
            }
            start.copy_from_slice(next);
        }
        let contacts = Contacts::in_state(self.machine, t_s + from, start, &mut self.memory.rates);
        self.advance(&contacts, t_s + from, h - from, start, next)?;
        let slack = self.slack(&contacts, t_s + h, next);
        self.stop(&contacts, &slack, next);
        Ok(())
    }

    /// Makes a step of `h` from the start, while the contacts do not change.
    fn advance(
        &mut self,
        contacts: &Contacts,
        t_s: f64,
        h: f64,
        start: &[f64],
        next: &mut [f64],
    ) -> Result<(), StepError> {
        let frozen = Frozen {
            equations: self.equations,
            machine: self.machine,
            contacts: *contacts,
            zeros: &self.memory.zeros,
        };
        let has_matrix = R::FACTS.needs == Needs::Linear;
        if has_matrix && self.memory.fitted != Some((h, *contacts)) {
            self.rule.fit(&frozen, t_s, h)?;
            self.memory.fitted = Some((h, *contacts));
        }
        self.rule.step(&frozen, t_s, h, start, next)?;
        for (contact, &speed) in contacts.iter().zip(self.machine.speeds()) {
            if *contact == Contact::Sticks {
                next[speed] = 0.0; // an implicit equation is solved up to rounding
            }
        }
        Ok(())
    }

    /// Returns the distance of each contact from a change: the speed in its direction, or the friction that it does not need to stick.
    /// It is negative after a change.
    fn slack(&mut self, contacts: &Contacts, t_s: f64, y: &[f64]) -> [f64; MAX_CONTACTS] {
        let speeds = self.machine.speeds();
        let mut slack = [0.0; MAX_CONTACTS];
        let mut sticks = false;
        for ((slack, contact), &speed) in slack.iter_mut().zip(&**contacts).zip(speeds) {
            match contact {
                Contact::Forwards => *slack = y[speed],
                Contact::Backwards => *slack = -y[speed],
                Contact::Sticks => sticks = true,
                Contact::Free(_) => {}
            }
        }
        if sticks {
            let response =
                Response::measure(self.machine, contacts, t_s, y, &mut self.memory.rates);
            let reserves = response.reserves();
            for (k, reserve) in reserves.iter().enumerate().take(response.count) {
                slack[response.at_rest[k]] = *reserve;
            }
        }
        slack
    }

    /// Finds the first change within a step of `h` that ends with these slacks. Returns its time since the start, and the slacks there.
    /// `next` is the state there, just after the change.
    fn locate(
        &mut self,
        contacts: &Contacts,
        t_s: f64,
        h: f64,
        slack: [f64; MAX_CONTACTS],
        start: &[f64],
        next: &mut [f64],
    ) -> Result<(f64, [f64; MAX_CONTACTS]), StepError> {
        let mut before = (0.0, self.slack(contacts, t_s, start));
        let mut after = (h, slack);
        let max = slack.map(|slack| LOCATE_PART * slack);
        for iteration in 0..LOCATE_LIMIT {
            let width = after.0 - before.0;
            let mut ends = after.1.iter().zip(&max);
            if width <= LOCATE_PART * h || ends.all(|(slack, max)| *slack >= max.min(0.0)) {
                break;
            }
            // Straight lines between both ends; every third time the middle, so that the interval shrinks from both sides.
            let crossing = if iteration % 3 == 2 {
                0.5
            } else {
                (before.1.iter().zip(&after.1))
                    .filter(|(_, after)| **after < 0.0)
                    .map(|(before, after)| before.max(0.0) / (before.max(0.0) - after))
                    .fold(1.0, f64::min)
            };
            let length = before.0 + crossing.clamp(MARGIN, 1.0 - MARGIN) * width;
            self.advance(contacts, t_s, length, start, next)?;
            let slack = self.slack(contacts, t_s + length, next);
            if slack.iter().any(|slack| *slack < 0.0) {
                after = (length, slack);
            } else {
                before = (length, slack);
            }
        }
        self.advance(contacts, t_s, after.0, start, next)?;
        Ok(after)
    }

    /// Stops the contacts whose speed has reversed.
    fn stop(&self, contacts: &Contacts, slack: &[f64; MAX_CONTACTS], next: &mut [f64]) {
        for ((contact, slack), &speed) in contacts.iter().zip(slack).zip(self.machine.speeds()) {
            if *contact != Contact::Sticks && *slack < 0.0 {
                next[speed] = 0.0;
            }
        }
    }
}
