//! External events of a scene, and their times.

use cophase_core::supervisor::{Command, SafetyInputs};
use cophase_scene::SceneError;
use cophase_scene::file::{
    CommandName, FaultAt, FaultName, InputAt, InputLine, MIN_ENABLE_LOSS_US, Scene,
};

use crate::checked::Checked;
use crate::virtual_time::TICKS_PER_S;

/// Inputs that were active between two readings.
#[derive(Clone, Copy, Debug, Default)]
struct Noted {
    /// The stop input was active.
    stop: bool,
    /// The enable input was open for long enough.
    enable_loss: bool,
    /// Time at which the enable input opened last, µs.
    opened_us: u64,
}

/// Commands and input changes, in order of time.
#[derive(Clone, Debug)]
pub struct Schedule {
    commands: Vec<(u64, Command)>,
    inputs: Vec<(u64, InputAt)>,
    late: Vec<(u64, u64)>,
    /// Time at which the last fault begins, µs.
    last_fault_us: u64,
    /// Time up to which commands and inputs have been requested, µs.
    requested_us: u64,
    next_command: usize,
    next_input: usize,
    /// Levels after all changes so far.
    lines: SafetyInputs,
    /// Changes since the last reading, as the board notes them between two readings.
    noted: Noted,
    /// Time before which the machine stands, if no fault stops it, µs.
    stands_us: u64,
    expected_us: u64,
    /// Latest end of the run, µs.
    end_us: u64,
}

/// Time for which a machine may still run after the expected end of the scene, µs.
const PATIENCE_US: u64 = 120 * TICKS_PER_S;

