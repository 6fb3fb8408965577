//! Names for the motion of one crank, by its last events.
//!
//! | last events | name |
//! | --- | --- |
//! | a jump by whole electrical cycles of a stepper, or two that add up to a few | *lost steps* |
//! | any other jump, or drift beyond a gate | *slip* |
//! | jumps ahead in turn after turn that gain, or pulses at the spacing of a crank that runs | *runaway* |
//! | pulses where no flag is | *extra index pulse* |
//!
//! No name is needed to stop the machine. Events arrive turn by turn, and a better name may replace a worse one while the machine stops. At
//! first, the only symptom may be an overdue crank or a tilted platform.

use crate::drift::axis_watch::Traits;
use crate::drift::detection::angles::{angle, of_angle};
use crate::supervisor::FaultKind;
use crate::units::{Turns, nearest};

/// Number of events that are kept. If all of them are extra pulses within as many turns, the sensor has failed.
const EVENTS: usize = 4;

/// Turns after which an event no longer explains where the crank is.
const FORGOTTEN_AFTER: u8 = 8;

/// Electrical cycles that a stepper may gain at once.
const MOST_GAINED: i64 = 4;

/// Kind of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// Nothing, yet.
    Nothing,
    /// The crank moved since the turn before.
    Jump,
    /// The crank moved on its shaft, or slowly over many turns.
    Drift,
    /// Pulses came at the spacing of a crank that runs.
    Run,
    /// A pulse came where no flag is.
    Extra,
}

#[derive(Clone, Copy, Debug)]
struct Event {
    what: What,
    name: FaultKind,
    /// Turns since the event, counted by the index.
    age: u8,
    /// Size, an angle.
    by: i32,
}

impl Event {
    const NONE: Self = Self {
        what: What::Nothing,
        name: FaultKind::Slip,
        age: u8::MAX,
        by: 0,
    };
}

/// Last events of one axis.
#[derive(Clone, Debug)]
pub(in crate::drift) struct Diagnosis {
    /// Latest first.
    events: [Event; EVENTS],
    /// The latest move has not been reported yet.
    is_new: bool,
}

impl Diagnosis {
    pub(in crate::drift) const fn new() -> Self {
        Self {
            events: [Event::NONE; EVENTS],
            is_new: false,
        }
    }

    /// Counts a turn, as the index was detected again.
    #[inline(never)]
    pub(in crate::drift) fn pass_turn(&mut self) {
        for event in &mut self.events {
            event.age = event.age.saturating_add(1);
        }
    }

    #[inline(never)]
    fn record(&mut self, what: What, name: FaultKind, by: Turns) {
        let mut event = Event {
            what,
            name,
            age: 0,
            by: angle(by),
        };
        for slot in &mut self.events {
            event = core::mem::replace(slot, event);
        }
        self.is_new |= matches!(what, What::Jump | What::Drift);
    }

    /// Records that the crank jumped, forward if `by` is positive, and whether it is ahead of its command now; returns the name.
    #[inline(never)]
    pub(in crate::drift) fn jump(
        &mut self,
        traits: &Traits,
        by: Turns,
        is_ahead: bool,
    ) -> FaultKind {
        let name = self.name_of_jump(traits, by, is_ahead);
        self.record(What::Jump, name, by);
        name
    }

    /// Records that the crank moved on its shaft, or slowly over many turns.
    pub(in crate::drift) fn drift(&mut self, by: Turns) {
        self.record(What::Drift, FaultKind::Slip, by);
    }

    /// Records pulses at the spacing of a crank that runs, which are reported at once.
    pub(in crate::drift) fn run(&mut self) {
        self.record(What::Run, FaultKind::Runaway, Turns::ZERO);
    }

    /// Records a pulse where no flag is. Returns false if the sensor has failed.
    pub(in crate::drift) fn extra(&mut self, by: Turns) -> bool {
        self.record(What::Extra, FaultKind::IndexExtra, by);
        let mut events = self.events.iter();
        events.any(|event| event.what != What::Extra || usize::from(event.age) >= EVENTS)
    }

    /// True if a pulse came where no flag is, and none in its place since.
    pub(in crate::drift) fn had_extra(&self) -> bool {
        let mut events = self.events.iter();
        events.any(|event| event.what == What::Extra && event.age == 0)
    }

    /// True if the crank jumped forward when its index showed it last.
    pub(in crate::drift) fn has_jumped_ahead(&self) -> bool {
        let jump = self.jumps().next();
        jump.is_some_and(|event| event.age == 0 && event.by > 0)
    }

    /// True if the crank slipped when its index showed it last.
    pub(in crate::drift) fn is_slipping(&self) -> bool {
        let latest = self.latest();
        latest.is_some_and(|event| event.age == 0 && event.name == FaultKind::Slip)
    }

