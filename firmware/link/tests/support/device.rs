//! A controller that records the calls of the link's server.

use std::collections::VecDeque;

use cophase_core::settings::HostLossSettings;
use cophase_core::supervisor::{Command, State};
use cophase_link::message::{Event, File, Identity, Inputs, Name, Output, Text, VERSION};
use cophase_link::sample::{Sample, flags};
use cophase_link::server::{Device, SettingsRefusal};

/// Control ticks a second.
pub const TICK_HZ: u32 = 2000;

/// Number of axes.
pub const AXES: usize = 6;

/// Inputs that it reads.
pub const INPUTS: Inputs = Inputs {
    index: 0b10_0001,
    alarm: 0b00_0010,
    enable: true,
    stop: false,
    start: true,
};

/// A controller without a loop: the test sets its state.
pub struct RecordingDevice {
    /// Everything that changed the controller, in order.
    pub effects: Vec<Effect>,
    pub samples: VecDeque<Sample>,
    pub events: VecDeque<(u32, Event)>,
    pub every: u16,
    pub now_ms: u32,
    pub settings: Vec<u8>,
    pub host_loss: HostLossSettings,
    /// No command is taken.
    pub is_busy: bool,
}

/// A change of the controller.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    Command(Command),
    Program(Vec<u8>),
    Settings(Vec<u8>),
    Restart(Option<u8>),
    Output(Option<(Output, bool)>),
}

impl RecordingDevice {
    pub fn new() -> Self {
        let mut device = Self {
            effects: Vec::new(),
            samples: VecDeque::new(),
            events: VecDeque::new(),
            every: 0,
            now_ms: 0,
            settings: (0..1000_u32).map(|i| (i * i) as u8).collect(),
            host_loss: HostLossSettings::NONE,
            is_busy: false,
        };
        device.enters(State::Idle);
        device
    }

    /// The machine is in a state, homed, with the enable input closed. A run is that of a program.
    pub fn enters(&mut self, state: State) {
        let drives = match state {
            State::Idle | State::Fault => 0,
            _ => flags::DRIVES,
        };
        self.enters_with(state, drives | flags::HOMED);
    }

    /// The machine is in a state, with the enable input closed and further flags.
    pub fn enters_with(&mut self, state: State, flags: u8) {
        self.enters_with_inputs(state, flags, true, false);
    }

    /// The machine is in a state, with levels of the inputs and further flags.
    pub fn enters_with_inputs(&mut self, state: State, more: u8, enable: bool, stop: bool) {
        let enable = if enable { flags::ENABLE } else { 0 };
        let stop = if stop { flags::STOP } else { 0 };
        self.samples.push_back(Sample {
            state: state as u8,
            flags: more | enable | stop,
            ..Sample::ZERO
        });
    }
}

impl Device for RecordingDevice {
    fn identity(&self) -> Identity {
        let name = |text: &str| Name::try_from(text).unwrap();
        Identity {
            version: VERSION,
            board: name("test"),
            serial: 0x0123_4567_89AB_CDEF,
            firmware: name("1.2.3"),
            settings: name("machine"),
            settings_crc: 1,
            program_crc: 2,
            axes: AXES as u8,
            tick_hz: TICK_HZ,
            can_run: true,
            only_axis: None,
            restarts: 0,
        }
    }

    fn axes(&self) -> usize {
        AXES
    }

    fn tick_hz(&self) -> u32 {
        TICK_HZ
    }

    fn now_ms(&self) -> u32 {
        self.now_ms
    }

    fn file(&self, file: File) -> &[u8] {
        match file {
            File::Settings => &self.settings,
            File::Program => b"program",
        }
    }

    fn command(&mut self, command: Command) -> bool {
        if !self.is_busy {
            self.effects.push(Effect::Command(command));
        }
        !self.is_busy
    }

    fn set_sampling(&mut self, every: u16) {
        self.every = every;
    }

    fn next_sample(&mut self) -> Option<Sample> {
        self.samples.pop_front()
    }

    fn next_event(&mut self) -> Option<(u32, Event)> {
        self.events.pop_front()
    }

    fn load_program(&mut self, program: &[u8]) -> Result<(), Text> {
        self.effects.push(Effect::Program(program.to_vec()));
        Ok(())
    }

    fn store_settings(&mut self, settings_file: &[u8]) -> Result<(), SettingsRefusal> {
        self.effects.push(Effect::Settings(settings_file.to_vec()));
        Ok(())
    }

    fn restart(&mut self, only_axis: Option<u8>) -> Result<(), Text> {
        self.effects.push(Effect::Restart(only_axis));
        Ok(())
    }

    fn host_loss(&self) -> HostLossSettings {
        self.host_loss
    }

    fn inputs(&self) -> Inputs {
        INPUTS
    }

    fn hold_output(&mut self, output: Option<(Output, bool)>) -> Result<(), Text> {
        self.effects.push(Effect::Output(output));
        Ok(())
    }
}
