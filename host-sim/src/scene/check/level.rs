//! A checked scene on another rung.

use super::{cam, faults};
use crate::machine::Machine;
use crate::scene::file::Fidelity;
use crate::scene::{Checked, SceneError};

impl Checked {
    /// The same on a rung.
    ///
    /// # Errors
    /// What the rung needs and the scene does not say.
    pub fn on(&self, rung: Fidelity) -> Result<Self, SceneError> {
        let mut other = self.clone();
        other.fidelity = rung;
        if let Some(follower) = &self.cam {
            cam::check_rung(rung, follower)?;
        } else if rung == Fidelity::QuasiStatic && other.scene.axes.pull_out.is_empty() {
            return Err(SceneError::at(
                "axes.pull_out",
                "missing; fidelity = \"quasi-static\" compares torques, so give the motors' pull-out torque \
                 as [[speed_hz, torque_nm], …], or let fidelity be \"kinematic\"",
            ));
        }
        faults::check_rung(&other, rung)?;
        Machine::new(&other)?;
        Ok(other)
    }
}
