//! The controller as the link's server needs it.
#![expect(
    clippy::result_large_err,
    reason = "a refusal holds its text, as there is no heap"
)]

use core::sync::atomic::{AtomicU16, Ordering};

use cophase_core::mechanism::AnyMechanism;
use cophase_core::program::ProgramBuilder;
use cophase_core::settings::{HostLossSettings, NAME_BYTES, Settings};
use cophase_core::supervisor::Command;
use cophase_link::board::{Board as _, Rp2040};
use cophase_link::message::{Event, File, Identity, Inputs, Name, Output, Text, VERSION, text};
use cophase_link::program::{MAX_PROGRAM_BYTES, ProgramFileError, encode, fill};
use cophase_link::sample::Sample;
use cophase_link::server::{Device, SettingsRefusal};
use cophase_link::{Header, checksum};
use embassy_rp::Peri;
use embassy_rp::peripherals::FLASH;
use embassy_time::{Duration, Instant};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::{ConstStaticCell, StaticCell};

use crate::board::{handover, lines, sampler, watchdog};
use crate::report::{self, Note};
use crate::settings;

/// Commands that wait for the loop.
const COMMANDS: usize = 8;

/// Commands that may wait besides stops.
const COMMANDS_BESIDE_STOPS: usize = 4;

/// Samples that wait for the link, one less than this: 7 ms at 2 kHz. USB that is saturated both ways loses none (`tests/emulator/run link`).
const SAMPLES: usize = 16;

/// Time that a reply gets to leave before a restart.
const REPLY_TIME: Duration = Duration::from_millis(100);

/// Longest time in which the loop answers: a tick at 0.5 kHz, and as much again.
const ANSWER_TIME: Duration = Duration::from_millis(5);

/// Ticks between two samples; 0: none are made.
static EVERY: AtomicU16 = AtomicU16::new(0);

/// The loop's end of the queues.
pub struct LoopEnd {
    commands: Consumer<'static, Command>,
    /// Ticks between two samples, as last read, and the tick of the next.
    every: u16,
    next: u32,
}

impl LoopEnd {
    /// Next command, which waits until it is taken.
    pub fn waiting(&self) -> Option<Command> {
        self.commands.peek().copied()
    }

    /// Takes the next command.
    pub fn take(&mut self) -> Option<Command> {
        self.commands.dequeue()
    }

    /// True if a sample of a tick is due.
    pub fn is_sample_due(&mut self, tick: u32) -> bool {
        let every = EVERY.load(Ordering::Relaxed);
        if every != self.every {
            self.synchronise(every, tick);
        }
        let is_due = tick == self.next && every > 0;
        if is_due {
            self.next = tick.wrapping_add(every.into());
        }
        is_due
    }

    /// Samples are at multiples of their distance, so that sessions can select among them.
    #[inline(never)]
    fn synchronise(&mut self, every: u16, tick: u32) {
        self.every = every;
        let since = tick.checked_rem(every.into()).unwrap_or(0);
        self.next = tick.wrapping_sub(since).wrapping_add(every.into());
    }
}

/// The link's end of the queues.
pub struct LinkEnd {
    commands: Producer<'static, Command>,
    samples: Consumer<'static, Sample>,
}

/// Returns both ends of the queues. To be called once.
#[cold]
pub fn queues() -> (LoopEnd, LinkEnd) {
    static COMMAND_QUEUE: ConstStaticCell<Queue<Command, COMMANDS>> =
        ConstStaticCell::new(Queue::new());
    static SAMPLE_QUEUE: ConstStaticCell<Queue<Sample, SAMPLES>> =
        ConstStaticCell::new(Queue::new());
    let (give_command, take_command) = COMMAND_QUEUE.take().split();
    let (give_sample, take_sample) = SAMPLE_QUEUE.take().split();
    sampler::set_up(give_sample);
    let loop_end = LoopEnd {
        commands: take_command,
        every: 0,
        next: 0,
    };
    let link_end = LinkEnd {
        commands: give_command,
        samples: take_sample,
    };
    (loop_end, link_end)
}

