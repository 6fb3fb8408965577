//! Dry friction: contacts that stick or slide.
//!
//! Dry friction opposes sliding with a force of its own size, and holds a contact at rest against any smaller force. So the rates jump
//! where a sliding speed passes 0, and no step across the jump has the order of its method. A step therefore ends there:
//!
//! 1. **Contacts.** A contact whose speed is not 0 slides, forwards or backwards. One at rest sticks if friction can hold it; otherwise
//!    it begins to slide. Where contacts at rest act on each other, this is a linear complementarity problem with bounds. Its matrix is
//!    that of a positive inertia, so it has one solution. [`Response::settle`] finds it by principal pivoting on the least index (K. G.
//!    Murty, *Note on a Bard-type scheme for solving the complementarity problem*, Opsearch 11, 1974; with bounds: J. J. Júdice, F. M.
//!    Pires, *A block principal pivoting algorithm for large-scale strictly monotone linear complementarity problems*, Computers &
//!    Operations Research 21, 1994).
//! 2. **Step.** The method makes its step with these contacts. The equations are then smooth: friction is a force of constant direction,
//!    or the speed is 0.
//! 3. **Event.** If a speed has reversed, or a contact at rest needs more than friction can give, the step is made again up to the first
//!    such moment. A speed that reverses there becomes exactly 0. The rest of the step follows, from 1. on.
//!
//! The contacts are a function of the state: a contact is at rest if its speed is exactly 0. So nothing is stored between steps. All
//! methods treat friction in this way, and each keeps its order.
//!
//! After [`EVENT_LIMIT`] events in one step, which only a step that is too long for the machine has, the rest is made at once: speeds
//! that reverse end at 0, and contacts at rest stay there. This is a time-stepping scheme of order 1 (J. J. Moreau, *Unilateral contact
//! and dry friction in finite freedom dynamics*, 1988).
//!
//! Friction at rest is as large as friction in motion. A speed that reverses twice within a step is not detected.

use core::ops::Deref;

use nalgebra::DMatrix;

use crate::StepError;
use crate::equations::{Equations, Linear};
use crate::method::Rule;

/// Largest number of contacts of a machine.
pub const MAX_CONTACTS: usize = 8;

/// Limit of events in one step.
pub const EVENT_LIMIT: u32 = 32;

/// Limit of iterations to locate an event.
const LOCATE_LIMIT: u32 = 60;

/// Uncertainty of the moment of an event, as a part of the step.
const LOCATE_PART: f64 = 1e-13;

/// Least distance from the ends of an interval at which it is divided, as a part of it.
const MARGIN: f64 = 1e-6;

/// Dry friction on some speeds of a machine.
pub trait DryFriction {
    /// Component of the state that is the sliding speed of each contact. At most [`MAX_CONTACTS`].
    fn speeds(&self) -> &[usize];

    /// Writes the friction of each contact, N or N·m: while it slides forwards, at most 0, and while it slides backwards, at least 0.
    /// At rest it has any value between the two.
    fn bounds(&self, y: &[f64], bounds: &mut [[f64; 2]]);

    /// Writes the rates of the state with this friction at each contact. It is an affine function of the forces.
    fn rates_under(&self, t_s: f64, y: &[f64], friction: &[Friction], rates: &mut [f64]);
}

/// Action of friction on a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction {
    /// It holds the contact: the rate of its speed is 0.
    Holds,
    /// It acts with this force, N or N·m.
    Force(f64),
}

/// State of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// It is at rest, and friction holds it.
    Sticks,
    /// It slides, or begins to slide, with positive speed.
    Forwards,
    /// It slides, or begins to slide, with negative speed.
    Backwards,
}

/// States of all contacts of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contacts {
    all: [Contact; MAX_CONTACTS],
    count: usize,
}

impl Deref for Contacts {
    type Target = [Contact];

    fn deref(&self) -> &[Contact] {
        &self.all[..self.count]
    }
}

impl Contacts {
    /// Returns the contacts of a machine in a state. `rates` is memory for its rates.
    pub fn at(machine: &dyn DryFriction, t_s: f64, y: &[f64], rates: &mut [f64]) -> Self {
        let speeds = machine.speeds();
        let mut contacts = Self {
            all: [Contact::Sticks; MAX_CONTACTS],
            count: speeds.len(),
        };
        let mut rests = false;
        for (contact, &speed) in contacts.all.iter_mut().zip(speeds) {
            if y[speed] > 0.0 {
                *contact = Contact::Forwards;
            } else if y[speed] < 0.0 {
                *contact = Contact::Backwards;
            } else {
                rests = true;
            }
        }
        if rests {
            Response::measure(machine, &contacts, t_s, y, rates).settle(&mut contacts);
        }
        contacts
    }

