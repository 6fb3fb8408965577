//! Corrections in a run: stretches in which the controller moves the offsets that correct phase errors.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::State;
use cophase_core::units::{PerAxis, Turns};
use cophase_scene::units::degrees;

use super::events::{Event, EventKind};

/// Turns of the master without a move, after which a correction is over. The controller corrects once a turn at most. A difference of a
/// few steps takes it up to about four turns from one move to the next.
const OVER_TURNS: Turns = Turns::lit("10");

/// Detects corrections, tick by tick.
#[derive(Clone, Debug)]
pub(super) struct Corrections {
    /// Correction of an axis beyond which it is an event, degrees.
    beyond_deg: f64,
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
    /// Creates the detection for a loop at power-up. Corrections of at most `beyond_deg` are no events.
    pub fn new(beyond_deg: f64, tick_s: f64) -> Self {
        Self {
            beyond_deg,
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

    /// Takes in the end of the run. Returns the correction in progress.
    pub fn finish(&mut self) -> Option<Event> {
        let offsets = self.offsets;
        self.end(&offsets)
    }

    /// Ends the current correction, which took the offsets to `to`.
    fn end(&mut self, to: &PerAxis<Turns>) -> Option<Event> {
        let current = self.current.take()?;
        let by_deg = std::array::from_fn(|i| degrees(to[i] - current.from[i]));
        let what = EventKind::Corrected {
            by_deg,
            in_s: current.moved_s - current.began_s,
        };
        let is_event = by_deg.iter().any(|deg| deg.abs() > self.beyond_deg);
        is_event.then_some(Event {
            t_s: current.began_s,
            what,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checked::Checked;
    use crate::sim::{Moment, Observer, simulate, simulate_first};
    use cophase_scene::library;

    const ANGLE: Turns = Turns::lit("0.001");

    struct Last(Option<Telemetry>);

    impl Observer for Last {
        fn tick(&mut self, moment: &Moment<'_>) {
            self.0 = Some(moment.telemetry.clone());
        }
    }

    /// Returns the event of a run that ends as a correction has moved axis 0 by `offset`.
    fn ended_after(offset: Turns, beyond: Turns) -> Option<Event> {
        let checked = Checked::new(library::find("default").unwrap().scene()).unwrap();
        let mut last = Last(None);
        simulate_first(10, &checked, &mut last, |_, _| {}).unwrap();
        let mut telemetry = last.0.unwrap();
        telemetry.state = State::Run;
        telemetry.correction[0] = offset;
        let mut corrections = Corrections::new(degrees(beyond), 0.001);
        assert_eq!(corrections.tick(&telemetry, 3.0), None);
        corrections.finish()
    }

    /// Times and durations of the corrections among some events, s.
    fn corrections(events: &[Event]) -> Vec<(f64, f64)> {
        let times = |event: &Event| match event.what {
            EventKind::Corrected { in_s, .. } => Some((event.t_s, in_s)),
            _ => None,
        };
        events.iter().filter_map(times).collect()
    }

    /// If this fails, a run that ends in state run has no line for its last correction.
    #[test]
    fn the_end_of_a_run_ends_a_correction() {
        let checked = Checked::new(library::find("coupling-slip").unwrap().scene()).unwrap();
        let whole = simulate(&checked, &mut (), |_, _| {}).unwrap();
        let (t_s, in_s) = corrections(&whole.record.events)[0];
        let ticks = (t_s + in_s) * f64::from(checked.scene.control.tick_hz);
        let cut = simulate_first(ticks as u64, &checked, &mut (), |_, _| {}).unwrap();
        assert_eq!(cut.state, State::Run);
        let [(cut_s, _)] = corrections(&cut.record.events)[..] else {
            panic!("no correction, or more than one");
        };
        assert_eq!(cut_s, t_s);
    }

    /// If this fails, the manual states another limit.
    #[test]
    fn a_correction_that_equals_the_limit_is_no_event() {
        assert_eq!(ended_after(ANGLE, ANGLE), None);
        assert!(ended_after(ANGLE + Turns::DELTA, ANGLE).is_some());
    }
}