/// Settings that run, as far as the link needs them.
pub struct Running {
    /// Serial number of the board.
    pub serial: u64,
    name: heapless::String<NAME_BYTES>,
    axes: usize,
    /// Axes that have lines, used or not.
    lines: usize,
    only_axis: Option<u8>,
    host_loss: HostLossSettings,
    tick_hz: u32,
    speed_hz: f64,
    mechanism: AnyMechanism,
    can_run: bool,
    /// Settings file, in the flash.
    file: &'static [u8],
    /// A host has stored other settings since the start.
    has_stored: bool,
    program: heapless::Vec<u8, MAX_PROGRAM_BYTES>,
}

impl Running {
    /// Creates it for settings that could not be read: the link then serves to store others.
    pub const fn nothing() -> Self {
        Self {
            serial: 0,
            name: heapless::String::new(),
            axes: 0,
            lines: 0,
            only_axis: None,
            host_loss: HostLossSettings::NONE,
            tick_hz: 1000,
            speed_hz: 0.0,
            mechanism: AnyMechanism::STANDSTILL,
            can_run: false,
            file: &[],
            has_stored: false,
            program: heapless::Vec::new(),
        }
    }

    /// Takes over settings, before they are configured. Of several axes it keeps `only_axis`, if there is one.
    #[cold]
    pub fn take_over(
        &mut self,
        settings: &mut Settings,
        only_axis: Option<usize>,
        file: &'static [u8],
    ) {
        self.file = file;
        self.lines = settings.axes.len();
        self.host_loss = settings.host_loss;
        if let Some(axis) = only_axis
            && settings.keep_axis(axis)
        {
            settings.ignore_index();
            self.only_axis = Some(axis as u8);
        }
        self.name.clone_from(&settings.name);
        self.axes = settings.axes.len();
        self.tick_hz = settings.tick_hz;
        self.speed_hz = settings.limits.speed_hz;
        self.program.resize(MAX_PROGRAM_BYTES, 0).ok();
        let length = encode(settings, &mut self.program).map_or(0, <[u8]>::len);
        self.program.truncate(length);
    }

    /// The settings are those of a running loop, with this mechanism.
    #[cold]
    pub fn runs(&mut self, mechanism: AnyMechanism) {
        self.mechanism = mechanism;
        self.can_run = true;
    }
}

/// The controller behind the link.
pub struct FirmwareDevice {
    link: LinkEnd,
    notes: Consumer<'static, Note>,
    running: &'static mut Running,
    flash: Peri<'static, FLASH>,
    restart_at: Option<(Instant, Option<u8>)>,
}

impl FirmwareDevice {
    /// Controller behind the link's end of the queues.
    pub const fn new(
        link: LinkEnd,
        notes: Consumer<'static, Note>,
        running: &'static mut Running,
        flash: Peri<'static, FLASH>,
    ) -> Self {
        Self {
            link,
            notes,
            running,
            flash,
            restart_at: None,
        }
    }

    /// Serial number of the board.
    pub const fn serial(&self) -> u64 {
        self.running.serial
    }

    /// Number of axes of the settings, each of which has its lines.
    pub const fn axes_with_lines(&self) -> usize {
        self.running.lines
    }

    /// Checks that the settings have an axis.
    #[cold]
    fn check_axis(&self, axis: u8) -> Result<(), Text> {
        let axes = self.running.lines;
        if usize::from(axis) < axes {
            return Ok(());
        }
        Err(text(&format_args!(
            "there is no axis {axis}; the settings have {axes}, counted from 0"
        )))
    }

    /// Restarts the controller when a request for it is old enough.
    #[cold]
    pub fn restart_if_due(&mut self) {
        if let Some((at, only_axis)) = self.restart_at
            && Instant::now() >= at
        {
            watchdog::restart(only_axis);
        }
    }
}

impl Device for FirmwareDevice {
    #[cold]
    fn identity(&self) -> Identity {
        let name = |text: &str| Name::try_from(text).unwrap_or_default();
        let header = Header::read(self.running.file).ok();
        Identity {
            version: VERSION,
            board: name(Rp2040::NAME),
            serial: self.running.serial,
            firmware: name(env!("CARGO_PKG_VERSION")),
            settings: name(&self.running.name),
            settings_crc: header.map_or(0, |header| header.payload_crc),
            program_crc: checksum(&self.running.program),
            axes: self.running.axes as u8,
            tick_hz: self.running.tick_hz,
            can_run: self.running.can_run,
            only_axis: self.running.only_axis,
            restarts: watchdog::restarts(),
        }
    }

