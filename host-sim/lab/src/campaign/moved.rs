//! Which cranks a fault has moved: the one that it befell, and those that torque dragged along.

use cophase_core::drift::place_gate;

use host_sim::scene::Checked;

/// The cranks of `N` axes, since a fault.
#[derive(Clone, Debug)]
pub struct Moved<const N: usize> {
    /// How far a crank may seem to go and still be in place, turns.
    gate_turns: [f64; N],
    /// What each was off by before the fault.
    before: Option<[f64; N]>,
    is_moved: [bool; N],
}

impl<const N: usize> Moved<N> {
    /// Of a machine in which nothing has moved yet.
    pub fn new(checked: &Checked) -> Self {
        let gate = |axis: usize| {
            let settings = checked.setup.axes.get(axis)?;
            Some(place_gate(settings, checked.setup.drift.reading_deg).to_num())
        };
        Self {
            gate_turns: std::array::from_fn(|axis| gate(axis).unwrap_or(f64::INFINITY)),
            before: None,
            is_moved: [false; N],
        }
    }

    /// Takes note of what each crank is off from its own command, turns, before the fault.
    pub fn look_before(&mut self, off: [f64; N]) {
        self.before = Some(off);
    }

    /// The same from the fault on.
    pub fn look(&mut self, off: [f64; N]) {
        let before = self.before.get_or_insert(off);
        let cranks = self.is_moved.iter_mut().zip(self.gate_turns);
        for ((is_moved, gate), (off, before)) in cranks.zip(off.iter().zip(before)) {
            *is_moved |= (off - *before).abs() > gate;
        }
    }

    /// Whether a crank has gone so far since then that it was no longer in its place.
    pub fn has(&self, axis: usize) -> bool {
        self.is_moved.get(axis) == Some(&true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::scene::library;

    /// Were it wrong, any stop would do as the detection of any fault, or one that came of it would not.
    #[test]
    fn a_crank_is_moved_that_left_its_place_once() {
        let scene = library::find("default").unwrap().scene();
        let mut moved = Moved::<3>::new(&Checked::new(scene).unwrap());
        let gate = moved.gate_turns[0];
        moved.look_before([0.3; 3]);
        let start = [0.1, -0.01, 0.0];
        moved.look_before(start);
        moved.look([start[0], start[1] - 1.1 * gate, start[2] + 0.9 * gate]);
        moved.look(start);
        let is_moved = [0, 1, 2, 3].map(|axis| moved.has(axis));
        assert_eq!(is_moved, [false, true, false, false]);
    }
}
