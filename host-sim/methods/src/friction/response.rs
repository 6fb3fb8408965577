//! Response of the contacts at rest to friction, and the friction at which they stick or begin to slide.

use super::{Contact, Contacts, DryFriction, MAX_CONTACTS};

/// Accelerations of the contacts at rest as a function of the friction at them: a = free + matrix · friction.
#[derive(Debug)]
pub(crate) struct Response {
    /// Numbers of these contacts.
    pub at_rest: [usize; MAX_CONTACTS],
    pub count: usize,
    bounds: [[f64; 2]; MAX_CONTACTS],
    free: [f64; MAX_CONTACTS],
    matrix: [[f64; MAX_CONTACTS]; MAX_CONTACTS],
}

impl Response {
    /// Measures the response of the contacts that stick; the others slide.
    pub fn measure(
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
        let mut tried = *contacts;
        let mut unit: f64 = 0.0;
        for (i, _) in contacts
            .iter()
            .enumerate()
            .filter(|(_, contact)| **contact == Contact::Sticks)
        {
            tried.all[i] = Contact::Free(0.0);
            response.at_rest[response.count] = i;
            response.bounds[response.count] = all[i];
            response.count += 1;
            unit = unit.max(all[i][1] - all[i][0]);
        }
        // The rates are affine in the forces, so any size of the unit does. That of friction keeps the digits of both.
        let unit = if unit > 0.0 { unit } else { 1.0 };
        machine.rates_with(t_s, y, &tried, rates);
        let n = response.count;
        for k in 0..n {
            response.free[k] = rates[speeds[response.at_rest[k]]];
        }
        for j in 0..n {
            tried.all[response.at_rest[j]] = Contact::Free(unit);
            machine.rates_with(t_s, y, &tried, rates);
            tried.all[response.at_rest[j]] = Contact::Free(0.0);
            for k in 0..n {
                let with = rates[speeds[response.at_rest[k]]];
                response.matrix[k][j] = (with - response.free[k]) / unit;
            }
        }
        response
    }

    /// Finds which contacts at rest stick, and the directions in which the others begin to slide.
    pub fn settle(&self, contacts: &mut Contacts) {
        let n = self.count;
        let mut state = [Contact::Sticks; MAX_CONTACTS];
        for _ in 0..3_u32.pow(n as u32) {
            let force = self.forces(&state);
            let wrong = (0..n).find_map(|k| {
                let acceleration =
                    self.free[k] + (0..n).map(|j| self.matrix[k][j] * force[j]).sum::<f64>();
                let [min, max] = self.bounds[k];
                let right = match state[k] {
                    Contact::Sticks if force[k] < min => Contact::Forwards,
                    Contact::Sticks if force[k] > max => Contact::Backwards,
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
        for (&contact, &state) in self.at_rest[..n].iter().zip(&state) {
            contacts.all[contact] = state;
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
                Contact::Free(free) => force[k] = free,
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
            for row in pivot + 1..m {
                let (above, below) = rows.split_at_mut(row);
                let (above, below) = (&above[pivot], &mut below[0]);
                let factor = below[pivot] / above[pivot];
                for (entry, above) in below[pivot..=m].iter_mut().zip(&above[pivot..=m]) {
                    *entry -= factor * above;
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
    pub fn reserves(&self) -> [f64; MAX_CONTACTS] {
        let force = self.forces(&[Contact::Sticks; MAX_CONTACTS]);
        let mut reserves = [0.0; MAX_CONTACTS];
        for (k, reserve) in reserves.iter_mut().enumerate().take(self.count) {
            let [min, max] = self.bounds[k];
            *reserve = (force[k] - min).min(max - force[k]);
        }
        reserves
    }
}
