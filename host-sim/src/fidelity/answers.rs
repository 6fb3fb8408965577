//! Outputs of a run, collected in every tick, and in every step within a tick.

use cophase_core::supervisor::State;
use cophase_core::units::PerAxis;

use crate::axes::per_axis;
use crate::output::Output;
use crate::pose::Pose;
use crate::sim::{Moment, Observer};

/// Largest value of a quantity that is sampled at the ends of steps, and what of its peak may be hidden between two samples.
///
/// Near its peak a smooth quantity is a parabola. One with the second difference d of equally spaced samples exceeds the largest of them
/// by at most |d|/8.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Peak {
    value: f64,
    hidden: f64,
    /// True if the largest sample is the last one, or the first of fewer than three.
    is_last: bool,
    /// Last two samples, the earlier one first, and the number of all.
    last: [f64; 2],
    count: u64,
}

impl Peak {
    /// Adds a sample, one step after the last one.
    fn sample(&mut self, value: f64) {
        let [before, last] = self.last;
        self.last = [last, value];
        self.count += 1;
        let hidden = if self.count > 2 {
            (before - 2.0 * last + value).abs() / 8.0
        } else {
            0.0
        };
        if self.count == 1 || value > self.value {
            (self.value, self.hidden, self.is_last) = (value, hidden, true);
        } else if self.is_last {
            self.hidden = self.hidden.max(hidden);
            self.is_last = self.count < 3;
        }
    }

    /// Adds a value at the moment of the last sample: commands jump there.
    fn jump(&mut self, value: f64) {
        self.last[1] = value;
        if value > self.value {
            (self.value, self.is_last) = (value, true);
        }
    }
}

/// Answers of a run, one for each of [`Output::ALL`]; `None` for an output that its model level does not compute.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Answers {
    peaks: [Option<Peak>; Output::ALL.len()],
    /// True if the machine's equations diverged.
    is_broken: bool,
    /// Commanded positions of the cranks at the end of the last tick, turns.
    aim_before: PerAxis<f64>,
}

impl Answers {
    /// Returns one answer.
    pub fn of(&self, output: Output) -> Option<f64> {
        self.peaks[output as usize].map(|peak| peak.value)
    }

    /// Returns by how much one answer may be too small, because it is sampled at the ends of steps.
    pub fn hidden(&self, output: Output) -> f64 {
        self.peaks[output as usize].map_or(0.0, |peak| peak.hidden)
    }

    /// Returns true if no motor lost a step or reached its torque limit, and the equations did not diverge. Otherwise, later
    /// values may differ with every step length and model level.
    pub fn is_regular(&self) -> bool {
        !self.is_broken && self.of(Output::Slips).is_none_or(|axes| axes == 0.0)
    }

    /// Adds a value: a sample one step after the last one, or at the same moment.
    fn max(&mut self, output: Output, value: f64, jumps: bool) {
        let peak = self.peaks[output as usize].get_or_insert_default();
        if jumps && peak.count > 0 {
            peak.jump(value);
        } else {
            peak.sample(value);
        }
    }

    /// Adds the deviations of the cranks from their commanded positions, turns.
    fn errors(&mut self, errors: impl Iterator<Item = f64>, jumps: bool) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for error in errors {
            low = low.min(error * 360.0);
            high = high.max(error * 360.0);
        }
        self.max(Output::Lag, high.max(-low), jumps);
        self.max(Output::Spread, high - low, jumps);
    }

    /// Adds tilt and acceleration of the platform.
    fn posed(&mut self, pose: &Pose, jumps: bool) {
        let tilt_mrad = pose.tilt_x_mrad.hypot(pose.tilt_y_mrad);
        self.max(Output::Tilt, tilt_mrad, jumps);
        self.max(Output::Amax, pose.accel_mps2.abs(), jumps);
    }

    /// Adds the values at the end of a tick.
    fn at_end(&mut self, moment: &Moment<'_>) {
        // Where nothing is integrated, ticks are no samples of anything smooth.
        let jumps = moment.machine.rotors().is_none();
        self.errors(moment.errors(), jumps);
        self.posed(moment.pose(), jumps);
        if let Some(frame) = moment.machine.frame() {
            self.max(Output::Ground, frame.ground_n.abs(), jumps);
        }
        let torques = (0..moment.axis_count()).filter_map(|i| moment.machine.motor_torque_nm(i));
        if let Some(torque) = torques.map(f64::abs).max_by(f64::total_cmp) {
            self.max(Output::Torque, torque, jumps);
        }
    }

    /// Adds the values of a step within a tick. Extremes occur there, and torques jump with the commands of the drives.
    fn within(&mut self, moment: &Moment<'_>) {
        let machine = moment.machine;
        for accel_mps2 in machine.follower().within_mps2() {
            self.max(Output::Amax, accel_mps2.abs(), true);
        }
        let Some(rotors) = machine.rotors() else {
            return;
        };
        let per_tick = 1e9 / (moment.end_ns - moment.start_ns) as f64;
        let before = self.aim_before;
        for (step, instant) in rotors.within().enumerate() {
            // The last tick ended where this one begins.
            let jumps = step == 0;
            let part = instant.t_s * per_tick;
            let turns = per_axis(moment.axis_count(), |i| {
                moment.actual_turns[i] - (rotors.turns(i) - instant.turns(i))
            });
            let aims = per_axis(moment.axis_count(), |i| {
                before[i] + part * (moment.aim_turns[i] - before[i])
            });
            let errors = turns.iter().zip(&aims).map(|(turns, aim)| turns - aim);
            self.errors(errors, jumps);
            let forces = instant.forces();
            self.max(Output::Torque, forces.torque_nm, jumps);
            self.posed(&machine.pose_within(&turns, &aims, &forces), jumps);
            if let Some(frame) = instant.frame() {
                self.max(Output::Ground, frame.ground_n.abs(), jumps);
            }
        }
    }
}

/// Observes the cranks while they move as commanded: in running and stopping. The motion when drives are switched on does not
/// count.
impl Observer for Answers {
    fn tick(&mut self, moment: &Moment<'_>) {
        let machine = moment.machine;
        let moves = matches!(moment.telemetry.state, State::Run | State::Stop);
        let axes = machine.axes.iter().enumerate();
        let overloaded = axes
            .filter(|(i, axis)| axis.slipped_cycles() != 0 || moves && machine.is_at_limit(*i))
            .map(|(i, _)| 1_u64 << i)
            .sum::<u64>();
        let before = self.of(Output::Slips).unwrap_or(0.0) as u64;
        self.max(Output::Slips, (before | overloaded) as f64, true);
        self.is_broken |= machine.broken().is_some();
        if moves {
            self.within(moment);
            self.at_end(moment);
        }
        self.aim_before[..moment.axis_count()].copy_from_slice(moment.aim_turns);
    }
}
