//! What happened, told over the debug probe: `probe-rs run`, and any other reader of defmt's log.
//!
//! The loop only notes what changed, in a queue; the words are made in what time it leaves, a few milliseconds
//! later. More than the queue holds is lost, and it is told how much.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Fault, State};
use cophase_core::units::Turns;
use embassy_time::{Duration, Timer};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

use crate::board::pins::AXES;

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
        drift: [Turns; AXES],
        axes: usize,
    },
    Fault(Fault),
    Missed(u32),
    Late(u32),
    Lost(u32),
}

/// Compares each tick with the one before, and notes what changed.
pub struct Reporter {
    notes: Producer<'static, Note>,
    state: State,
    faulty: bool,
    missed: u32,
    late: u32,
    lost: u32,
}

impl Reporter {
    /// Of a loop that is idle and has missed nothing.
    pub const fn new(notes: Producer<'static, Note>) -> Self {
        Self {
            notes,
            state: State::Idle,
            faulty: false,
            missed: 0,
            late: 0,
            lost: 0,
        }
    }

    /// Takes in what a tick came to.
    pub fn observe<const N: usize>(&mut self, tick: u32, telemetry: &Telemetry<N>) {
        if telemetry.fault.is_some() != self.faulty {
            self.faulty = telemetry.fault.is_some();
            if let Some(fault) = telemetry.fault {
                self.note(tick, What::Fault(fault));
            }
        }
        if telemetry.state != self.state {
            self.state = telemetry.state;
            let mut drift = [Turns::ZERO; AXES];
            for (slot, &axis) in drift.iter_mut().zip(&telemetry.drift) {
                *slot = axis;
            }
            let state = self.state;
            self.note(
                tick,
                What::State {
                    state,
                    drift,
                    axes: N,
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

    #[cold]
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
            What::Fault(fault) => tell_fault(tick, &fault),
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

fn tell_fault(tick: u32, fault: &Fault) {
    let size_deg = degrees(fault.size);
    let phase_deg = degrees(fault.phase.within_turn());
    match fault.axis {
        Some(axis) => defmt::error!(
            "tick {=u32}: fault: {} on axis {=usize}, {=f32} deg, at crank phase {=f32} deg",
            tick,
            fault.kind,
            axis,
            size_deg,
            phase_deg
        ),
        None => defmt::error!(
            "tick {=u32}: fault: {}, {=f32} deg, at crank phase {=f32} deg",
            tick,
            fault.kind,
            size_deg,
            phase_deg
        ),
    }
}

/// For the eye: floats are for what is told, and never for what is done.
fn degrees(turns: Turns) -> f32 {
    turns.to_num::<f32>() * 360.0
}
