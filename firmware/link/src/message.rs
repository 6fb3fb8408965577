//! Messages of the link: requests of the host, replies and streams of the controller.
//!
//! Payloads are in [postcard](https://postcard.jamesmunns.com/)'s format. A request is answered by exactly one reply,
//! which repeats the number of the request's frame. New variants go to the end of an enum, so that the number of an old
//! one never changes. A change that an older program could misread gets a new [`VERSION`].

use core::fmt::Write;

pub use cophase_core::program::MAX_OVERRIDE_PERMILLE;
use cophase_core::supervisor::{
    FAULT_BYTES, Fault, REFUSED_COMMAND_BYTES, RefusalReason, RefusedCommand, State,
};
use serde::{Deserialize, Serialize};

use crate::frame::FrameCounts;
use crate::sample::Channels;

/// Version of the protocol.
pub const VERSION: u16 = 2;

/// Greatest number of bytes of a file in one message.
pub const MAX_CHUNK_BYTES: usize = 384;

/// Short text: a name, or a reason.
pub type Text = heapless::String<TEXT_BYTES>;

/// Name.
pub type Name = heapless::String<40>;

/// Greatest length of a [`Text`], bytes.
pub const TEXT_BYTES: usize = 160;

/// Text of an error, cut to the length that a reply holds.
pub fn text(error: &impl core::fmt::Display) -> Text {
    struct Cut(Text);
    impl Write for Cut {
        fn write_str(&mut self, part: &str) -> core::fmt::Result {
            for c in part.chars() {
                if self.0.push(c).is_err() {
                    return Err(core::fmt::Error);
                }
            }
            Ok(())
        }
    }
    let mut cut = Cut(Text::new());
    // A text that is too long is cut where the room ends.
    let _ = write!(cut, "{error}");
    cut.0
}

/// Request of a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request<'a> {
    /// Protocol version, board, firmware and settings: [`ReplyBody::Identity`]. A host sends it first.
    Identify {
        /// Protocol version of the host.
        version: u16,
    },
    /// A part of a file: [`ReplyBody::Chunk`].
    Read {
        /// File to read.
        file: File,
        /// Offset of the part, bytes.
        offset: u32,
    },
    /// Begins to write a file. Needs control.
    BeginWrite {
        /// File to write.
        file: File,
        /// Length of the whole file, bytes.
        length: u32,
        /// CRC-32 of the whole file.
        crc: u32,
    },
    /// Next part of the file that is being written.
    Write {
        /// Offset of the part: the number of bytes so far.
        offset: u32,
        /// The part.
        #[serde(borrow)]
        bytes: &'a [u8],
    },
    /// Checks the file that was written. A program takes effect at once, and settings are stored for the next restart.
    FinishWrite,
    /// Restarts the controller, which then runs the stored settings. Needs control, and the drives off.
    Restart,
    /// Takes control, or gives it back.
    Control(ControlRequest),
    /// Allows one start, home or jog within [`ARMED_S`](crate::server::ARMED_S). Needs control and the enable input.
    Arm,
    /// Takes the permission back.
    Disarm,
    /// Runs the program. Needs the arm.
    Start,
    /// Stops all axes together. Needs nothing.
    Stop(StopKind),
    /// Stops the program's time. Needs control.
    Hold,
    /// Resumes the program's time. Needs control.
    Resume,
    /// Leaves the fault state. Needs control.
    Reset,
    /// Scales the program's amplitude. Needs control.
    Override {
        /// Thousandths of the program's amplitude, 0 to [`MAX_OVERRIDE_PERMILLE`].
        permille: u16,
    },
    /// Homes the machine and parks it. Needs the arm.
    Home,
    /// Turns a parked machine at homing speed while the request is repeated. The first request needs the arm.
    Jog,
    /// Counters of the link and of the loop: [`ReplyBody::Counters`].
    Counters,
    /// Events from a number on: [`ReplyBody::Events`].
    Events {
        /// Number of the first event.
        from: u32,
    },
    /// Begins, changes or ends the stream of samples to this host.
    Stream {
        /// Channels to send; none ends the stream.
        channels: Channels,
        /// A sample every so many ticks, 1 to 10,000.
        every: u16,
    },
    /// Begins, changes or ends the stream of statuses to this host.
    StreamStatus {
        /// Time between two of them, ms, 10 to 1000; 0 ends the stream.
        period_ms: u16,
    },
    /// Resets the largest phase errors. Needs control.
    ResetPeak,
    /// Inputs as the controller reads them: [`ReplyBody::Inputs`].
    Inputs,
    /// Allows bring-up for [`UNLOCKED_S`](crate::server::UNLOCKED_S). Needs control, and the drives off.
    Unlock,
    /// Holds an output for [`OUTPUT_MS`](crate::server::OUTPUT_MS). A repeated request holds it for that time again. Needs the unlock, and
    /// the drives off.
    Output {
        /// Output to hold; another one that is held is released.
        output: Output,
        /// True to hold it at its active level.
        is_active: bool,
    },
    /// Restarts the controller as one of a single axis, on the lines of this axis of the settings. The next restart has all
    /// axes again. Needs the unlock, and the drives off.
    OnlyAxis(u8),
}

