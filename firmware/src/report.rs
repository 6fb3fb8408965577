//! Event log over the debug probe: `probe-rs run`, or any other reader of defmt's log.
//!
//! The loop only puts changes in a queue. The text is made in the time that the loop leaves, a few milliseconds later.
//! Notes that do not fit in the queue are lost, and their number is logged.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Fault, FaultKind, State};
use cophase_core::units::{PerAxis, Turns};
use embassy_time::{Duration, Timer};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

/// Capacity of the queue, in notes.
const WAITING: usize = 32;

/// Time between two polls of the queue.
const POLL: Duration = Duration::from_millis(5);

/// Returns the two ends of the queue: the loop's, and the log's. To be called once.
pub fn queue() -> (Producer<'static, Note>, Consumer<'static, Note>) {
    static NOTES: ConstStaticCell<Queue<Note, WAITING>> = ConstStaticCell::new(Queue::new());
    NOTES.take().split()
}

/// A change to log, and its time.
pub struct Note {
    /// Control ticks since power-up.
    tick: u32,
    what: What,
}

#[repr(u32)] // With a tag of a byte the rest would be copied byte by byte: 1,300 cycles a note.
enum What {
    /// New state of the machine, and the phase errors at its start.
    State {
        state: State,
        phase_error: PerAxis<Turns>,
        axes: usize,
    },
    /// An event: a fault that latched, or one that is only reported.
    Event {
        fault: Fault,
        latched: bool,
    },
    Missed(u32),
    Late(u32),
    Lost(u32),
}

/// Compares each tick with the one before, and notes what changed.
pub struct Reporter {
    notes: Producer<'static, Note>,
    axes: usize,
    state: State,
    faulty: bool,
    missed: u32,
    late: u32,
    lost: u32,
}

impl Reporter {
    /// Reporter of a loop that is idle and has missed no deadline.
    pub const fn new(notes: Producer<'static, Note>, axes: usize) -> Self {
        Self {
            notes,
            axes,
            state: State::Idle,
            faulty: false,
            missed: 0,
            late: 0,
            lost: 0,
        }
    }

    /// Compares the telemetry of a tick with the one before.
    pub fn observe(&mut self, tick: u32, telemetry: &Telemetry) {
        // A fault that latched before the first tick was not an event of any tick.
        let is_new = telemetry.fault.is_some() && !self.faulty;
        self.faulty = telemetry.fault.is_some();
        if telemetry.event.is_some() || is_new {
            self.note_event(tick, telemetry.event, telemetry.fault);
        }
        if telemetry.state != self.state {
            self.state = telemetry.state;
            let (state, phase_error, axes) = (self.state, telemetry.phase_error, self.axes);
            self.note(
                tick,
                What::State {
                    state,
                    phase_error,
                    axes,
                },
            );
        }
        let limits = &telemetry.limits;
        if limits.missed_deadlines != self.missed {
            self.missed = limits.missed_deadlines;
            self.note(tick, What::Missed(self.missed));
        }
        if limits.late_deadlines != self.late {
            self.late = limits.late_deadlines;
            self.note(tick, What::Late(self.late));
        }
    }

    /// Notes an event, or a fault that latched without an event.
    #[inline(never)]
    fn note_event(&mut self, tick: u32, event: Option<Fault>, latched: Option<Fault>) {
        if let Some(fault) = event.or(latched) {
            let latched = latched == Some(fault);
            self.note(tick, What::Event { fault, latched });
        }
    }

    #[inline(never)] // The check of the linked firmware for panics knows it by name.
    fn note(&mut self, tick: u32, what: What) {
        if self.lost > 0 {
            let what = What::Lost(self.lost);
            if self.notes.enqueue(Note { tick, what }).is_ok() {
                self.lost = 0;
            }
        }
        if self.notes.enqueue(Note { tick, what }).is_err() {
            self.lost = self.lost.saturating_add(1);
        }
    }
}

/// Task that logs all notes.
#[embassy_executor::task]
pub async fn publish(mut notes: Consumer<'static, Note>) -> ! {
    loop {
        let Some(Note { tick, what }) = notes.dequeue() else {
            Timer::after(POLL).await;
            continue;
        };
        match what {
            What::State {
                state,
                phase_error,
                axes,
            } => {
                let phase_error_deg = phase_error.map(degrees);
                let phase_error_deg = phase_error_deg.get(..axes).unwrap_or_default();
                defmt::info!(
                    "tick {=u32}: {}, phase error {} deg",
                    tick,
                    state,
                    phase_error_deg
                );
            }
            What::Event { fault, latched } => log_fault(tick, &fault, latched),
            What::Missed(all) => {
                defmt::warn!("tick {=u32}: {=u32} deadlines missed in all", tick, all);
            }
            What::Late(all) => {
                defmt::warn!("tick {=u32}: {=u32} deadlines met late in all", tick, all);
            }
            What::Lost(notes) => defmt::warn!("tick {=u32}: {=u32} notes lost", tick, notes),
        }
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
