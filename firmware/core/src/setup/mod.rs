//! Everything that one machine's loop is told, as a single value: settings, trims and program.
//!
//! [`Settings`] has its number of axes in its type, because the tick does; whoever reads a scene or a
//! stored blob learns that number only then. A [`Setup`] has it as data, and [`Setup::controller`] is the one
//! way from there to a running loop, on a board and on a desk.
//!
//! Nothing in a setup has been checked: it may come from a memory chip. What is wrong with it is found when
//! its controller is made.

use heapless::{String, Vec};

use crate::controller::{Controller, Prepared};
use crate::program::{CAPACITY, EntrySettings, Program};
use crate::settings::{
    AxisSettings, CorrectionSettings, DriftSettings, IndexSettings, LimitSettings, MAX_AXES,
    MachineSettings, Problem, PulseSettings, Settings, SettingsError, turns,
};
use crate::units::Turns;

/// Longest name, bytes of UTF-8.
pub const NAME_BYTES: usize = 32;

/// Everything that the loop of a machine is told, whatever its number of axes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Setup {
    /// What to call it, in logs; see [`short_name`].
    pub name: String<NAME_BYTES>,
    /// As [`Settings::tick_hz`].
    pub tick_hz: u32,
    /// The mechanism and what it carries.
    pub machine: MachineSettings,
    /// What the master shaft may do.
    pub limits: LimitSettings,
    /// The step lines' timing.
    pub pulse: PulseSettings,
    /// What counts as a pulse of an index line.
    pub index: IndexSettings,
    /// One entry an axis.
    pub axes: Vec<AxisSettings, MAX_AXES>,
    /// Trims that are set at start, turns, axis by axis; an axis without an entry has none.
    pub trims_turns: Vec<f64, MAX_AXES>,
    /// How far the cranks may be apart.
    pub drift: DriftSettings,
    /// What is done against what drives them apart.
    pub correction: CorrectionSettings,
    /// As [`Settings::park_turns`].
    pub park_turns: f64,
    /// As [`Settings::settle_s`].
    pub settle_s: f64,
    /// amax(t): segments, and repeats of what stands before them.
    pub program: Vec<EntrySettings, CAPACITY>,
}

impl Setup {
    /// How many axes it is for.
    pub fn axes_count(&self) -> usize {
        self.axes.len()
    }

    /// The settings alone, for a loop of `N` axes.
    ///
    /// # Errors
    /// `N` is not [`Self::axes_count`], or that is no number of axes that a machine has. The settings have not
    /// been checked otherwise.
    pub fn settings<const N: usize>(&self) -> Result<Settings<N>, SettingsError> {
        const KEY: &str = "axes.count";
        let count = self.axes_count();
        crate::settings::inside(KEY, count as f64, 2.0, MAX_AXES as f64)?;
        let axes = <[AxisSettings; N]>::try_from(self.axes.as_slice())
            .map_err(|_| SettingsError::new(KEY, Problem::OtherAxisCount(count, N)))?;
        Ok(Settings {
            tick_hz: self.tick_hz,
            machine: self.machine,
            limits: self.limits.clone(),
            pulse: self.pulse,
            index: self.index,
            axes,
            drift: self.drift,
            correction: self.correction,
            park_turns: self.park_turns,
            settle_s: self.settle_s,
        })
    }

    /// The loop at power-up: settings and program checked, trims set.
    ///
    /// # Errors
    /// As [`Self::ready`].
    pub fn controller<const N: usize>(&self) -> Result<Controller<N>, SettingsError> {
        Ok(self.ready()?.controller())
    }

    /// All that a loop is made of, checked.
    ///
    /// # Errors
    /// `N` is not [`Self::axes_count`], or the first setting, program entry or trim that is wrong.
    pub fn ready<const N: usize>(&self) -> Result<Ready<N>, SettingsError> {
        let settings = self.settings::<N>()?;
        // Before the program: what a level needs is reckoned from settings.
        settings.check()?;
        let program = self.program(&settings)?;
        let prepared = Prepared::new(&settings)?;
        let mut trims = [Turns::ZERO; N];
        for (i, &trim_turns) in self.trims_turns.iter().enumerate() {
            let limit_turns = settings
                .axes
                .get(i)
                .map_or(0.0, |axis| axis.trim_limit_turns);
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
            settings,
            program,
            prepared,
            trims,
        })
    }

    fn program<const N: usize>(&self, settings: &Settings<N>) -> Result<Program, SettingsError> {
        let mut builder = settings.program_builder();
        for (i, entry) in self.program.iter().enumerate() {
            builder.entry(entry).map_err(|error| error.on_entry(i))?;
        }
        builder.build()
    }
}

/// All that a loop is made of, with nothing wrong in it.
#[derive(Clone, Debug)]
pub struct Ready<const N: usize> {
    settings: Settings<N>,
    program: Program,
    prepared: Prepared<N>,
    trims: [Turns; N],
}

impl<const N: usize> Ready<N> {
    /// The loop at power-up.
    pub fn controller(&self) -> Controller<N> {
        let program = self.program.clone();
        let mut controller = Controller::assembled(&self.prepared, &self.settings, program);
        for (axis, &trim) in self.trims.iter().enumerate() {
            // At the very limit, which is rounded down, a trim may lose the last of its 48 fraction bits.
            let _whole = controller.set_trim(axis, trim);
        }
        controller
    }

    /// Control ticks a second.
    pub const fn tick_hz(&self) -> u32 {
        self.settings.tick_hz
    }

    /// Cycles of the step clock that a level of an index line must last.
    pub fn index_width_cycles(&self) -> u32 {
        self.settings.index.width_cycles()
    }

    /// Whether an axis is mounted the other way round: its DIR is to be turned.
    pub fn is_reversed(&self, axis: usize) -> bool {
        let axis = self.settings.axes.get(axis);
        axis.is_some_and(|axis| axis.reversed)
    }
}

/// The longest beginning of a name that a [`Setup`] holds, in whole characters.
pub fn short_name(name: &str) -> String<NAME_BYTES> {
    let mut short = String::new();
    for c in name.chars() {
        if short.push(c).is_err() {
            break;
        }
    }
    short
}

#[cfg(test)]
mod tests;