    /// Returns the friction at each contact in a state.
    pub fn friction(&self, machine: &dyn DryFriction, y: &[f64]) -> [Friction; MAX_CONTACTS] {
        let mut bounds = [[0.0; 2]; MAX_CONTACTS];
        machine.bounds(y, &mut bounds[..self.count]);
        let mut friction = [Friction::Holds; MAX_CONTACTS];
        for ((friction, contact), bounds) in friction.iter_mut().zip(&**self).zip(bounds) {
            *friction = match contact {
                Contact::Sticks => Friction::Holds,
                Contact::Forwards => Friction::Force(bounds[0]),
                Contact::Backwards => Friction::Force(bounds[1]),
            };
        }
        friction
    }
}

/// Writes the rates of a machine with dry friction in a state. It is [`Equations::rates`] of such a machine.
pub fn rates(machine: &dyn DryFriction, t_s: f64, y: &[f64], rates: &mut [f64]) {
    let contacts = Contacts::at(machine, t_s, y, rates);
    let friction = contacts.friction(machine, y);
    machine.rates_under(t_s, y, &friction[..contacts.count], rates);
}

/// Accelerations of the contacts at rest as a function of the friction at them: a = free + matrix · friction.
#[derive(Debug)]
struct Response {
    /// Numbers of these contacts.
    at_rest: [usize; MAX_CONTACTS],
    count: usize,
    bounds: [[f64; 2]; MAX_CONTACTS],
    free: [f64; MAX_CONTACTS],
    matrix: [[f64; MAX_CONTACTS]; MAX_CONTACTS],
}

impl Response {
    /// Measures the response of the contacts that stick; the others slide.
    fn measure(
        machine: &dyn DryFriction,
        contacts: &Contacts,
        t_s: f64,
        y: &[f64],
        rates: &mut [f64],
    ) -> Self {
        let speeds = machine.speeds();
        let mut all = [[0.0; 2]; MAX_CONTACTS];
        machine.bounds(y, &mut all[..contacts.count]);
        let mut response = Self {
            at_rest: [0; MAX_CONTACTS],
            count: 0,
            bounds: [[0.0; 2]; MAX_CONTACTS],
            free: [0.0; MAX_CONTACTS],
            matrix: [[0.0; MAX_CONTACTS]; MAX_CONTACTS],
        };
        let mut friction = contacts.friction(machine, y);
        let mut unit: f64 = 0.0;
        for (i, _) in contacts
            .iter()
            .enumerate()
            .filter(|(_, contact)| **contact == Contact::Sticks)
        {
            friction[i] = Friction::Force(0.0);
            response.at_rest[response.count] = i;
            response.bounds[response.count] = all[i];
            response.count += 1;
            unit = unit.max(all[i][1] - all[i][0]);
        }
        // The rates are affine in the forces, so any size of the unit does. That of friction keeps the digits of both.
        let unit = if unit > 0.0 { unit } else { 1.0 };
        let friction = &mut friction[..contacts.count];
        machine.rates_under(t_s, y, friction, rates);
        let n = response.count;
        for k in 0..n {
            response.free[k] = rates[speeds[response.at_rest[k]]];
        }
        for j in 0..n {
            friction[response.at_rest[j]] = Friction::Force(unit);
            machine.rates_under(t_s, y, friction, rates);
            friction[response.at_rest[j]] = Friction::Force(0.0);
            for k in 0..n {
                let with = rates[speeds[response.at_rest[k]]];
                response.matrix[k][j] = (with - response.free[k]) / unit;
            }
        }
        response
    }

    /// Finds which contacts at rest stick, and the directions in which the others begin to slide.
    fn settle(&self, contacts: &mut Contacts) {
        let n = self.count;
        let mut state = [Contact::Sticks; MAX_CONTACTS];
        for _ in 0..3_u32.pow(n as u32) {
            let force = self.forces(&state);
            let wrong = (0..n).find_map(|k| {
                let acceleration =
                    self.free[k] + (0..n).map(|j| self.matrix[k][j] * force[j]).sum::<f64>();
                let [least, most] = self.bounds[k];
                let right = match state[k] {
                    Contact::Sticks if force[k] < least => Contact::Forwards,
                    Contact::Sticks if force[k] > most => Contact::Backwards,
                    Contact::Forwards if acceleration < 0.0 => Contact::Sticks,
                    Contact::Backwards if acceleration > 0.0 => Contact::Sticks,
                    same => same,
                };
                (right != state[k]).then_some((k, right))
            });
            let Some((k, right)) = wrong else {
                break;
            };
            state[k] = right;
        }
        for (&at_rest, &state) in self.at_rest.iter().zip(&state).take(n) {
            contacts.all[at_rest] = state;
        }
    }

