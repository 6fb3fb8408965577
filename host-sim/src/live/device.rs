//! The simulated controller as the link's server needs it.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use cophase_core::control_loop;
use cophase_core::program::Program;
use cophase_core::settings::{HostLossSettings, Settings, short_name};
use cophase_core::supervisor::Command;
use cophase_link::header::{FIRST_SEQUENCE, OUTSIDE};
use cophase_link::message::{Event, File, Identity, Inputs, Name, Output, Text, VERSION, text};
use cophase_link::program::{self, MAX_PROGRAM_BYTES};
use cophase_link::sample::Sample;
use cophase_link::server::{Device, SettingsRefusal};
use cophase_link::{Header, MAX_FILE_BYTES, decode_into, encode};
use cophase_scene::SceneError;
use cophase_scene::file::{FaultAt, FaultName};

use super::paced::{FromLoop, Paced, ToLoop};
use crate::checked::Checked;
use crate::sim::{SimulatedIo, schedule::Schedule};
use crate::virtual_time;

/// Greatest number of samples and events that wait for the host.
const WAITING: usize = 4096;

/// Greatest number of commands and programs that wait for the loop.
const COMMANDS: usize = 64;

/// Longest wait for an answer of the loop.
const ANSWERS_WITHIN: Duration = Duration::from_secs(2);

/// Reason why a simulated machine cannot be brought up.
const NO_WIRING: &str = "a simulated machine has no wiring to bring up; connect a board";

/// Reason why something is not possible while only one axis runs.
const ONE_AXIS: &str = "bring-up has one axis only; restart the controller first";

/// A simulated controller and its machine.
pub struct SimulatedDevice {
    checked: Checked,
    speed: f64,
    /// Faults can be injected.
    is_open: bool,
    settings_file: Vec<u8>,
    /// Settings that take effect at the next restart.
    stored: Option<Box<Settings>>,
    program_file: Vec<u8>,
    sampling: u16,
    began: Instant,
    restarts: u32,
    /// Axis that is the only one until the next restart.
    only_axis: Option<u8>,
    running: Running,
}

