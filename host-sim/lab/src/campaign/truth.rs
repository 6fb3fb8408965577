//! True phase errors of the cranks: the true position of each crank minus the position that the scene requires.
//!
//! The travel of a crank counts from power-up, including whole turns, and begins at the true angle of the crank. The scene requires the
//! master's travel, plus the offset and trim of the axis. The master is common to all axes, and only differences between cranks tilt or
//! warp the platform. So the error leaves the master out. Where all axes have the same constant ratio, no value that the controller
//! commands or computes enters it.
//!
//! An index alone shows less. It does not distinguish whole turns. Nor does it distinguish a crank that turns back from its mirror image in the
//! middle of the flag, which turns right: the flag is before the sensor at the same times (`docs/detection.md`, *Two pairs of machines*).

use host_sim::axes::{Axes, per_axis};
use host_sim::checked::Checked;
use host_sim::sim::Moment;

/// Requirements of a scene on the cranks.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Travel that the scene requires of each crank beyond the master's, turns. None if axes have different ratios or cam tables: the
    /// required travel is then the commanded one without corrections.
    required_turns: Option<Axes<f64>>,
    /// Middle of each flag. None unless all axes have an index sensor and no encoder.
    flag_turns: Option<Axes<f64>>,
}

impl Truth {
    /// Requirements of a scene.
    pub fn new(checked: &Checked) -> Self {
        let settings = &checked.settings;
        let ratio = |i: usize| settings.axes[i].follower.constant_ratio();
        let count = settings.axes.len();
        let alike = ratio(0).is_some() && (1..count).all(|i| ratio(i) == ratio(0));
        let required = |i: usize| {
            let trim_turns = settings.trims_turns.get(i).copied().unwrap_or_default();
            settings.axes[i].offset_turns + trim_turns
        };
        let flags = settings.axes.iter().map(|axis| {
            let begins_turns = axis.index_turns.filter(|_| !axis.encoder)?;
            Some(begins_turns + axis.index_width_turns / 2.0)
        });
        Self {
            required_turns: alike.then(|| per_axis(count, required)),
            flag_turns: flags.collect(),
        }
    }

    /// Returns the true phase errors of the cranks in a tick, turns. They may contain a part that is common to all cranks.
    pub fn errors(&self, moment: &Moment<'_>) -> Axes<f64> {
        match &self.required_turns {
            Some(required) => {
                let cranks = moment.actual_turns;
                per_axis(cranks.len(), |i| cranks[i] - required[i])
            }
            None => moment.errors().collect(),
        }
    }

    /// Returns true errors as index sensors alone show them, turns, of cranks that turn back or not. None if the machine has other sensors.
    pub fn shown(&self, errors: &[f64], turns_back: &[bool]) -> Option<Axes<f64>> {
        let (required, flags) = self.required_turns.as_ref().zip(self.flag_turns.as_ref())?;
        let mirrored = per_axis(errors.len(), |i| match turns_back[i] {
            true => 2.0 * (flags[i] - required[i]) - errors[i],
            false => errors[i],
        });
        // A crank that loses a turn makes no pulse in it, which shows.
        let whole_turns = |i: usize| (mirrored[i] - mirrored[0]).round().max(0.0);
        Some(per_axis(errors.len(), |i| mirrored[i] - whole_turns(i)))
    }
}
