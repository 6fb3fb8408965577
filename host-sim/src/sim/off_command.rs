//! Shafts that end away from their commands, in a run in which the controller reported nothing.
//!
//! *Error* of a shaft: its lead over its target, less the steady following error of its drive at that speed. A shaft is off its
//! command if it ends by more than the scene's `drift.common_limit_deg` away, and its error has changed by more than that since
//! homing ended. So an error that homing corrects, or one from power-up, does not count. A shaft *stood* if it made less than half of the
//! motion that a program commanded, from one end to the other, where that is more than twice the limit. A command that comes back to where
//! it began ends at such a shaft.

use cophase_core::supervisor::State;

use super::Moment;
use crate::axes::{Axes, per_axis};
use crate::checked::Checked;
use crate::drives::AtCrank;

/// Monitor of the shafts' errors.
#[derive(Clone, Debug)]
pub struct OffCommand {
    limit_turns: f64,
    /// Steady following error of each drive per speed of its shaft, s.
    lag_s: Axes<f64>,
    /// Errors in the last tick with the drives on, turns.
    errors: Axes<f64>,
    /// Errors as homing ended.
    homed: Option<Axes<f64>>,
    /// Errors at the end of earlier starts, of shafts that were off their commands; 0 for the others.
    earlier: Axes<f64>,
    state: State,
    /// Least and greatest position in the program, turns: commanded, and of the shaft.
    ranges: Axes<[Range; 2]>,
}

/// Least and greatest of some values.
#[derive(Clone, Copy, Debug)]
struct Range(f64, f64);

impl Range {
    const NONE: Self = Self(f64::INFINITY, f64::NEG_INFINITY);

    fn add(&mut self, value: f64) {
        *self = Self(self.0.min(value), self.1.max(value));
    }

    fn width(self) -> f64 {
        (self.1 - self.0).max(0.0)
    }
}

impl OffCommand {
    /// Creates the monitor of a scene at power-up.
    pub fn new(checked: &Checked) -> Self {
        let axes = &checked.scene.axes;
        let lag_s = |i: usize| {
            let motor = checked
                .moves_by_torque()
                .then(|| AtCrank::motor(&checked.scene, i));
            motor
                .flatten()
                .map_or(0.0, |motor| motor.following_error_rad(1.0))
        };
        let none = || per_axis(axes.count, |_| 0.0);
        Self {
            limit_turns: checked.scene.drift.common_limit_deg / 360.0,
            lag_s: per_axis(axes.count, lag_s),
            errors: none(),
            homed: None,
            earlier: none(),
            state: State::Idle,
            ranges: per_axis(axes.count, |_| [Range::NONE; 2]),
        }
    }

    /// Takes in a tick with the drives on, and the speed of the master in it, rev/s.
    pub fn tick(&mut self, moment: &Moment<'_>, master_hz: f64) {
        let state = moment.telemetry.state;
        if state != self.state {
            if state == State::Homing {
                self.earlier = self.off_turns();
                self.homed = None;
            } else if self.state == State::Homing && state == State::Run {
                self.homed = Some(self.errors.clone());
            }
            self.state = state;
        }
        for (i, lead) in moment.errors().enumerate() {
            let speed_hz = master_hz * moment.machine.axes[i].ratio();
            self.errors[i] = lead + self.lag_s[i] * speed_hz;
            if state == State::Run {
                let [commanded, actual] = &mut self.ranges[i];
                commanded.add(moment.command_turns[i]);
                actual.add(moment.actual_turns[i]);
            }
        }
    }

    /// True of each shaft that stood while a program commanded it to move.
    pub fn stood(&self) -> Axes<bool> {
        per_axis(self.ranges.len(), |i| {
            let [commanded, actual] = self.ranges[i].map(Range::width);
            commanded > 2.0 * self.limit_turns && actual < 0.5 * commanded
        })
    }

    /// Error of each shaft at the end, turns: positive ahead. It is 0 for a shaft that is not off its command.
    pub fn off_turns(&self) -> Axes<f64> {
        per_axis(self.errors.len(), |i| {
            let error = self.errors[i];
            // Before homing is over, no shaft has a place that the controller knows.
            let change = (self.homed.as_ref()).map_or(0.0, |homed| error - homed[i]);
            let off = if error.abs().min(change.abs()) > self.limit_turns {
                error
            } else {
                0.0
            };
            if off.abs() < self.earlier[i].abs() {
                self.earlier[i]
            } else {
                off
            }
        })
    }
}
