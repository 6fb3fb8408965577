//! Torques of the motors and their effects: the figures that need the forces at the end of each tick.

use cophase_core::supervisor::State;

use super::statistics::{FramePeaks, raise};
use super::{Moment, Observer};

/// Largest forces and accelerations of a run. A run without this observer does not compute them.
#[derive(Clone, Debug, Default)]
pub struct PeakForces {
    /// See [`super::Statistics::worst_torque_nm`].
    pub worst_torque_nm: Vec<f64>,
    /// See [`super::Statistics::worst_accel_mps2`].
    pub worst_accel_mps2: f64,
    /// See [`super::Statistics::frame`].
    pub frame: Option<FramePeaks>,
}

impl Observer for PeakForces {
    fn tick(&mut self, moment: &Moment<'_>) {
        let machine = moment.machine;
        if let Some(torques) = machine.torques_nm() {
            self.worst_torque_nm.resize(torques.len(), 0.0);
            for (i, worst) in self.worst_torque_nm.iter_mut().enumerate() {
                raise(worst, machine.motor_torque_nm(i).unwrap_or(0.0).abs());
            }
            if moment.drives_enabled && moment.telemetry.state == State::Run {
                raise(&mut self.worst_accel_mps2, moment.pose().accel_mps2.abs());
            }
        }
        if let Some(frame) = machine.frame() {
            let peaks = self.frame.get_or_insert(FramePeaks {
                sag_um: machine.sag_um(),
                ..FramePeaks::default()
            });
            raise(&mut peaks.worst_ground_n, frame.ground_n.abs());
            raise(&mut peaks.worst_um, machine.frame_um(&frame));
        }
    }
}
