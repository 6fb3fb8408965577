//! Event log over the debug probe: `probe-rs run`, or any other reader of defmt's log.
//!
//! The loop only puts changes in a queue. The text is made in the time that the loop leaves, a few milliseconds later.
//! Notes that do not fit in the queue are lost, and their number is logged.

use cophase_core::signals::Output;
use cophase_core::supervisor::{Fault, FaultKind, RefusedCommand, State};
use cophase_core::units::{PerAxis, Turns};
use cophase_link::message::Event;
use cophase_link::watch::{Change, Watch};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

/// Capacity of the queue, in notes.
const WAITING: usize = 32;

/// Returns the two ends of the queue: the loop's, and the log's. To be called once.
pub fn queue() -> (Producer<'static, Note>, Consumer<'static, Note>) {
    static NOTES: ConstStaticCell<Queue<Note, WAITING>> = ConstStaticCell::new(Queue::new());
    NOTES.take().split()
}

/// A change to log, and its time.
#[derive(Clone, Copy)]
pub struct Note {
    /// Control ticks since power-up.
    tick: u32,
    kind: NoteKind,
}

#[derive(Clone, Copy)]
#[repr(u32)] // With a tag of a byte the rest is copied byte by byte: 1,300 cycles a note.
enum NoteKind {
    /// New state of the machine, and the phase errors at its start.
    State {
        state: State,
        has_drives_on: bool,
        phase_error: PerAxis<Turns>,
        axes: usize,
    },
    /// An event: a fault that latched, or one that is only reported.
    Event {
        fault: Fault,
        latched: bool,
    },
    Refused(RefusedCommand),
    Missed(u32),
    Late(u32),
    Lost(u32),
}

impl Note {
    /// Tick and event, for hosts.
    #[cold]
    pub fn event(&self) -> (u32, Event) {
        let event = match self.kind {
            NoteKind::State { state, .. } => Event::State(state as u8),
            NoteKind::Event { fault, latched } => (&Change::Event { fault, latched }).into(),
            NoteKind::Refused(refused) => (&Change::Refused(refused)).into(),
            NoteKind::Missed(all) => Event::Missed(all),
            NoteKind::Late(all) => Event::Late(all),
            NoteKind::Lost(notes) => Event::Lost(notes),
        };
        (self.tick, event)
    }
}

/// Notes the changes from tick to tick.
pub struct Reporter {
    axes: usize,
    watch: Watch,
    queue: NoteQueue,
}

impl Reporter {
    /// Reporter of a loop that is idle and has missed no deadline.
    pub const fn new(notes: Producer<'static, Note>, axes: usize) -> Self {
        Self {
            axes,
            watch: Watch::new(),
            queue: NoteQueue { notes, lost: 0 },
        }
    }

    /// Compares the output of a tick with the one before.
    pub fn observe(&mut self, tick: u32, output: &Output) {
        let axes = self.axes;
        let queue = &mut self.queue;
        self.watch.observe(&output.telemetry, |change| {
            queue.note(tick, change, output, axes);
        });
    }
}

/// End of the queue that the loop writes.
struct NoteQueue {
    notes: Producer<'static, Note>,
    lost: u32,
}

impl NoteQueue {
    #[inline(never)] // The check of the linked firmware for panics finds it by name.
    fn note(&mut self, tick: u32, change: Change, output: &Output, axes: usize) {
        let kind = match change {
            Change::State(state) => NoteKind::State {
                state,
                has_drives_on: output.drives_enabled,
                phase_error: output.telemetry.phase_error,
                axes,
            },
            Change::Event { fault, latched } => NoteKind::Event { fault, latched },
            Change::Refused(refused) => NoteKind::Refused(refused),
            Change::Missed(all) => NoteKind::Missed(all),
            Change::Late(all) => NoteKind::Late(all),
        };
        self.push(tick, kind);
    }

    fn push(&mut self, tick: u32, kind: NoteKind) {
        if self.lost > 0 {
            let kind = NoteKind::Lost(self.lost);
            if self.notes.enqueue(Note { tick, kind }).is_ok() {
                self.lost = 0;
            }
        }
        if self.notes.enqueue(Note { tick, kind }).is_err() {
            self.lost = self.lost.saturating_add(1);
        }
    }
}

/// Logs a note.
#[cold]
pub fn log(note: &Note) {
    let tick = note.tick;
    match note.kind {
        NoteKind::State {
            state,
            has_drives_on,
            phase_error,
            axes,
        } => {
            let drives = if has_drives_on { "on" } else { "off" };
            let phase_error_deg = phase_error.map(degrees);
            let phase_error_deg = phase_error_deg.get(..axes).unwrap_or_default();
            defmt::info!(
                "tick {=u32}: {}, phase error {} deg, drives {=str}",
                tick,
                state,
                phase_error_deg,
                drives
            );
        }
        NoteKind::Event { fault, latched } => log_fault(tick, &fault, latched),
        NoteKind::Refused(refused) => {
            defmt::warn!(
                "tick {=u32}: refused: {=str} in state {}, {}",
                tick,
                refused.command.name(),
                refused.state,
                refused.reason
            );
        }
        NoteKind::Missed(all) => {
            defmt::warn!("tick {=u32}: {=u32} deadlines missed in all", tick, all);
        }
        NoteKind::Late(all) => {
            defmt::warn!("tick {=u32}: {=u32} deadlines met late in all", tick, all);
        }
        NoteKind::Lost(notes) => defmt::warn!("tick {=u32}: {=u32} notes lost", tick, notes),
    }
}

/// Logs a fault as text, followed by the bytes of its wire format.
#[cold]
fn log_fault(tick: u32, fault: &Fault, latched: bool) {
    let name = fault.kind.name();
    let (size_deg, phase_deg) = (degrees(fault.size), degrees(fault.phase.within_turn()));
    let bytes = &fault.to_bytes()[..];
    let axis = OnAxis(fault.axis);
    if latched {
        defmt::error!(
            "tick {=u32}: fault: {=str}{}, {=f32} deg, at crank phase {=f32} deg {=[u8]:02x}",
            tick,
            name,
            axis,
            size_deg,
            phase_deg,
            bytes
        );
    } else {
        defmt::warn!(
            "tick {=u32}: reported: {=str}{}, {=f32} deg, at crank phase {=f32} deg {=[u8]:02x}",
            tick,
            name,
            axis,
            size_deg,
            phase_deg,
            bytes
        );
    }
}

/// Formats the axis of a fault, if it has one.
struct OnAxis(Option<usize>);

impl defmt::Format for OnAxis {
    fn format(&self, f: defmt::Formatter<'_>) {
        if let Some(axis) = self.0 {
            defmt::write!(f, " on axis {=usize}", axis);
        }
    }
}

/// Logs why the settings at power-up are refused, under the name of the fault.
#[cold]
pub fn refused(kind: FaultKind, why: impl defmt::Format) {
    defmt::error!("{=str}: {}", kind.name(), why);
}

/// Converts turns to degrees, for the log only; the loop itself uses no floats.
fn degrees(turns: Turns) -> f32 {
    turns.to_num::<f32>() * 360.0
}