/// The thread of the loop.
struct Running {
    to_loop: Option<SyncSender<ToLoop>>,
    from_loop: Receiver<FromLoop>,
    event: Option<(u32, Event)>,
    sample: Option<Sample>,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedDevice {
    /// Switches on the controller and the machine of a scene, at `speed` simulated seconds per second.
    ///
    /// # Errors
    /// The machine or the controller of the scene cannot be made.
    pub fn new(checked: Checked, speed: f64) -> Result<Self, SceneError> {
        Self::power_up(checked, speed, false)
    }

    /// The same, with a machine that [`Self::inject`] can disturb.
    ///
    /// # Errors
    /// The machine or the controller of the scene cannot be made.
    pub fn open_to_faults(checked: Checked, speed: f64) -> Result<Self, SceneError> {
        Self::power_up(checked, speed, true)
    }

    fn power_up(checked: Checked, speed: f64, is_open: bool) -> Result<Self, SceneError> {
        let running = Running::new(&checked, None, speed)?;
        let mut device = Self {
            checked,
            speed,
            is_open,
            settings_file: Vec::new(),
            stored: None,
            program_file: Vec::new(),
            sampling: 1,
            began: Instant::now(),
            restarts: 0,
            only_axis: None,
            running,
        };
        device.make_files();
        Ok(device)
    }

    /// Encodes the files of the settings that run.
    fn make_files(&mut self) {
        let settings = &self.checked.settings;
        let mut buffer = vec![0; MAX_FILE_BYTES];
        // Both buffers are large enough for any settings.
        let file = encode(settings, FIRST_SEQUENCE, OUTSIDE, &mut buffer);
        self.settings_file = file.map(<[u8]>::to_vec).unwrap_or_default();
        let mut buffer = [0; MAX_PROGRAM_BYTES];
        let file = program::encode(settings, &mut buffer);
        self.program_file = file.unwrap_or_default().to_vec();
    }

    /// Injects a fault that begins at the next tick, whatever its `at_s`.
    ///
    /// # Errors
    /// The fault is not one that the machine of the scene can have. The error names the key, as in a scene.
    pub fn inject(&mut self, fault: &FaultAt) -> Result<(), SceneError> {
        let refused = |key: &str, problem: &str| Err(SceneError::for_key(key, problem));
        if !self.is_open {
            return refused(
                "",
                "this simulated machine takes the faults of its scene only",
            );
        }
        if self.only_axis.is_some() {
            return refused("", ONE_AXIS);
        }
        if fault.kind == FaultName::Overrun {
            return refused(
                "fault[0].kind",
                "\"overrun\" is a fault of the computer that runs the loop; give it in a scene, for `cophase run`",
            );
        }
        let mut scene = self.checked.scene.clone();
        scene.fault = vec![*fault];
        // The fault must be possible on the model level that was chosen at power-up.
        scene.fidelity = self.checked.fidelity;
        let checked = Checked::new(scene)?;
        if self.send(ToLoop::Fault(Box::new(checked.scene.fault[0]))) {
            Ok(())
        } else {
            refused(
                "",
                "the control loop does not answer; start the simulated controller again",
            )
        }
    }

    fn send(&self, item: ToLoop) -> bool {
        let to_loop = self.running.to_loop.as_ref();
        to_loop.is_some_and(|to_loop| to_loop.try_send(item).is_ok())
    }
}

impl Running {
    /// Starts the loop of a scene, with all axes or only one.
    fn new(checked: &Checked, only_axis: Option<u8>, speed: f64) -> Result<Self, SceneError> {
        let mut checked = checked.clone();
        let controller = match only_axis {
            Some(axis) => {
                checked = checked.only_axis(axis.into());
                let mut settings = checked.settings.clone();
                settings.ignore_index();
                settings.controller()?
            }
            None => checked.controller()?,
        };
        let mut controller = Box::new(controller);
        let (to_loop, from_host) = sync_channel(COMMANDS);
        let (to_host, from_loop) = sync_channel(WAITING);
        let (made, is_made) = sync_channel(1);
        let run = move || {
            let ticks = controller.program().0.duration();
            let schedule = Schedule::new(&checked, ticks).without_commands();
            let inner = SimulatedIo::new(&checked, schedule);
            // The creator of the thread waits for this message.
            match inner {
                Ok(inner) => {
                    let _ = made.send(Ok(()));
                    let mut io = Paced::new(inner, speed, from_host, to_host);
                    virtual_time::run(control_loop::run(&mut controller, &mut io), |_| 0);
                }
                Err(error) => {
                    let _ = made.send(Err(error));
                }
            }
        };
        let thread = std::thread::Builder::new().name("control loop".to_owned());
        let mut running = Self {
            to_loop: Some(to_loop),
            from_loop,
            event: None,
            sample: None,
            // Without a thread there is no loop, and every command is refused.
            thread: thread.spawn(run).ok(),
        };
        // Without an answer there is no thread, so there is no error of the machine.
        is_made.recv().unwrap_or(Ok(()))?;
        // The first message comes after the first tick. From here on, the state is known.
        if let Ok(first) = running.from_loop.recv_timeout(ANSWERS_WITHIN) {
            running.put(first);
        }
        Ok(running)
    }

    fn put(&mut self, item: FromLoop) {
        match item {
            FromLoop::Event(tick, event) => self.event = Some((tick, event)),
            FromLoop::Sample(sample) => self.sample = Some(sample),
        }
    }

