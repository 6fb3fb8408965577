//! True phase errors of the cranks: where each truly is, against where the scene requires it.
//!
//! The travel of a crank counts from power-up, whole turns included, and begins at the angle where it truly stands. The scene requires
//! the master's travel, plus the axis's offset and trim. The master is common to all axes, and only differences between cranks tilt or
//! warp the platform. So the error here leaves the master out, and nothing that the controller commands or computes enters it.

use host_sim::axes::{Axes, per_axis};
use host_sim::scene::Checked;
use host_sim::sim::Moment;

/// Requirements of a scene on the cranks.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Travel that the scene requires of each crank beyond the master's, turns. None where axes have different ratios or cam tables: there
    /// the required travel is the commanded one without corrections.
    required_turns: Option<Axes<f64>>,
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
        Self {
            required_turns: alike.then(|| per_axis(count, required)),
        }
    }

    /// True phase errors of the cranks in a tick, turns, less a part that is common to all.
    pub fn errors(&self, moment: &Moment<'_>) -> Axes<f64> {
        match &self.required_turns {
            Some(required) => {
                let cranks = moment.actual_turns.iter().zip(required);
                cranks.map(|(actual, required)| actual - required).collect()
            }
            None => moment.errors().collect(),
        }
    }
}
