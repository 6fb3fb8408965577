//! Where a crank meets its index flag, and which pulses besides are nothing that anyone sees.

use cophase_core::drift::place_gate;

use host_sim::scene::Checked;

/// The place of an axis's flag; turns of the crank.
#[derive(Clone, Copy, Debug)]
pub struct Flag {
    at_turns: f64,
    length_turns: f64,
    /// How far from it the drift monitor takes a pulse for the flag's own.
    gate_turns: f64,
}

impl Flag {
    /// Of an axis; none if it has no sensor.
    pub fn new(checked: &Checked, axis: usize) -> Option<Self> {
        let settings = checked.settings.axes.get(axis)?;
        let gate = place_gate(settings, checked.settings.drift.reading_deg);
        Some(Self {
            at_turns: settings.index_turns?,
            length_turns: settings.index_width_turns,
            gate_turns: gate.to_num(),
        })
    }

    /// A pulse that no flag makes, and that comes while the crank is at `turns`, going forward.
    pub fn extra_at(&self, turns: f64) -> Extra {
        let off = turns - self.at_turns;
        let off_turns = off - off.round();
        let ends = self.gate_turns.max(self.length_turns);
        Extra {
            off_turns,
            is_in_place: (-self.gate_turns..=ends).contains(&off_turns),
        }
    }
}

/// A pulse that no flag makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extra {
    /// How far after the place of the flag it comes, turns of the crank; negative: before it.
    pub off_turns: f64,
    /// It is nothing that anyone sees: within a gate it is taken for the flag's own, and the flag for the same passage, which has the
    /// crank be off by less than a gate for a turn; and while the flag is before the sensor its line is high already.
    pub is_in_place: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::scene::library;

    /// Were the place too wide, pulses that the loop must tell of would be let pass; were it too narrow, it would be blamed for what no
    /// line shows. Of 3200 steps and 0.25° a gate is 4 (0.25 + 0.225) = 1.9°, of 200 full steps no more than 3.6 - 0.475 = 3.125°.
    #[test]
    fn a_place_is_a_gate_wide_and_as_long_as_its_flag() {
        let is_in = |full_steps: u32, width_deg: f64, deg: f64| {
            let mut scene = library::find("default").unwrap().scene();
            scene.axes.steps_per_turn = 3200;
            scene.axes.full_steps_per_turn = full_steps;
            scene.axes.index_width_deg = width_deg;
            scene.drift.reading_deg = 0.25;
            let flag = Flag::new(&Checked::new(scene).unwrap(), 0).unwrap();
            flag.extra_at(flag.at_turns + 3.0 + deg / 360.0).is_in_place
        };
        for (deg, expected) in [(-1.95, false), (-1.85, true), (1.85, true), (1.95, false)] {
            assert_eq!(is_in(200, 0.0, deg), expected, "{deg}");
        }
        for (deg, expected) in [(-1.95, false), (5.9, true), (6.1, false)] {
            assert_eq!(is_in(200, 6.0, deg), expected, "{deg}");
        }
        // Half a cycle is 0.9°, less a reading 0.425°: less than two readings differ by, so that half a cycle it is.
        assert!(is_in(800, 0.0, 0.89) && !is_in(800, 0.0, 0.91));
    }
}
