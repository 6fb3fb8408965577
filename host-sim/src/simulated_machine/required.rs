//! Required torque of each motor, on the quasi-static model level and for diagrams of it.

use super::SimulatedMachine;
use crate::axes::per_axis;
use crate::drives::SimulatedAxis;

impl SimulatedMachine {
    /// Share of the load torque that each crank carries, N·m, with the cranks at these angles, rad. The torque at each angle is that
    /// of all cranks together; the share is the mean over the angles, divided by the number of cranks.
    fn share_nm(
        &self,
        alphas: impl Iterator<Item = f64>,
        omega_rad_s: f64,
        acceleration_rad_s2: f64,
    ) -> f64 {
        // Most machines have all cranks at one angle.
        let (mut at_rad, mut nm) = (f64::NAN, 0.0);
        let torques = alphas.map(|alpha| {
            if alpha.to_bits() != at_rad.to_bits() {
                nm = (self.follower).torque_nm(alpha, omega_rad_s, acceleration_rad_s2);
                at_rad = alpha;
            }
            nm
        });
        let count = self.axes.len();
        torques.sum::<f64>() / (count * count) as f64
    }

    /// Torque that a motion of the master requires of motor `i`, N·m at its crank, with the cranks at these angles, rad, on the quasi-static model
    /// level.
    pub fn required_nm(
        &self,
        i: usize,
        alphas: impl Iterator<Item = f64>,
        omega_rad_s: f64,
        acceleration_rad_s2: f64,
    ) -> f64 {
        let share_nm = self.share_nm(alphas, omega_rad_s, acceleration_rad_s2);
        let hz = omega_rad_s / std::f64::consts::TAU;
        self.axes[i].required_nm(share_nm, acceleration_rad_s2, hz)
    }

    /// Compares the torque that the motion of this tick needs with the torque of each motor. With the drives off there is none to compare.
    pub(super) fn compare_torques(&mut self, omega: f64, acceleration: f64, drives_enabled: bool) {
        if !drives_enabled {
            self.axes.iter_mut().for_each(SimulatedAxis::switch_off);
            self.required_nm = Some(per_axis(self.axes.len(), |_| 0.0));
            return;
        }
        let alphas = self.axes.iter();
        let alphas = alphas.map(|axis| axis.turns() * std::f64::consts::TAU);
        let share_nm = self.share_nm(alphas, omega, acceleration);
        let hz = omega / std::f64::consts::TAU;
        let cranks = self.axes.iter_mut();
        let requested = cranks.map(|axis| axis.load(share_nm, acceleration, hz));
        self.required_nm = Some(requested.collect());
    }
}
