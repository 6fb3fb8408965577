//! Checks of the parts of the settings: every number alone.

use super::*;

impl CorrectionSettings {
    #[cold]
    pub(super) fn check(&self) -> Result<(), SettingsError> {
        inside("correction.gain", self.gain, 0.0, 1.0)?;
        inside("correction.coupling", self.coupling, 0.0, 20.0)?;
        let per_s = self.coupling_per_s;
        inside("correction.coupling_per_s", per_s, 0.0, 10_000.0)?;
        Ok(())
    }
}

impl IndexSettings {
    #[cold]
    pub(super) fn check(&self, tick_hz: u32) -> Result<(), SettingsError> {
        let width_us = inside("index.width_us", self.width_us, 0.1, 100.0)?;
        let most_us = 1e6 / f64::from(tick_hz * MOST_OF_TICK);
        if width_us > most_us {
            let problem = Problem::IndexTooLong { width_us, most_us };
            return Err(SettingsError::new("index.width_us", problem));
        }
        Ok(())
    }
}

impl MachineSettings {
    /// Checks every number.
    ///
    /// # Errors
    /// The first number that is wrong.
    #[cold]
    pub fn check(&self) -> Result<(), SettingsError> {
        inside(
            "machine.crank_radius_mm",
            self.crank_radius_m * 1e3,
            0.1,
            500.0,
        )?;
        self.mechanism.check()?;
        inside("machine.load_kg", self.load_kg, 1e-3, 50.0)?;
        inside("machine.gravity_mps2", self.gravity_mps2, 0.0, 20.0)?;
        inside(
            "machine.mount_radius_mm",
            self.mount_radius_m * 1e3,
            10.0,
            5000.0,
        )?;
        Ok(())
    }
}

impl AxisSettings {
    #[cold]
    pub(super) fn check(&self, settings: &Settings) -> Result<(), SettingsError> {
        inside(
            "axes.steps_per_turn",
            f64::from(self.steps_per_turn),
            4.0,
            65_536.0,
        )?;
        self.follower.check(settings)?;
        inside("axes.offset_deg", self.offset_turns * 360.0, -180.0, 180.0)?;
        if let Some(index_turns) = self.index_turns {
            inside("axes.index_deg", index_turns * 360.0, -180.0, 180.0)?;
        }
        inside(
            "axes.index_width_deg",
            self.index_width_turns * 360.0,
            0.0,
            90.0,
        )?;
        inside("axes.index_delay_us", self.index_delay_s * 1e6, 0.0, 1000.0)?;
        inside(
            "axes.trim_limit_deg",
            self.trim_limit_turns * 360.0,
            0.0,
            36.0,
        )?;
        inside(
            "axes.trim_rate_deg_per_s",
            self.trim_rate_hz * 360.0,
            1e-3,
            360.0,
        )?;
        inside(
            "axes.rotor_inertia_kgm2",
            self.rotor_inertia_kgm2,
            0.0,
            10.0,
        )?;
        Ok(())
    }
}
