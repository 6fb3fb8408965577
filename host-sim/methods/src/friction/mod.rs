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

use core::ops::Deref;

pub(crate) use response::Response;

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

    /// Writes the rates of the state with these contacts.
    fn rates_with(&self, t_s: f64, y: &[f64], contacts: &[Contact], rates: &mut [f64]);
}

/// State of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// It is at rest, and friction holds it: the rate of its speed is 0.
    Sticks,
    /// It slides, or begins to slide, with positive speed, against the friction of that direction.
    Forwards,
    /// It slides, or begins to slide, with negative speed, against the friction of that direction.
    Backwards,
    /// It is free, with this force, N or N·m, in place of friction. The rates are an affine function of it, which shows how contacts act
    /// on each other.
    Free(f64),
}

/// States of all contacts of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    pub fn in_state(machine: &dyn DryFriction, t_s: f64, y: &[f64], rates: &mut [f64]) -> Self {
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
}

/// Writes the rates of a machine with dry friction in a state. It is [`Equations::rates`](crate::Equations::rates) of such a machine.
pub fn rates(machine: &dyn DryFriction, t_s: f64, y: &[f64], rates: &mut [f64]) {
    let contacts = Contacts::in_state(machine, t_s, y, rates);
    machine.rates_with(t_s, y, &contacts, rates);
}
