//! Dry friction: contacts that stick or slide.
//!
//! Dry friction opposes sliding with a force of its own size, and holds a contact at rest against any smaller force. So the rates jump
//! where a sliding speed passes 0, and no step across the jump has the order of its method. A step therefore ends there:
//!
//! 1. **Contacts.** A contact whose speed is not 0 slides, forwards or backwards. One at rest sticks if friction can hold it; otherwise
//!    it begins to slide. Where contacts at rest act on each other, this is a linear complementarity problem with bounds. Its matrix is
//!    that of a positive inertia, so it has one solution. It is found by principal pivoting on the least index (K. G.
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

mod response;
mod step;

use core::ops::Deref;

use response::Response;
pub(crate) use step::{Memory, Step};

/// Largest number of contacts of a machine.
pub const MAX_CONTACTS: usize = 8;

/// Limit of events in one step.
pub const EVENT_LIMIT: u32 = 32;

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