/// Output of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Output {
    /// STEP of an axis.
    Step(u8),
    /// DIR of an axis. It is active as for a motion forward.
    Dir(u8),
    /// DRIVE ENABLE. The enable input keeps its effect on it.
    DriveEnable,
    /// SYNC.
    Sync,
}

/// Inputs of the controller: true, or a set bit, if an input is active as the settings define it. Axes are bits, axis 0
/// is the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inputs {
    /// Index sensors.
    pub index: u8,
    /// Alarms.
    pub alarm: u8,
    /// The drives may be on.
    pub enable: bool,
    /// The machine must stop.
    pub stop: bool,
    /// The start button is pressed.
    pub start: bool,
}

/// File of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum File {
    /// Settings file, header included.
    Settings,
    /// Program: the entries of `program` of the settings, in postcard's format.
    Program,
}

/// Request about control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ControlRequest {
    /// Takes control if no other host has it.
    Take,
    /// Takes control from any host that has it.
    TakeOver,
    /// Gives control back.
    Release,
}

/// Kind of stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StopKind {
    /// At the parking phase.
    AtPhase,
    /// As fast as the limits allow.
    Now,
}

/// Message of the controller.
#[allow(
    clippy::large_enum_variant,
    reason = "there is no heap, and one message at a time"
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Message<'a> {
    /// Answer to a request.
    Reply {
        /// Number of the request's frame.
        to: u16,
        /// The answer.
        #[serde(borrow)]
        body: Result<ReplyBody<'a>, Refusal>,
    },
    /// Status, repeated.
    Status(Status),
    /// Consecutive samples.
    Samples {
        /// Tick of the first sample.
        tick: u32,
        /// Ticks between two samples.
        every: u16,
        /// Channels of the packet.
        channels: Channels,
        /// Samples in the packet.
        count: u8,
        /// The samples, as [`crate::sample::pack`] makes them.
        #[serde(borrow)]
        packet: &'a [u8],
    },
    /// An event, as it happens.
    Event(EventRecord),
}

/// Content of a reply.
#[allow(
    clippy::large_enum_variant,
    reason = "there is no heap, and one reply at a time"
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ReplyBody<'a> {
    /// The request was accepted.
    Done,
    /// Reply to [`Request::Identify`].
    Identity(Identity),
    /// Reply to [`Request::Read`].
    Chunk {
        /// Length of the whole file, bytes.
        length: u32,
        /// The part; empty at the end.
        #[serde(borrow)]
        bytes: &'a [u8],
    },
    /// Reply to [`Request::Counters`].
    Counters(Counters),
    /// Reply to [`Request::Events`].
    Events(heapless::Vec<EventRecord, EVENTS_IN_REPLY>),
    /// Reply to [`Request::Inputs`].
    Inputs(Inputs),
}

/// Greatest number of events in a reply.
pub const EVENTS_IN_REPLY: usize = 8;

/// Reason why a request was refused. Nothing has changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[allow(missing_docs, reason = "each variant's message says what it means")]
pub enum Refusal {
    #[error(
        "the bytes are no request of this protocol version; use the `cophase` of the firmware's version"
    )]
    Unreadable,
    #[error(
        "the controller has protocol version {controller}; use the `cophase` of the firmware's version"
    )]
    Version { controller: u16 },
    #[error("another host has control; give --take-over to take it")]
    ControlTaken,
    #[error("this host does not have control; take control first")]
    NoControl,
    #[error("the machine is not armed; arm it first")]
    NotArmed,
    #[error("the enable input is open; close it first")]
    EnableOpen,
    #[error("the stop input is active; release it first")]
    StopActive,
    #[error("not possible in state {}", state_name(*state))]
    State { state: u8 },
    #[error("the value is outside {min} to {max}")]
    OutOfRange { min: u32, max: u32 },
    #[error("the parts of a file must follow each other; the next one begins at {expected}")]
    Offset { expected: u32 },
    #[error("no file is being written; begin with its length")]
    NotWriting,
    #[error("a file of {length} bytes does not fit; the longest has {max}")]
    TooLong { length: u32, max: u32 },
    #[error("the file was damaged on the way: its CRC-32 is {found:#010x}")]
    FileCrc { found: u32 },
    #[error("the controller rejected it: {0}")]
    Rejected(Text),
    #[error("not stored: {0}")]
    NotStored(Text),
    #[error("the controller is busy with an earlier request; try again")]
    Busy,
    #[error("bring-up is locked; unlock it first")]
    Locked,
    #[error("{}", RefusalReason::NotHomed.text())]
    NotHomed,
    #[error("{}", RefusalReason::ProgramRuns.text())]
    ProgramRuns,
    #[error("{}", RefusalReason::Jogs.text())]
    Jogs,
}