    /// Returns the friction of each contact at rest in these states: the bounds of those that slide, and the forces under which the
    /// others have no acceleration.
    fn forces(&self, state: &[Contact; MAX_CONTACTS]) -> [f64; MAX_CONTACTS] {
        let n = self.count;
        let mut force = [0.0; MAX_CONTACTS];
        let mut sticking = [0; MAX_CONTACTS];
        let mut m = 0;
        for k in 0..n {
            match state[k] {
                Contact::Forwards => force[k] = self.bounds[k][0],
                Contact::Backwards => force[k] = self.bounds[k][1],
                Contact::Sticks => {
                    sticking[m] = k;
                    m += 1;
                }
            }
        }
        let mut rows = [[0.0; MAX_CONTACTS + 1]; MAX_CONTACTS];
        for (row, &k) in rows.iter_mut().zip(&sticking[..m]) {
            for (entry, &j) in row.iter_mut().zip(&sticking[..m]) {
                *entry = self.matrix[k][j];
            }
            let sliding = (0..n).map(|j| self.matrix[k][j] * force[j]);
            row[m] = -self.free[k] - sliding.sum::<f64>();
        }
        // Elimination needs no pivots, because the matrix is that of a positive inertia.
        for pivot in 0..m {
            let (above, below) = rows.split_at_mut(pivot + 1);
            let top = &above[pivot][pivot..=m];
            for row in &mut below[..m - pivot - 1] {
                let factor = row[pivot] / top[0];
                for (entry, top) in row[pivot..=m].iter_mut().zip(top) {
                    *entry -= factor * top;
                }
            }
        }
        for row in (0..m).rev() {
            let known = (row + 1..m).map(|column| rows[row][column] * force[sticking[column]]);
            force[sticking[row]] = (rows[row][m] - known.sum::<f64>()) / rows[row][row];
        }
        force
    }

    /// Returns the part of friction that each contact at rest does not need to stick, negative beyond its bounds.
    fn reserves(&self) -> [f64; MAX_CONTACTS] {
        let force = self.forces(&[Contact::Sticks; MAX_CONTACTS]);
        let mut reserves = [0.0; MAX_CONTACTS];
        for (k, reserve) in reserves.iter_mut().enumerate().take(self.count) {
            let [least, most] = self.bounds[k];
            *reserve = (force[k] - least).min(most - force[k]);
        }
        reserves
    }
}

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
        let friction = self.contacts.friction(self.machine, y);
        let friction = &friction[..self.contacts.count];
        self.machine.rates_under(t_s, y, friction, rates);
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
    /// Step and contacts for which the rule has its coefficients; `None` before the first step.
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
        self.memory.start.copy_from_slice(y);
        let mut from = 0.0;
        for _ in 0..EVENT_LIMIT {
            let contacts = self.contacts(t_s + from);
            let rest = h - from;
            self.advance(&contacts, t_s + from, rest, next)?;
            let slack = self.slack(&contacts, t_s + h, next);
            if !slack.iter().any(|slack| *slack < 0.0) {
                return Ok(());
            }
            let (length, slack) = self.locate(&contacts, t_s + from, rest, slack, next)?;
            self.stop(&contacts, &slack, next);
            from += length;
            if h - from <= LOCATE_PART * h {
                return Ok(());
            }
            self.memory.start.copy_from_slice(next);
        }
        let contacts = self.contacts(t_s + from);
        self.advance(&contacts, t_s + from, h - from, next)?;
        let slack = self.slack(&contacts, t_s + h, next);
        self.stop(&contacts, &slack, next);
        Ok(())
    }

    fn contacts(&mut self, t_s: f64) -> Contacts {
        Contacts::at(
            self.machine,
            t_s,
            &self.memory.start,
            &mut self.memory.rates,
        )
    }

    /// Makes a step of `h` from the start, while the contacts do not change.
    fn advance(
        &mut self,
        contacts: &Contacts,
        t_s: f64,
        h: f64,
        next: &mut [f64],
    ) -> Result<(), StepError> {
        let frozen = Frozen {
            equations: self.equations,
            machine: self.machine,
            contacts: *contacts,
            zeros: &self.memory.zeros,
        };
        if self.memory.fitted != Some((h, *contacts)) {
            self.rule.fit(&frozen, t_s, h)?;
            self.memory.fitted = Some((h, *contacts));
        }
        self.rule.step(&frozen, t_s, h, &self.memory.start, next)?;
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
        next: &mut [f64],
    ) -> Result<(f64, [f64; MAX_CONTACTS]), StepError> {
        let start = core::mem::take(&mut self.memory.start);
        let mut before = (0.0, self.slack(contacts, t_s, &start));
        self.memory.start = start;
        let mut after = (h, slack);
        let most = slack.map(|slack| LOCATE_PART * slack);
        for iteration in 0..LOCATE_LIMIT {
            let width = after.0 - before.0;
            let mut ends = after.1.iter().zip(&most);
            if width <= LOCATE_PART * h || ends.all(|(slack, most)| *slack >= most.min(0.0)) {
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
            self.advance(contacts, t_s, length, next)?;
            let slack = self.slack(contacts, t_s + length, next);
            if slack.iter().any(|slack| *slack < 0.0) {
                after = (length, slack);
            } else {
                before = (length, slack);
            }
        }
        self.advance(contacts, t_s, after.0, next)?;
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
