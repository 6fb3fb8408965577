//! Torques of the motors and their effects: the figures that need the forces at the end of each tick.

use cophase_core::supervisor::State;

use super::Moment;
use super::record::{FramePeaks, RunRecord};
use super::recorder::raise;

/// Takes in the largest forces and accelerations of one tick.
pub(super) fn record_forces(moment: &Moment<'_>, record: &mut RunRecord) {
    let machine = moment.machine;
    let figures = &mut record.figures;
    if machine.torques_nm().is_some() {
        for (i, axis) in record.axes.iter_mut().enumerate() {
            let torque_nm = machine.motor_torque_nm(i).unwrap_or(0.0).abs();
            raise(axis.torque_worst_nm.get_or_insert(0.0), torque_nm);
        }
        let accel_worst_mps2 = figures.accel_worst_mps2.get_or_insert(0.0);
        if moment.drives_enabled && moment.telemetry.state == State::Run {
            raise(accel_worst_mps2, moment.pose().accel_mps2.abs());
        }
    }
    if let Some(frame) = machine.frame() {
        let peaks = figures.frame.get_or_insert(FramePeaks {
            sag_um: machine.sag_um(),
            ..FramePeaks::default()
        });
        raise(&mut peaks.ground_force_worst_n, frame.ground_n.abs());
        raise(&mut peaks.displacement_worst_um, machine.frame_um(&frame));
    }
}
