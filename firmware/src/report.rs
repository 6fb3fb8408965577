//! What happened, told over the debug probe: `probe-rs run`, and any other reader of defmt's log.
//!
//! The loop only notes what changed, in a queue; the words are made in what time it leaves, a few milliseconds
//! later. More than the queue holds is lost, and it is told how much.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Fault, FaultKind, State};
use cophase_core::units::{PerAxis, Turns};
use embassy_time::{Duration, Timer};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

/// Notes that wait to be told.
const WAITING: usize = 32;

/// From one look at the queue to the next.
const LOOK: Duration = Duration::from_millis(5);

/// The two ends of the queue: the loop's, and the log's. To be called once.
pub fn queue() -> (Producer<'static, Note>, Consumer<'static, Note>) {
    static NOTES: ConstStaticCell<Queue<Note, WAITING>> = ConstStaticCell::new(Queue::new());
    NOTES.take().split()
}

/// Something worth telling, and when.
pub struct Note {
    /// Control ticks since power-up.
    tick: u32,
    what: What,
}

#[repr(u32)] // a tag of a byte would have the rest copied byte by byte: 1,300 cycles a note
enum What {
    /// What the machine does from now on, and how far its cranks were off when that began.
    State {
        state: State,
        drift: PerAxis<Turns>,
        axes: usize,
    },
    /// What was seen: a fault that latched, or something that is told, whatever is done about it.
    Incident {
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
    /// Of a loop that is idle and has missed nothing.
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

    /// Takes in what a tick came to.
    pub fn observe(&mut self, tick: u32, telemetry: &Telemetry) {
        // What latched before the first tick was no incident of any.
        let is_new = telemetry.fault.is_some() && !self.faulty;
        self.faulty = telemetry.fault.is_some();
        if telemetry.incident.is_some() || is_new {
            self.tell_of(tick, telemetry.incident, telemetry.fault);
        }
        if telemetry.state != self.state {
            self.state = telemetry.state;
            let (state, drift, axes) = (self.state, telemetry.drift, self.axes);
            self.note(tick, What::State { state, drift, axes });
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

    /// An incident, or what latched without being one.
    #[inline(never)]
    fn tell_of(&mut self, tick: u32, incident: Option<Fault>, latched: Option<Fault>) {
        if let Some(fault) = incident.or(latched) {
            let latched = latched == Some(fault);
            self.note(tick, What::Incident { fault, latched });
        }
    }

    #[inline(never)] // the image's check for panics knows it by name
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

/// Tells what is noted, for ever.
#[embassy_executor::task]
pub async fn tell(mut notes: Consumer<'static, Note>) -> ! {
    loop {
        let Some(Note { tick, what }) = notes.dequeue() else {
            Timer::after(LOOK).await;
            continue;
        };
        match what {
            What::State { state, drift, axes } => {
                let drift_deg = drift.map(degrees);
                let drift_deg = drift_deg.get(..axes).unwrap_or_default();
                defmt::info!("tick {=u32}: {}, drift {} deg", tick, state, drift_deg);
            }
            What::Incident { fault, latched } => tell_fault(tick, &fault, latched),
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

/// A line of words, and the same as the bytes that go over a wire.
#[cold]
fn tell_fault(tick: u32, fault: &Fault, latched: bool) {
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
            "tick {=u32}: told: {=str}{}, {=f32} deg, at crank phase {=f32} deg {=[u8]:02x}",
            tick,
            name,
            axis,
            size_deg,
            phase_deg,
            bytes
        );
    }
}

/// The axis that shows a fault, if one does.
struct OnAxis(Option<usize>);

impl defmt::Format for OnAxis {
    fn format(&self, f: defmt::Formatter<'_>) {
        if let Some(axis) = self.0 {
            defmt::write!(f, " on axis {=usize}", axis);
        }
    }
}

/// What was handed over at power-up is not run: under the name that it has among faults, and why.
#[cold]
pub fn refused(kind: FaultKind, why: impl defmt::Format) {
    defmt::error!("{=str}: {}", kind.name(), why);
}

/// For the eye: floats are for what is told, and never for what is done.
fn degrees(turns: Turns) -> f32 {
    turns.to_num::<f32>() * 360.0
}
