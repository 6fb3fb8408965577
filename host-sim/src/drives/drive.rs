//! The drive of a simulated axis: its kind of command, and the following error that it monitors.
//!
//! A drive is commanded by pulses or by setpoints. A stepper's drive turns the field and does not measure the rotor. A
//! servo's drive closes a position loop. It raises its alarm when the rotor leaves the *following-error window* around the command,
//! and continues to follow. It clears its alarm when it is switched off. A drive that counts pulses then also clears its following
//! error, and continues to count from the position of its rotor.

use cophase_core::settings::DriveKind;

/// Drive of a simulated axis.
#[derive(Clone, Copy, Debug)]
pub struct AxisDrive {
    kind: DriveKind,
    /// Steps per electrical cycle; 0 for a drive that loses none.
    cycle_steps: u32,
    window_turns: f64,
    alarm: bool,
}

impl AxisDrive {
    /// Creates a drive with an alarm at a following error of ± `window_turns` of the crank; `None` is no alarm.
    pub fn new(kind: DriveKind, cycle_steps: u32, window_turns: Option<f64>) -> Self {
        Self {
            kind,
            cycle_steps,
            window_turns: window_turns.unwrap_or(f64::INFINITY),
            alarm: false,
        }
    }

    /// Kind of drive, as the core knows it.
    pub const fn kind(&self) -> DriveKind {
        self.kind
    }

    /// True if the drive is off, drops its command, and tracks its rotor instead.
    pub const fn follows_rotor(&self, energised: bool) -> bool {
        !energised && self.kind.takes_pulses() && !self.kind.is_open_loop()
    }

    /// Steps per electrical cycle; none for a drive that measures its rotor.
    pub fn cycle_steps(&self) -> Option<u32> {
        Some(self.cycle_steps).filter(|_| self.kind.is_open_loop())
    }

    /// Takes in the following error at the end of a tick, turns: command less rotor. The alarm stays on until the drive is off.
    pub fn monitor(&mut self, error_turns: f64, energised: bool) {
        self.alarm = energised && (self.alarm || error_turns.abs() > self.window_turns);
    }

    /// True if the alarm of the drive is on.
    pub const fn alarm(&self) -> bool {
        self.alarm
    }
}
