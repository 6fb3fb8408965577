//! Sensors of a machine: its index sensors, and the counts of its encoders.

use cophase_core::units::PerAxis;
use cophase_scene::units::floor;

use super::SimulatedMachine;
use crate::axes::{Axes, per_axis};
use crate::checked::Checked;
use crate::drives::IndexSensor;
use crate::drives::{Sensor, Stream};

impl SimulatedMachine {
    /// Creates the index sensors of the cranks, at their present positions.
    pub fn sensors(&self, checked: &Checked) -> Axes<IndexSensor> {
        let settings = &checked.settings;
        let noise = &checked.scene.noise;
        let width = settings.index_width_cycles();
        let cycles = |seconds: f64| seconds * f64::from(settings.clock_hz);
        per_axis(self.axes.len(), |i| {
            let delay = cycles(settings.axes[i].index_delay_s).round() as u32;
            let deviation = cycles(noise.index_us * 1e-6);
            let time = Stream::new(noise.seed, Sensor::EdgeTime, i, deviation);
            let sensor = IndexSensor::new(width, self.index_cycles).delayed(delay, time);
            match self.axes[i].flag().filter(|flag| flag.has_length()) {
                Some(flag) => sensor.of_length(width, flag.is_over(self.axes[i].turns())),
                None => sensor,
            }
        })
    }

    /// Counts of motor `i`'s encoder, in the motor's own sense, wrapping.
    pub fn encoder(&self, i: usize) -> i32 {
        /// Rounding error of a count, in counts: a crank within it counts as on the next count.
        const ROUNDING: f64 = 1e-6;
        let axis = &self.axes[i];
        let sense = if axis.is_reversed() { -1.0 } else { 1.0 };
        let counts = sense * axis.counted_turns() * axis.steps_per_turn();
        floor(counts + ROUNDING) as i32
    }

    /// Counts of all encoders; 0 for those that are not read.
    pub fn encoders(&self) -> PerAxis<i32> {
        let mut counts = PerAxis::default();
        if self.has_encoder != 0 {
            for (i, counts) in counts.iter_mut().enumerate() {
                if self.has_encoder >> i & 1 != 0 {
                    *counts = self.encoder(i);
                }
            }
        }
        counts
    }
}