    /// Fetches messages from the loop as long as there is room for them.
    fn fetch(&mut self) {
        while self.event.is_none() && self.sample.is_none() {
            match self.from_loop.try_recv() {
                Ok(item) => self.put(item),
                Err(_) => return,
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // The loop ends when its channel for commands is closed.
        self.to_loop = None;
        if let Some(thread) = self.thread.take() {
            // A panic of the loop has been printed already.
            let _ = thread.join();
        }
    }
}

impl Device for SimulatedDevice {
    fn identity(&self) -> Identity {
        let settings = &self.checked.settings;
        let name = |text: &str| Name::try_from(&*short_name(text)).unwrap_or_default();
        let header = Header::read(&self.settings_file).ok();
        Identity {
            version: VERSION,
            board: name("simulated"),
            serial: 0,
            firmware: name(env!("CARGO_PKG_VERSION")),
            settings: name(&settings.name),
            settings_crc: header.map_or(0, |header| header.payload_crc),
            program_crc: cophase_link::checksum(&self.program_file),
            axes: self.axes() as u8,
            tick_hz: settings.tick_hz,
            can_run: self.running.thread.is_some(),
            only_axis: self.only_axis,
            restarts: self.restarts,
        }
    }

    fn axes(&self) -> usize {
        match self.only_axis {
            Some(_) => 1,
            None => self.checked.settings.axes.len(),
        }
    }

    fn tick_hz(&self) -> u32 {
        self.checked.settings.tick_hz
    }

    fn now_ms(&self) -> u32 {
        self.began.elapsed().as_millis() as u32
    }

    fn file(&self, file: File) -> &[u8] {
        match file {
            File::Settings => &self.settings_file,
            File::Program => &self.program_file,
        }
    }

    fn command(&mut self, command: Command) -> bool {
        self.send(ToLoop::Command(command))
    }

    fn set_sampling(&mut self, every: u16) {
        self.sampling = every;
        self.send(ToLoop::Sampling(every));
    }

    fn next_sample(&mut self) -> Option<Sample> {
        self.running.fetch();
        self.running.sample.take()
    }

    fn next_event(&mut self) -> Option<(u32, Event)> {
        self.running.fetch();
        self.running.event.take()
    }

    fn load_program(&mut self, bytes: &[u8]) -> Result<(), Text> {
        if self.only_axis.is_some() {
            return Err(text(&ONE_AXIS));
        }
        let mut program = Box::new(Program::new());
        let builder = self.checked.settings.program_builder(&mut program);
        program::fill(bytes, builder).map_err(|error| text(&error))?;
        let (loaded, is_loaded) = sync_channel(1);
        self.send(ToLoop::Program(program, loaded));
        match is_loaded.recv_timeout(ANSWERS_WITHIN) {
            Ok(true) => {
                self.program_file = bytes.to_vec();
                Ok(())
            }
            Ok(false) => Err(text(&"the machine has begun to move")),
            Err(_) => Err(text(&"the control loop does not answer")),
        }
    }

    fn store_settings(&mut self, settings_file: &[u8]) -> Result<(), SettingsRefusal> {
        let rejected = |error: &dyn std::fmt::Display| {
            SettingsRefusal::Rejected(text(&format_args!("{error}")))
        };
        let mut settings = Box::new(Settings::new());
        decode_into(settings_file, &mut settings).map_err(|error| rejected(&error))?;
        settings.clock_hz = self.checked.settings.clock_hz;
        settings.controller().map_err(|error| rejected(&error))?;
        let axes = self.checked.settings.axes.len();
        if settings.axes.len() != axes {
            let problem = format!(
                "axes.count: the simulated machine has {axes} axes; simulate a machine of these settings instead"
            );
            return Err(rejected(&problem));
        }
        self.stored = Some(settings);
        Ok(())
    }

    fn restart(&mut self, only_axis: Option<u8>) -> Result<(), Text> {
        let axes = self.checked.settings.axes.len();
        if let Some(axis) = only_axis.filter(|&axis| usize::from(axis) >= axes) {
            return Err(text(&format_args!(
                "there is no axis {axis}; the settings have {axes}, counted from 0"
            )));
        }
        let stored = self.stored.take();
        let before = stored.map(|stored| core::mem::replace(&mut self.checked.settings, *stored));
        let running = match Running::new(&self.checked, only_axis, self.speed) {
            Ok(running) => running,
            Err(error) => {
                if let Some(before) = before {
                    self.checked.settings = before;
                }
                return Err(text(&error));
            }
        };
        self.running = running;
        self.only_axis = only_axis;
        self.restarts = self.restarts.wrapping_add(1);
        // A restart discards a program that was loaded after the previous start.
        self.make_files();
        self.set_sampling(self.sampling);
        Ok(())
    }

    fn host_loss(&self) -> HostLossSettings {
        self.checked.settings.host_loss
    }

    /// Returns inputs that permit a simulated machine to run.
    fn inputs(&self) -> Inputs {
        Inputs {
            enable: true,
            ..Inputs::default()
        }
    }

    fn hold_output(&mut self, output: Option<(Output, bool)>) -> Result<(), Text> {
        match output {
            Some(_) => Err(text(&NO_WIRING)),
            None => Ok(()),
        }
    }
}