    fn axes(&self) -> usize {
        self.running.axes
    }

    fn tick_hz(&self) -> u32 {
        self.running.tick_hz
    }

    fn now_ms(&self) -> u32 {
        Instant::now().as_millis() as u32
    }

    fn file(&self, file: File) -> &[u8] {
        match file {
            File::Settings => self.running.file,
            File::Program => &self.running.program,
        }
    }

    fn command(&mut self, command: Command) -> bool {
        let commands = &mut self.link.commands;
        let is_stop = matches!(command, Command::Stop | Command::StopNow);
        // A host that sends more than the loop takes must not keep another one from stopping the machine.
        let has_room = is_stop || commands.len() < COMMANDS_BESIDE_STOPS;
        self.running.can_run && has_room && commands.enqueue(command).is_ok()
    }

    fn set_sampling(&mut self, every: u16) {
        EVERY.store(every, Ordering::Relaxed);
    }

    fn next_sample(&mut self) -> Option<Sample> {
        self.link.samples.dequeue()
    }

    fn next_event(&mut self) -> Option<(u32, Event)> {
        let note = self.notes.dequeue()?;
        report::log(&note);
        Some(note.event())
    }

    #[cold]
    fn load_program(&mut self, bytes: &[u8]) -> Result<(), Text> {
        if !self.running.can_run {
            return Err(text(&"the settings cannot run"));
        }
        if self.running.only_axis.is_some() {
            return Err(text(
                &"bring-up has one axis only; restart the controller first",
            ));
        }
        let Running {
            tick_hz,
            mechanism,
            speed_hz,
            ..
        } = *self.running;
        handover::submit(|program| {
            fill(
                bytes,
                ProgramBuilder::new(tick_hz, mechanism, speed_hz, program),
            )
        })
        .map_err(|error: ProgramFileError| text(&error))?;
        let end = Instant::now() + ANSWER_TIME;
        while handover::is_waiting() && Instant::now() < end {}
        if !handover::withdraw() {
            return Err(text(&"the machine has begun to move"));
        }
        self.running.program.clear();
        // It is no longer than the buffer. Otherwise it would have more entries than a program.
        let _ = self.running.program.extend_from_slice(bytes);
        Ok(())
    }

    #[cold]
    fn store_settings(&mut self, settings_file: &[u8]) -> Result<(), SettingsRefusal> {
        settings::check(settings_file).map_err(SettingsRefusal::Rejected)?;
        if self.running.has_stored {
            // A second file would overwrite the one that runs.
            let why = "settings were stored already; restart the controller first";
            return Err(SettingsRefusal::NotStored(text(&why)));
        }
        settings::store_from_host(self.flash.reborrow(), settings_file)
            .map_err(SettingsRefusal::NotStored)?;
        self.running.has_stored = true;
        Ok(())
    }

    fn restart(&mut self, only_axis: Option<u8>) -> Result<(), Text> {
        if let Some(axis) = only_axis {
            self.check_axis(axis)?;
        }
        self.restart_at = Some((Instant::now() + REPLY_TIME, only_axis));
        Ok(())
    }

    fn host_loss(&self) -> HostLossSettings {
        self.running.host_loss
    }

    #[cold]
    fn inputs(&self) -> Inputs {
        lines::inputs(self.running.lines)
    }

    #[cold]
    fn hold_output(&mut self, output: Option<(Output, bool)>) -> Result<(), Text> {
        if let Some((Output::Step(axis) | Output::Dir(axis), _)) = output {
            self.check_axis(axis)?;
        }
        lines::hold(output);
        Ok(())
    }
}

/// Returns the place for the link's data about the settings. To be called once.
#[cold]
pub fn running() -> &'static mut Running {
    static RUNNING: StaticCell<Running> = StaticCell::new();
    RUNNING.init_with(Running::nothing)
}
