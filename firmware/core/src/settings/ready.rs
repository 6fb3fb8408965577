//! From settings to a running loop: everything that may be wrong is found first, then the loop is made.

use super::{Problem, Settings, SettingsError, turns};
use crate::controller::{Controller, Prepared};
use crate::program::Program;
use crate::units::{PerAxis, Turns};

impl Settings {
    /// The loop at power-up: settings and program checked, trims set.
    ///
    /// # Errors
    /// As [`Self::ready`].
    pub fn controller(&self) -> Result<Controller, SettingsError> {
        Ok(self.ready()?.controller())
    }

    /// Everything that a loop is made of, checked.
    ///
    /// # Errors
    /// The first setting, program entry or trim that is wrong.
    pub fn ready(&self) -> Result<Ready<'_>, SettingsError> {
        // Before the program: the speed of a level is computed from settings.
        self.check()?;
        let program = self.program()?;
        let prepared = Prepared::new(self)?;
        let mut trims = PerAxis::default();
        for (i, &trim_turns) in self.trims_turns.iter().enumerate() {
            let limit_turns = self.axes.get(i).map_or(0.0, |axis| axis.trim_limit_turns);
            // Also refuses what is not a number.
            if !(-limit_turns..=limit_turns).contains(&trim_turns) {
                let problem = Problem::TrimPastLimit {
                    trim_deg: trim_turns * 360.0,
                    limit_deg: limit_turns * 360.0,
                };
                return Err(SettingsError::new("axes.trim_deg", problem).on_entry(i));
            }
            if let Some(trim) = trims.get_mut(i) {
                *trim = turns(trim_turns);
            }
        }
        Ok(Ready {
            settings: self,
            program,
            prepared,
            trims,
        })
    }

    fn program(&self) -> Result<Program, SettingsError> {
        let mut builder = self.program_builder();
        for (i, entry) in self.program.iter().enumerate() {
            builder.entry(entry).map_err(|error| error.on_entry(i))?;
        }
        builder.build()
    }
}

/// Everything that a loop is made of, with nothing wrong in it.
#[derive(Clone, Debug)]
pub struct Ready<'a> {
    settings: &'a Settings,
    program: Program,
    prepared: Prepared,
    trims: PerAxis<Turns>,
}

impl Ready<'_> {
    /// The loop at power-up.
    pub fn controller(&self) -> Controller {
        let program = self.program.clone();
        let mut controller = Controller::assembled(&self.prepared, self.settings, program);
        for (axis, &trim) in self.trims.iter().enumerate().take(self.settings.axes.len()) {
            // At the very limit, which is rounded down, a trim may lose the last of its 48 fraction bits.
            let _whole = controller.set_trim(axis, trim);
        }
        controller
    }
}
