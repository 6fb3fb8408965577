//! Corrections in a run: stretches in which the controller moves the offsets that correct phase errors.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::State;
use cophase_core::units::{PerAxis, Turns};

use super::events::{Event, EventKind};
use crate::units::degrees;

/// Turns of the master without a move, after which a correction is over. The controller corrects once a turn at most. A difference of a
/// few steps takes it up to about four turns from one move to the next.
const OVER_TURNS: Turns = Turns::lit("10");

/// Detects corrections, tick by tick.
#[derive(Clone, Debug)]
pub(super) struct Corrections {
    /// Smallest correction of an axis that is an event, degrees.
    least_deg: f64,
    tick_s: f64,
    /// Offsets in the last tick.
    offsets: PerAxis<Turns>,
    current: Option<Current>,
}

/// Correction that is not over.
#[derive(Clone, Debug)]
struct Current {
    from: PerAxis<Turns>,
    began_s: f64,
    /// End of the tick of the last move.
    moved_s: f64,
    /// Turns of the master since the last move.
    still: Turns,
}

impl Corrections {
    /// Creates the detection for a loop at power-up. Corrections of less than `least_deg` are no events.
    pub fn new(least_deg: f64, tick_s: f64) -> Self {
        Self {
            least_deg,
            tick_s,
            offsets: PerAxis::default(),
            current: None,
        }
    }

    /// Takes in a tick that began at `t_s`. Returns a correction that is over. Levelling in homing is none.
    #[inline]
    pub fn tick(&mut self, telemetry: &Telemetry, t_s: f64) -> Option<Event> {
        let has_moved = telemetry.correction != self.offsets;
        if !has_moved && self.current.is_none() {
            return None;
        }
        self.follow(telemetry, t_s, has_moved)
    }

    #[inline(never)]
    fn follow(&mut self, telemetry: &Telemetry, t_s: f64, has_moved: bool) -> Option<Event> {
        let before = std::mem::replace(&mut self.offsets, telemetry.correction);
        if telemetry.state != State::Run {
            return self.end(&before);
        }
        if has_moved {
            let current = self.current.get_or_insert(Current {
                from: before,
                began_s: t_s,
                moved_s: t_s,
                still: Turns::ZERO,
            });
            current.moved_s = t_s + self.tick_s;
            current.still = Turns::ZERO;
            return None;
        }
        let current = self.current.as_mut()?;
        current.still += telemetry.motion.speed.abs();
        (current.still > OVER_TURNS).then(|| self.end(&before))?
    }

    /// Ends the current correction, which took the offsets to `to`.
    fn end(&mut self, to: &PerAxis<Turns>) -> Option<Event> {
        let current = self.current.take()?;
        let by_deg = std::array::from_fn(|i| degrees(to[i] - current.from[i]));
        let what = EventKind::Corrected {
            by_deg,
            in_s: current.moved_s - current.began_s,
        };
        let is_event = by_deg.iter().any(|deg| deg.abs() >= self.least_deg);
        is_event.then_some(Event {
            t_s: current.began_s,
            what,
        })
    }
}
