//! Checks of the settings: every number alone, and against the others.

use super::*;

impl Settings {
    /// Checks every number alone and against the others.
    ///
    /// # Errors
    /// The first setting that is wrong, with its key, its value and the allowed range.
    #[cold]
    pub fn check(&self) -> Result<(), SettingsError> {
        inside("axes.count", self.axes.len() as f64, 1.0, MAX_AXES as f64)?;
        self.control().check()?;
        if 1_000_000 % self.tick_hz != 0 {
            return Err(SettingsError::new(
                "control.tick_hz",
                Problem::NotWholeMicroseconds(self.tick_hz),
            ));
        }
        tick_cycles(self.clock_hz, self.tick_hz)?;
        self.machine.check()?;
        self.limits.check(f64::from(self.tick_hz))?;
        self.pulse.check()?;
        let tick_hz = [("control.tick_hz", f64::from(self.tick_hz))];
        INDEX_WIDTH_US.check_beside(&tick_hz, "index.width_us", self.index.width_us)?;
        for (i, cam) in self.cams.iter().enumerate() {
            cam.check(&self.master_bounds())
                .map_err(|e| e.on_entry(i))?;
        }
        for (i, axis) in self.axes.iter().enumerate() {
            axis.check(self).map_err(|e| e.on_entry(i))?;
        }
        self.drift.check()?;
        self.correction.check()?;
        self.host_loss.check()?;
        self.check_trims()?;
        self.check_commanded()
    }

    /// Returns `[control]` of a scene with these settings.
    #[cold]
    fn control(&self) -> Control {
        Control {
            tick_hz: self.tick_hz,
            park_deg: self.park_turns * 360.0,
            settle_s: self.settle_s,
        }
    }

    #[cold]
    fn check_trims(&self) -> Result<(), SettingsError> {
        for (i, &trim_turns) in self.trims_turns.iter().enumerate() {
            let axis = self.axes.get(i);
            let limit_deg = axis.map_or(0.0, |axis| axis.trim_limit_turns * 360.0);
            let limit = [("axes.trim_limit_deg", limit_deg)];
            rows::TRIM_DEG
                .check_beside(&limit, "axes.trim_deg", trim_turns * 360.0)
                .map_err(|e| e.on_entry(i))?;
        }
        Ok(())
    }
}

impl CorrectionSettings {
    #[cold]
    fn check(&self) -> Result<(), SettingsError> {
        rows::GAIN.check("correction.gain", self.gain)?;
        rows::COUPLING.check("correction.coupling", self.coupling)?;
        rows::COUPLING_PER_S.check("correction.coupling_per_s", self.coupling_per_s)?;
        Ok(())
    }
}

impl Transmission {
    #[cold]
    fn check(&self) -> Result<(), SettingsError> {
        rows::GEAR.check("axes.gear motor turns", f64::from(self.motor_turns))?;
        rows::GEAR.check("axes.gear crank turns", f64::from(self.crank_turns))?;
        Ok(())
    }
}

impl AxisSettings {
    #[cold]
    fn check(&self, settings: &Settings) -> Result<(), SettingsError> {
        let steps_per_turn = f64::from(self.steps_per_turn);
        rows::STEPS_PER_TURN.check("axes.steps_per_turn", steps_per_turn)?;
        self.gear.check()?;
        let steps = self.steps_per_crank_turn().to_f64();
        let Key { low, high, .. } = rows::STEPS_PER_TURN;
        if !(low..=high).contains(&steps) {
            let problem = Problem::StepsPerCrankTurn { steps, low, high };
            return Err(SettingsError::new("axes.gear", problem));
        }
        self.follower.check(&settings.cams)?;
        rows::OFFSET_DEG.check("axes.offset_deg", self.offset_turns * 360.0)?;
        if let Some(index_turns) = self.index_turns {
            rows::INDEX_DEG.check("axes.index_deg", index_turns * 360.0)?;
        }
        let width_deg = self.index_width_turns * 360.0;
        rows::INDEX_WIDTH_DEG.check("axes.index_width_deg", width_deg)?;
        rows::INDEX_DELAY_US.check("axes.index_delay_us", self.index_delay_s * 1e6)?;
        rows::TRIM_LIMIT_DEG.check("axes.trim_limit_deg", self.trim_limit_turns * 360.0)?;
        rows::TRIM_RATE_DEG_PER_S.check("axes.trim_rate_deg_per_s", self.trim_rate_hz * 360.0)?;
        rows::ROTOR_INERTIA_KGM2.check("axes.rotor_inertia_kgm2", self.rotor_inertia_kgm2)?;
        Ok(())
    }
}