    /// Name of the motion of the crank, if that was in the last turns.
    pub(in crate::drift) fn name(&self) -> Option<FaultKind> {
        self.latest().map(|event| event.name)
    }

    /// Takes the name and size of the latest move, if they have not been taken yet.
    pub(in crate::drift) fn take_new(&mut self) -> Option<(FaultKind, Turns)> {
        let is_new = core::mem::take(&mut self.is_new);
        let latest = if is_new { self.latest() } else { None };
        latest.map(|event| (event.name, of_angle(event.by)))
    }

    /// The latest event that moved the crank, if it still explains the crank's place.
    #[inline(never)]
    fn latest(&self) -> Option<&Event> {
        let moves = |event: &&Event| !matches!(event.what, What::Nothing | What::Extra);
        let latest = self.events.iter().find(moves);
        latest.filter(|event| event.age < FORGOTTEN_AFTER)
    }

    fn jumps(&self) -> impl Iterator<Item = &Event> {
        self.events.iter().filter(|event| event.what == What::Jump)
    }

    fn name_of_jump(&self, traits: &Traits, by: Turns, is_ahead: bool) -> FaultKind {
        // Jumps the same way in the turns before this one, without a break.
        let mut row = self
            .jumps()
            .zip(1_u8..)
            .take_while(|(event, before)| event.age <= *before && (event.by < 0) == (by < 0))
            .map(|(event, _)| of_angle(event.by));
        let (before, earlier) = (row.next(), row.next());
        let Some(before) = before else {
            return traits.name_of_one(by);
        };
        // A runaway gains more in its second turn than in the rest of its first. So does a crank that makes up for a lag, but it stays
        // behind.
        let gains = is_ahead && by > 0 && (by > before || earlier.is_some());
        // If a crank passes its index while it jumps, the index shows a part of the jump then, and the rest a turn later.
        let whole = traits.is_whole(by) && traits.is_whole(before)
            || earlier.is_none() && traits.is_whole_in_two(before.wrapping_add(by));
        if gains {
            FaultKind::Runaway
        } else if whole {
            FaultKind::LostSteps
        } else {
            FaultKind::Slip
        }
    }
}

impl Traits {
    /// Name of a single jump.
    pub(in crate::drift) fn name_of_one(&self, by: Turns) -> FaultKind {
        if self.is_whole(by) {
            FaultKind::LostSteps
        } else {
            FaultKind::Slip
        }
    }

    /// True if two parts of a jump add up to whole cycles, and to no more than a few. One large jump in four is whole by chance, and a
    /// stepper that gains more than a few cycles runs away.
    fn is_whole_in_two(&self, by: Turns) -> bool {
        self.is_whole(by)
            && by.to_bits() <= MOST_GAINED * self.cycle.to_bits() + self.cycle.to_bits() / 2
    }

    /// True if a jump is one or more whole electrical cycles.
    fn is_whole(&self, by: Turns) -> bool {
        if self.cycle <= 0 {
            return false;
        }
        let cycle = self.cycle.to_bits();
        let by = by.wrapping_abs().to_bits();
        // With 17 bits dropped, half a turn fits 32 bits. A cycle is at least 2⁻¹⁴ turn, so their count is exact.
        let units = |turns: i64| (turns >> 17) as u32;
        let cycles = units(by + cycle / 2).checked_div(units(cycle)).unwrap_or(0);
        let off = nearest(Turns::from_bits(by - i64::from(cycles) * cycle));
        cycles > 0 && off.abs() <= self.tolerance.min(Turns::from_bits(cycle / 4))
    }
}

