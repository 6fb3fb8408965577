//! Required torque of each motor, on the quasi-static model level.

use super::SimulatedMachine;
use crate::axes::per_axis;
use crate::drives::SimulatedAxis;

impl SimulatedMachine {
    /// Share of the load torque that each crank carries, N·m. `torques_nm` has the torque at the angle of each crank, which is that of all
    /// cranks together; the share is the mean over the angles, divided by the number of cranks.
    pub fn share_nm(&self, torques_nm: impl Iterator<Item = f64>) -> f64 {
        let count = self.axes.len();
        torques_nm.sum::<f64>() / (count * count) as f64
    }

    /// Compares the torque that the motion of this tick needs with the torque of each motor. With the drives off there is none to compare.
    pub(super) fn compare_torques(&mut self, omega: f64, acceleration: f64, drives_enabled: bool) {
        if !drives_enabled {
            self.axes.iter_mut().for_each(SimulatedAxis::switch_off);
            self.required_nm = Some(per_axis(self.axes.len(), |_| 0.0));
            return;
        }
        // Most machines have all cranks at one angle.
        let (mut at_turns, mut nm) = (f64::NAN, 0.0);
        let torques_nm = self.axes.iter().map(|axis| {
            if axis.turns().to_bits() != at_turns.to_bits() {
                at_turns = axis.turns();
                let load = self.follower.load_at(at_turns * std::f64::consts::TAU);
                nm = load.torque_nm(omega, acceleration);
            }
            nm
        });
        let share_nm = self.share_nm(torques_nm);
        let hz = omega / std::f64::consts::TAU;
        let cranks = self.axes.iter_mut();
        let requested = cranks.map(|axis| axis.load(share_nm, acceleration, hz));
        self.required_nm = Some(requested.collect());
    }
}