/// Name of the state of a number.
pub fn state_name(state: u8) -> &'static str {
    State::ALL
        .get(usize::from(state))
        .map_or("unknown", |state| state.name())
}

/// Identity of a controller.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Protocol version.
    pub version: u16,
    /// Kind of board, or that it is simulated.
    pub board: Name,
    /// Number that distinguishes boards of a kind.
    pub serial: u64,
    /// Version of the firmware.
    pub firmware: Name,
    /// Name of the settings.
    pub settings: Name,
    /// CRC-32 of the settings' payload.
    pub settings_crc: u32,
    /// CRC-32 of the program.
    pub program_crc: u32,
    /// Number of axes.
    pub axes: u8,
    /// Control ticks a second.
    pub tick_hz: u32,
    /// False if the settings were refused, so that nothing can move.
    pub can_run: bool,
    /// Axis of the settings that is the only one until the next restart, for bring-up.
    pub only_axis: Option<u8>,
    /// Restarts since power-up, wrapping: shows a host that a restart is over.
    pub restarts: u32,
}

/// Holder of control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Control {
    /// Nobody.
    Free,
    /// The host that reads this.
    You,
    /// Another host.
    Other,
}

/// Status of the machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Control ticks since power-up.
    pub tick: u32,
    /// Number of the state.
    pub state: u8,
    /// [Flags](crate::sample::flags).
    pub flags: u8,
    /// Override of the amplitude, in thousandths.
    pub override_permille: u16,
    /// Holder of control.
    pub control: Control,
    /// True if a start is allowed.
    pub armed: bool,
    /// Requested amplitude, m/s².
    pub amax_mps2: f32,
    /// Speed of the master, turns/s.
    pub speed_hz: f32,
    /// Ticks of the program that are over.
    pub program_ticks: u32,
    /// Phase error of each axis, degrees of crank angle.
    pub phase_error_deg: heapless::Vec<f32, { cophase_core::units::MAX_AXES }>,
    /// Tilt along x and y, in degrees of crank angle.
    pub tilt_deg: [f32; 2],
    /// Fault that latched.
    pub fault: Option<FaultRecord>,
    /// Events so far.
    pub events: u32,
    /// Samples of this host's stream that were lost so far.
    pub samples_lost: u32,
}

/// Fault in its wire format ([`Fault::to_bytes`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultRecord(pub [u8; FAULT_BYTES]);

impl FaultRecord {
    /// The fault; none if its kind is unknown here.
    pub fn fault(&self) -> Option<Fault> {
        Fault::from_bytes(&self.0)
    }
}

impl From<&Fault> for FaultRecord {
    fn from(fault: &Fault) -> Self {
        Self(fault.to_bytes())
    }
}

/// Refused command in its wire format ([`RefusedCommand::to_bytes`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RefusedRecord(pub [u8; REFUSED_COMMAND_BYTES]);

impl RefusedRecord {
    /// The refused command; none if a part of it is unknown here.
    pub fn command(&self) -> Option<RefusedCommand> {
        RefusedCommand::from_bytes(&self.0)
    }
}

impl From<&RefusedCommand> for RefusedRecord {
    fn from(refused: &RefusedCommand) -> Self {
        Self(refused.to_bytes())
    }
}

/// Event of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventRecord {
    /// Number of the event, from 0 at power-up.
    pub number: u32,
    /// Control ticks since power-up.
    pub tick: u32,
    /// The event.
    pub event: Event,
}

/// Event of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Event {
    /// The machine changed to the state of this number.
    State(u8),
    /// A fault latched.
    Fault(FaultRecord),
    /// Something was detected that is no fault, or a latched fault has a better name.
    Reported(FaultRecord),
    /// Deadlines were missed; their number so far.
    Missed(u32),
    /// Deadlines were met late; their number so far.
    Late(u32),
    /// Events were lost before this one.
    Lost(u32),
    /// A command was not possible, and had no effect.
    Refused(RefusedRecord),
}

/// Counters of the link and the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Frames from this host.
    pub received: FrameCounts,
    /// Requests that were refused.
    pub refused: u32,
    /// Messages that were not sent, as the line was too slow.
    pub not_sent: u32,
    /// Samples lost in this host's stream.
    pub samples_lost: u32,
    /// Deadlines that the loop missed.
    pub missed_deadlines: u32,
    /// Deadlines that the loop met late by over half a tick.
    pub late_deadlines: u32,
}
