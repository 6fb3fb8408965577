//! Recorder of a run, from samples of its loop alone. What a simulation knows in addition, [`super::truth`] adds.

use cophase_core::units::Turns;
use cophase_link::sample::Sample;
use cophase_scene::units::{degrees, speed_hz};

use super::record::{AxisRecord, RunRecord};

/// Recorder of a run.
#[derive(Clone, Debug)]
pub struct RunRecorder {
    /// Record of the run so far.
    pub record: RunRecord,
    pub(super) tick_hz: u32,
    /// Time from one sample to the next, s.
    pub(super) sample_s: f64,
    speed: Turns,
    /// Speed in the last sample, rev/s: most samples have the speed of the one before.
    pub(super) speed_hz: f64,
    speed_top: Turns,
    /// True if the shaft was faster after the last change of its speed than before.
    pub(super) is_rising: bool,
}

impl RunRecorder {
    /// Creates the recorder of a loop with a number of axes, of which every `every`-th tick is sampled.
    pub fn new(axes: usize, tick_hz: u32, every: u16) -> Self {
        Self {
            record: RunRecord {
                axes: vec![AxisRecord::default(); axes],
                ..RunRecord::default()
            },
            tick_hz,
            sample_s: f64::from(every) / f64::from(tick_hz),
            speed: Turns::ZERO,
            speed_hz: 0.0,
            speed_top: Turns::ZERO,
            is_rising: false,
        }
    }

    /// Takes the next sample of a controller.
    pub fn sample(&mut self, sample: &Sample) {
        self.tick(sample.state, Turns::from_bits(sample.speed));
        for (axis, error) in self.record.axes.iter_mut().zip(sample.phase_error) {
            let error_deg = degrees(Turns::from_bits(error)).abs();
            raise(&mut axis.phase_error_peak_deg, error_deg);
        }
    }

    /// Takes the state and the speed of the next tick. Returns true if the speed has changed.
    #[inline]
    pub(super) fn tick(&mut self, state: u8, speed: Turns) -> bool {
        self.record.time_in_state_s.add(state, self.sample_s);
        let has_changed = speed != self.speed;
        if has_changed {
            self.is_rising = speed > self.speed;
            self.speed = speed;
            self.speed_hz = speed_hz(speed, self.tick_hz);
            raise(&mut self.speed_top, speed);
        }
        has_changed
    }

    /// Completes the record with the last sample and the commanded positions at its end. Without a sample, the axes were never
    /// commanded. `amax_mps2` returns the amplitude at a speed of the master, turns a tick, in m/s².
    pub fn finish(
        mut self,
        last: Option<&Sample>,
        command_turns: &[f64],
        amax_mps2: impl FnOnce(Turns) -> f64,
    ) -> RunRecord {
        let figures = &mut self.record.figures;
        figures.speed_top_hz = speed_hz(self.speed_top, self.tick_hz);
        figures.amax_top_mps2 = amax_mps2(self.speed_top);
        for (i, axis) in self.record.axes.iter_mut().enumerate() {
            if let Some(last) = last {
                axis.steps = last.steps[i];
                axis.command_turns = command_turns[i];
                axis.correction_deg = degrees(Turns::from_bits(last.correction[i]));
            }
        }
        self.record
    }
}

/// Raises `max` to `value`, unless that is NaN. `f64::max` does the same in more instructions.
pub(super) fn raise<T: PartialOrd>(max: &mut T, value: T) {
    if value > *max {
        *max = value;
    }
}
