//! Which cranks a fault has moved: the one that it befell, and those that torque dragged along.

use cophase_core::drift::place_gate;
use cophase_core::settings::AxisSettings;

use host_sim::axes::Axes;
use host_sim::scene::Checked;

/// Cranks since a fault.
#[derive(Clone, Debug)]
pub struct Moved {
    /// How far a crank may seem to go and still be in place, turns.
    gate_turns: Axes<f64>,
    /// What each was off by before the fault.
    before: Option<Axes<f64>>,
    is_moved: Axes<bool>,
}

impl Moved {
    /// Of a machine in which nothing has moved yet.
    pub fn new(checked: &Checked) -> Self {
        let axes = &checked.settings.axes;
        let reading_deg = checked.settings.drift.reading_deg;
        let gate = |axis: &AxisSettings| place_gate(axis, reading_deg).to_num();
        Self {
            gate_turns: axes.iter().map(gate).collect(),
            before: None,
            is_moved: axes.iter().map(|_| false).collect(),
        }
    }

    /// Takes note of what each crank is off from its own command, turns, before the fault.
    pub fn look_before(&mut self, off: Axes<f64>) {
        self.before = Some(off);
    }

    /// The same from the fault on.
    pub fn look(&mut self, off: Axes<f64>) {
        let before = self.before.get_or_insert_with(|| off.clone());
        let cranks = self.is_moved.iter_mut().zip(&self.gate_turns);
        for ((is_moved, gate), (off, before)) in cranks.zip(off.iter().zip(before)) {
            *is_moved |= (off - *before).abs() > *gate;
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
        let mut moved = Moved::new(&Checked::new(scene).unwrap());
        let gate = moved.gate_turns[0];
        moved.look_before(Axes::from_array([0.3; 4]));
        let start = [0.1, -0.01, 0.0, 0.0];
        moved.look_before(Axes::from_array(start));
        moved.look(Axes::from_array([
            start[0],
            start[1] - 1.1 * gate,
            start[2] + 0.9 * gate,
            0.0,
        ]));
        moved.look(Axes::from_array(start));
        let is_moved = [0, 1, 2, 3, 4].map(|axis| moved.has(axis));
        assert_eq!(is_moved, [false, true, false, false, false]);
    }
}