/// True if `new` is a better name than `old` for a fault of the same axis in the same stop.
pub(crate) fn is_better(new: FaultKind, old: FaultKind) -> bool {
    const fn rank(kind: FaultKind) -> u8 {
        match kind {
            FaultKind::Tilt
            | FaultKind::Warp
            | FaultKind::CommonLag
            | FaultKind::IndexTimeout
            | FaultKind::IndexExtra
            | FaultKind::Capture => 0,
            FaultKind::LostSteps | FaultKind::Slip => 1,
            FaultKind::IndexMissing | FaultKind::Stuck | FaultKind::Runaway => 2,
            // A crank that turns back seems to stand at first. It must not be driven on.
            FaultKind::Reversed => 3,
            _ => 4,
        }
    }
    if let FaultKind::IndexMissing = new {
        return matches!(old, FaultKind::IndexTimeout);
    }
    let (new_rank, old_rank) = (rank(new), rank(old));
    // Of lost steps and slip, the later name is the better one.
    let is_other_kind = new_rank == 1 && old_rank == 1 && new as u8 != old as u8;
    new_rank < 4 && (new_rank > old_rank || is_other_kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::sample;

    const CYCLE_DEG: f64 = 7.2;

    fn deg(deg: f64) -> Turns {
        Turns::from_num(deg / 360.0)
    }

    fn traits(cycle: Turns) -> Traits {
        let settings = sample::settings(2);
        let tolerance = deg(0.45);
        let of_axis = Traits::new(&settings.axes[0], &settings, Turns::ZERO, Turns::ZERO);
        Traits {
            tolerance,
            cycle,
            ..of_axis
        }
    }

    /// Name of a jump of a stepper in the turn after the last event.
    fn next(axis: &mut Diagnosis, by_deg: f64) -> FaultKind {
        axis.pass_turn();
        axis.jump(&traits(deg(CYCLE_DEG)), deg(by_deg), true)
    }

    #[test]
    fn whole_cycles_are_lost_steps_and_nothing_else_is() {
        for cycles in [-20.0, -3.0, -1.0, 1.0, 2.0] {
            for off in [-0.4, 0.0, 0.4] {
                let by = cycles * CYCLE_DEG + off;
                assert_eq!(
                    next(&mut Diagnosis::new(), by),
                    FaultKind::LostSteps,
                    "{by}"
                );
            }
        }
        for off in [-3.6, -2.0, 2.0, 10.0, 30.0] {
            assert_eq!(next(&mut Diagnosis::new(), off), FaultKind::Slip, "{off}");
        }
        let servo = traits(Turns::ZERO);
        assert_eq!(servo.name_of_one(deg(7.2)), FaultKind::Slip);
    }

    /// One jump of many may be whole by chance. The next one shows that it is a slip or a runaway.
    #[test]
    fn what_goes_on_is_no_loss_of_steps_and_what_gains_runs_away() {
        let names = |jumps: &[f64]| {
            let mut axis = Diagnosis::new();
            let names = jumps.iter().map(|&by| next(&mut axis, by));
            names.collect::<std::vec::Vec<_>>()
        };
        use FaultKind::{LostSteps, Runaway, Slip};
        assert_eq!(names(&[-7.2, -9.7]), [LostSteps, Slip]);
        assert_eq!(names(&[-7.2, -14.4]), [LostSteps, LostSteps]);
        assert_eq!(names(&[50.0, 83.0])[1], Runaway);
        assert_eq!(names(&[9.4, 5.0, 7.2]), [Slip, LostSteps, Runaway]);
        assert_eq!(names(&[51.456, 107.477])[1], Runaway);
    }

    /// If this fails, a machine whose cranks lag less as it stops disables its drives while it turns.
    #[test]
    fn a_crank_that_makes_up_for_a_lag_does_not_run_away() {
        let mut axis = Diagnosis::new();
        next(&mut axis, 2.0);
        axis.pass_turn();
        assert_eq!(
            axis.jump(&traits(deg(CYCLE_DEG)), deg(2.6), false),
            FaultKind::Slip
        );
    }

    #[test]
    fn a_turn_without_a_jump_ends_a_row() {
        let mut axis = Diagnosis::new();
        next(&mut axis, 50.0);
        axis.pass_turn();
        assert_eq!(next(&mut axis, 83.0), FaultKind::Slip);
        assert_eq!(next(&mut axis, 90.0), FaultKind::Runaway);
    }

    /// If this fails, a sensor with occasional noise stops the machine, or one that has failed does not.
    #[test]
    fn extra_pulses_in_four_turns_in_a_row_are_a_failed_sensor() {
        let mut axis = Diagnosis::new();
        for turn in 0..4 {
            assert_eq!(axis.extra(deg(90.0)), turn < 3);
            axis.pass_turn();
        }
        axis.pass_turn();
        assert!(axis.extra(deg(90.0)), "a turn had none");
    }

    /// If this fails, an event of years ago is named as the reason why a crank is beyond its limit.
    #[test]
    fn an_event_is_forgotten_after_some_turns() {
        let mut axis = Diagnosis::new();
        axis.drift(deg(2.0));
        let by = of_angle(angle(deg(2.0)));
        assert_eq!(axis.take_new(), Some((FaultKind::Slip, by)));
        assert_eq!(axis.take_new(), None);
        for _ in 0..FORGOTTEN_AFTER {
            assert_eq!(axis.name(), Some(FaultKind::Slip));
            axis.pass_turn();
        }
        assert_eq!(axis.name(), None);
    }

    /// If this fails for a crank that turns back, it is still called stuck, and its drive stays on. If it fails for one that swings ahead
    /// as it is released, it is called a runaway, and a stop ends as a coast.
    #[test]
    fn what_turns_back_is_no_longer_stuck_and_what_swings_ahead_is() {
        assert!(is_better(FaultKind::Reversed, FaultKind::Stuck));
        assert!(is_better(FaultKind::Reversed, FaultKind::Tilt));
        assert!(!is_better(FaultKind::Stuck, FaultKind::Reversed));
        assert!(!is_better(FaultKind::Runaway, FaultKind::Stuck));
        assert!(!is_better(FaultKind::Reversed, FaultKind::SwappedWiring));
    }
}