impl Schedule {
    /// Creates the schedule of a scene whose program lasts `program_ticks`. A scene without a start command
    /// is started at once.
    pub fn new(checked: &Checked, program_ticks: u64) -> Self {
        let scene = &checked.scene;
        let mut commands: Vec<_> = scene
            .command
            .iter()
            .map(|command| (clock(command.at_s), core_command(command.r#do)))
            .collect();
        if !commands
            .iter()
            .any(|(_, command)| *command == Command::Start)
        {
            commands.insert(0, (0, Command::Start));
        }
        let mut inputs: Vec<_> = scene
            .input
            .iter()
            .map(|input| (clock(input.at_s), *input))
            .collect();
        commands.sort_by_key(|(at, _)| *at);
        inputs.sort_by_key(|(at, _)| *at);
        let times = commands.iter().map(|(at, _)| *at);
        let last_us = times.chain(inputs.iter().map(|(at, _)| *at)).max();
        let last_us = last_us.unwrap_or(0);
        let faults = scene.fault.iter().map(|fault| clock(fault.at_s));
        let last_fault_us = faults.max().unwrap_or(0);
        let late = scene
            .late
            .iter()
            .map(|late| (clock(late.at_s), late.by_us as u64));
        // An overrun makes the loop late by one tick for each deadline that it misses.
        let tick_us = TICKS_PER_S / u64::from(scene.control.tick_hz);
        let overruns = scene
            .fault
            .iter()
            .filter(|fault| fault.kind == FaultName::Overrun)
            .map(|fault| {
                (
                    clock(fault.at_s),
                    u64::from(fault.count.unwrap_or(0)) * tick_us,
                )
            });
        let late = late.chain(overruns).collect();
        let program_s = program_ticks as f64 / f64::from(scene.control.tick_hz);
        // Time to switch on, and three and a half turns at homing speed, to home and to park.
        let around_s = scene.control.settle_s + 3.5 / scene.limits.homing_speed_hz;
        let program_us = clock(program_s + around_s);
        let expected_us = program_us + last_us.max(last_fault_us);
        Self {
            commands,
            inputs,
            late,
            last_fault_us,
            requested_us: 0,
            next_command: 0,
            next_input: 0,
            lines: SafetyInputs {
                enable: true,
                stop: false,
            },
            noted: Noted::default(),
            stands_us: program_us + last_us + PATIENCE_US,
            expected_us,
            end_us: expected_us + PATIENCE_US,
        }
    }

    /// Refuses a fault that would come when the machine has long been standing: nothing would show it.
    ///
    /// # Errors
    /// There is such a fault.
    pub fn check(&self, scene: &Scene) -> Result<(), SceneError> {
        let is_late = |fault: &FaultAt| clock(fault.at_s) > self.stands_us;
        let Some(entry) = scene.fault.iter().position(is_late) else {
            return Ok(());
        };
        let problem = format!(
            "the fault comes at {} s, and the machine stands before {:.0} s; give an earlier time, or a [[command]] that starts the machine later",
            scene.fault[entry].at_s,
            self.stands_us as f64 / TICKS_PER_S as f64
        );
        Err(SceneError::for_key(format!("fault[{entry}].at_s"), problem))
    }

    /// Returns the command that is due, if there is one. Each is returned once.
    pub fn command(&mut self, now: u64) -> Option<Command> {
        self.requested_us = now;
        let &(at, command) = self.commands.get(self.next_command)?;
        if at > now {
            return None;
        }
        self.next_command += 1;
        Some(command)
    }

    /// Returns the next change of a safety input that is due. Each is returned once.
    pub fn input(&mut self, now: u64) -> Option<InputAt> {
        let &(at, input) = self.inputs.get(self.next_input)?;
        if at > now {
            return None;
        }
        self.next_input += 1;
        let noted = &mut self.noted;
        match input.line {
            InputLine::Enable => {
                if self.lines.enable && !input.active {
                    noted.opened_us = at;
                }
                if !self.lines.enable && input.active {
                    noted.enable_loss |= at - noted.opened_us >= MIN_ENABLE_LOSS_US;
                }
                self.lines.enable = input.active;
            }
            InputLine::Stop => {
                noted.stop |= self.lines.stop || input.active;
                self.lines.stop = input.active;
            }
        }
        Some(input)
    }

    /// Reads the safety inputs, after [`Self::input`] has returned all changes: their levels, and what was active at any time since the
    /// last reading.
    pub fn read_lines(&mut self) -> SafetyInputs {
        let noted = core::mem::take(&mut self.noted);
        self.noted.opened_us = noted.opened_us;
        SafetyInputs {
            enable: self.lines.enable && !noted.enable_loss,
            stop: self.lines.stop || noted.stop,
        }
    }

    /// True if no event is left.
    pub fn is_over(&self) -> bool {
        self.next_command == self.commands.len()
            && self.next_input == self.inputs.len()
            && self.last_fault_us <= self.requested_us
    }

    /// Approximate duration of the run, µs.
    pub const fn expected_us(&self) -> u64 {
        self.expected_us
    }

    /// Latest end of the run, µs.
    pub const fn end_us(&self) -> u64 {
        self.end_us
    }

    /// Limits the end of the run to `end_us`, µs.
    #[must_use]
    pub fn ending_by(mut self, end_us: u64) -> Self {
        self.end_us = self.end_us.min(end_us);
        self
    }

    /// Removes the commands, for a host that gives them.
    #[must_use]
    pub(crate) fn without_commands(mut self) -> Self {
        self.commands.clear();
        self
    }

    /// Marks as done what an earlier schedule with the same commands and inputs has done.
    #[must_use]
    pub const fn after(mut self, earlier: &Self) -> Self {
        self.requested_us = earlier.requested_us;
        self.next_command = earlier.next_command;
        self.next_input = earlier.next_input;
        self.lines = earlier.lines;
        self.noted = earlier.noted;
        self
    }

    /// Returns the requested lateness of the loop.
    pub fn lateness(&self) -> Lateness {
        let mut late = self.late.clone();
        late.sort_unstable();
        Lateness { late, next: 0 }
    }
}

/// Requested lateness. Each entry is applied once, at the first alarm from its time on.
#[derive(Clone, Debug)]
pub struct Lateness {
    late: Vec<(u64, u64)>,
    next: usize,
}

impl Lateness {
    /// Returns the time by which the alarm at `at` is overshot, µs.
    pub fn overshoot(&mut self, at: u64) -> u64 {
        match self.late.get(self.next) {
            Some(&(from, by)) if from <= at => {
                self.next += 1;
                by
            }
            _ => 0,
        }
    }

    /// Marks as applied the entries that `earlier` has applied. The two may differ only in entries that are
    /// still to come.
    #[must_use]
    pub const fn after(mut self, earlier: &Self) -> Self {
        self.next = earlier.next;
        self
    }

    /// Longest requested lateness, µs.
    pub fn longest_us(&self) -> u64 {
        self.late.iter().map(|&(_, by)| by).max().unwrap_or(0)
    }
}

fn clock(seconds: f64) -> u64 {
    (seconds * TICKS_PER_S as f64).round() as u64
}

const fn core_command(name: CommandName) -> Command {
    match name {
        CommandName::Start => Command::Start,
        CommandName::Stop => Command::Stop,
        CommandName::Hold => Command::Hold,
        CommandName::Resume => Command::Resume,
        CommandName::ResetPeak => Command::ResetPeak,
        CommandName::Reset => Command::Reset,
    }
}
