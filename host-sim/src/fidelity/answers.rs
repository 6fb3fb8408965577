//! Outputs of a run, collected in every tick, and in every step within a tick.

use cophase_core::supervisor::State;
use cophase_core::units::PerAxis;

use super::Output;
use crate::axes::per_axis;
use crate::machine::Pose;
use crate::sim::{Moment, Observer};

/// Answers of a run, one for each of [`Output::ALL`]; `None` for an output that its model level does not compute.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Answers {
    greatest: [Option<f64>; Output::ALL.len()],
    /// True if the machine's equations diverged.
    is_broken: bool,
    /// Commanded positions of the cranks at the end of the last tick, turns.
    aim_before: PerAxis<f64>,
}

impl Answers {
    /// Returns one answer.
    pub fn of(&self, output: Output) -> Option<f64> {
        self.greatest[output as usize]
    }

    /// Returns true if no motor lost a step or reached its torque limit, and the equations did not diverge. Otherwise, later
    /// values may differ with every step length and model level.
    pub fn is_regular(&self) -> bool {
        !self.is_broken && self.of(Output::Slips).is_none_or(|axes| axes == 0.0)
    }

    fn most(&mut self, output: Output, value: f64) {
        let most = &mut self.greatest[output as usize];
        *most = Some(most.map_or(value, |most| most.max(value)));
    }

    /// Adds the deviations of the cranks from their commanded positions, turns.
    fn errors(&mut self, errors: impl Iterator<Item = f64>) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for error in errors {
            low = low.min(error * 360.0);
            high = high.max(error * 360.0);
        }
        self.most(Output::Lag, high.max(-low));
        self.most(Output::Spread, high - low);
    }

    /// Adds tilt and acceleration of the platform.
    fn posed(&mut self, pose: &Pose) {
        self.most(Output::Tilt, pose.tilt_x_mrad.hypot(pose.tilt_y_mrad));
        self.most(Output::Amax, pose.accel_mps2.abs());
    }

    /// Adds the values at the end of a tick.
    fn at_end(&mut self, moment: &Moment<'_>) {
        self.errors(moment.errors());
        self.posed(&moment.pose());
        if let Some(frame) = moment.machine.frame() {
            self.most(Output::Ground, frame.ground_n.abs());
        }
        let torques = (0..moment.axis_count()).filter_map(|i| moment.machine.motor_torque_nm(i));
        if let Some(torque) = torques.map(f64::abs).max_by(f64::total_cmp) {
            self.most(Output::Torque, torque);
        }
    }

    /// Adds the values of a step within a tick. Extremes occur there, and torques jump with the commands of the drives.
    fn within(&mut self, moment: &Moment<'_>) {
        let machine = moment.machine;
        for accel_mps2 in machine
            .followers()
            .into_iter()
            .flat_map(|it| it.within_mps2())
        {
            self.most(Output::Amax, accel_mps2.abs());
        }
        let Some(rotors) = machine.rotors() else {
            return;
        };
        let per_tick = 1e9 / (moment.end_ns - moment.start_ns) as f64;
        let before = self.aim_before;
        for instant in rotors.within() {
            let part = instant.t_s * per_tick;
            let turns = per_axis(moment.axis_count(), |i| {
                moment.actual_turns[i] - (rotors.turns(i) - instant.turns(i))
            });
            let aims = per_axis(moment.axis_count(), |i| {
                before[i] + part * (moment.aim_turns[i] - before[i])
            });
            self.errors(turns.iter().zip(&aims).map(|(turns, aim)| turns - aim));
            let forces = instant.forces();
            self.most(Output::Torque, forces.torque_nm);
            self.posed(&machine.pose_within(&turns, &aims, &forces));
            if let Some(frame) = instant.frame() {
                self.most(Output::Ground, frame.ground_n.abs());
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
        self.greatest[Output::Slips as usize] = Some((before | overloaded) as f64);
        self.is_broken |= machine.broken().is_some();
        if moves {
            self.within(moment);
            self.at_end(moment);
        }
        self.aim_before[..moment.axis_count()].copy_from_slice(moment.aim_turns);
    }
}
