//! The outputs of a run, gathered tick by tick.

use cophase_core::supervisor::State;

use super::Output;
use crate::sim::{Moment, Observer};

/// What a run answered, an entry for each of [`Output::ALL`]; none where its rung does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Answers([Option<f64>; Output::ALL.len()]);

impl Answers {
    /// One of them.
    pub fn of(&self, output: Output) -> Option<f64> {
        self.0[output as usize]
    }

    fn most(&mut self, output: Output, value: f64) {
        let most = &mut self.0[output as usize];
        *most = Some(most.map_or(value, |most| most.max(value)));
    }
}

/// Looks on while cranks move as they are told: in running and stopping. What drives do as they are switched on is not
/// asked for.
impl Observer for Answers {
    fn tick(&mut self, moment: &Moment<'_>) {
        let axes = moment.machine.axes.iter().enumerate();
        let slipped = axes
            .filter(|(_, axis)| axis.slipped_cycles() != 0)
            .map(|(i, _)| 1_u64 << i)
            .sum::<u64>();
        let before = self.of(Output::Slips).unwrap_or(0.0) as u64;
        self.0[Output::Slips as usize] = Some((before | slipped) as f64);
        if !matches!(moment.telemetry.state, State::Run | State::Stop) {
            return;
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for error in moment.errors() {
            low = low.min(error * 360.0);
            high = high.max(error * 360.0);
        }
        self.most(Output::Lag, high.max(-low));
        self.most(Output::Spread, high - low);
        let pose = moment.pose();
        self.most(Output::Tilt, pose.tilt_x_mrad.hypot(pose.tilt_y_mrad));
        self.most(Output::Amax, pose.accel_mps2.abs());
        if let Some(frame) = moment.machine.frame() {
            self.most(Output::Ground, frame.ground_n.abs());
        }
        let torques = (0..moment.axis_count()).filter_map(|i| moment.machine.motor_torque_nm(i));
        if let Some(torque) = torques.map(f64::abs).max_by(f64::total_cmp) {
            self.most(Output::Torque, torque);
        }
    }
}
