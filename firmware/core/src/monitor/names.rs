//! Names for the motion of one crank: a function of its last events.
//!
//! | last events | name |
//! | --- | --- |
//! | a jump by whole electrical cycles of a stepper, or two that add up to a few | *lost steps* |
//! | any other jump, or a slow slip beyond a gate | *slip* |
//! | jumps ahead in turn after turn that gain, or pulses at the spacing of a crank that runs | *runaway* |
//! | pulses where no flag is | *extra index pulse* |
//!
//! No name is needed to stop the machine. Events arrive turn by turn, and a better name may replace a worse one while the machine stops. At
//! first, the only symptom may be an overdue crank or a tilted platform.

use super::angles::{Angle, of_angle};
use super::config::AxisConfig;
use crate::supervisor::FaultKind;
use crate::units::{ONE_TURN, Turns, nearest};

/// Number of events that are kept. If all of them are extra pulses within as many turns, the sensor has failed.
const EVENTS: usize = 4;

/// Turns after which an event no longer explains where the crank is.
const FORGOTTEN_AFTER: u32 = 8;

/// Electrical cycles that a stepper may gain at once.
const MAX_GAINED: i64 = 4;

/// Turns from an extra pulse to the one in its place, if a runaway may have made it. At more than twice the commanded speed, a crank passes
/// its flag once between, and once in its place. Above ½ turn it would be slower. Below 1 − p, with p² + p = 1, the next pulse still shows
/// the runaway in time. The range is wider by 0.02 and 0.04, for a master that accelerates.
const RUNAWAY_PULSE_WINDOW: core::ops::RangeInclusive<Turns> =
    Turns::lit("0.34")..=Turns::lit("0.52");

/// Kind of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EventKind {
    /// Nothing, yet.
    Nothing,
    /// The crank moved since the turn before.
    Jump,
    /// The crank moved on its shaft, or slowly over many turns.
    SlowSlip,
    /// Pulses came at the spacing of a crank that runs.
    Run,
    /// A pulse came where no flag is.
    Extra,
}

#[derive(Clone, Copy, Debug)]
struct Event {
    kind: EventKind,
    by: Angle,
    /// Turn of the crank in which it happened.
    turn: u32,
    /// True if the crank was ahead of its command by then.
    is_ahead: bool,
}

/// Last events of one axis.
#[derive(Clone, Debug)]
pub(super) struct Events {
    /// Latest first.
    events: [Event; EVENTS],
    /// Turns of the crank that its index has shown.
    turn: u32,
}

impl Events {
    pub(super) const fn new() -> Self {
        const NONE: Event = Event {
            kind: EventKind::Nothing,
            by: Angle::ZERO,
            turn: 0,
            is_ahead: false,
        };
        Self {
            events: [NONE; EVENTS],
            turn: 0,
        }
    }

    /// Counts a turn, as the index was detected again.
    pub(super) const fn pass_turn(&mut self) {
        self.turn = self.turn.wrapping_add(1);
    }

    #[inline(never)]
    fn record(&mut self, kind: EventKind, by: Angle, is_ahead: bool) {
        let turn = self.turn;
        let mut event = Event {
            kind,
            by,
            turn,
            is_ahead,
        };
        for slot in &mut self.events {
            event = core::mem::replace(slot, event);
        }
    }

    /// Records that the crank jumped, forward if `by` is positive, and whether it is ahead of its command now.
    pub(super) fn jump(&mut self, by: Angle, is_ahead: bool) {
        self.record(EventKind::Jump, by, is_ahead);
    }

    /// Records that the crank moved on its shaft, or slowly over many turns.
    pub(super) fn slip(&mut self, by: Angle) {
        self.record(EventKind::SlowSlip, by, false);
    }

    /// Records pulses at the spacing of a crank that runs.
    pub(super) fn run(&mut self) {
        self.record(EventKind::Run, Angle::ZERO, true);
    }

    /// Records a pulse where no flag is. Returns false if the sensor has failed.
    pub(super) fn extra(&mut self, by: Angle) -> bool {
        self.record(EventKind::Extra, by, false);
        let mut events = self.events.iter();
        events.any(|event| event.kind != EventKind::Extra || self.age(event) >= EVENTS as u32)
    }

    const fn age(&self, event: &Event) -> u32 {
        self.turn.wrapping_sub(event.turn)
    }

    /// True if a pulse came where no flag is, and none in its place since.
    pub(super) fn had_extra(&self) -> bool {
        let mut events = self.events.iter();
        events.any(|event| event.kind == EventKind::Extra && self.age(event) == 0)
    }

    /// True if the crank jumped forward when its index showed it last.
    pub(super) fn has_jumped_ahead(&self) -> bool {
        let jump = self.jumps().next();
        jump.is_some_and(|event| self.age(event) == 0 && event.by > Angle::ZERO)
    }

    /// True if a pulse that is off by `by` continues an even row of three with the last extra pulse and the one in its place since: the
    /// crank runs away. Noise that comes once per turn comes at the same place.
    pub(super) fn runs_on(&self, by: Angle, config: &AxisConfig) -> bool {
        let [last, ..] = &self.events;
        let spacing = forward(last.by);
        let late = forward(-by).wrapping_sub(spacing).abs();
        last.kind == EventKind::Extra
            && self.age(last) == 1
            && spacing <= *RUNAWAY_PULSE_WINDOW.end()
            && config.is_beyond_gate(by - last.by)
            && late <= spacing / 4
    }

    fn jumps(&self) -> impl Iterator<Item = &Event> {
        self.events
            .iter()
            .filter(|event| event.kind == EventKind::Jump)
    }

    /// The latest motion, if it still explains where the crank is.
    #[inline(never)]
    fn latest(&self) -> Option<&Event> {
        let moves = |event: &&Event| !matches!(event.kind, EventKind::Nothing | EventKind::Extra);
        let latest = self.events.iter().find(moves);
        latest.filter(|&event| self.age(event) < FORGOTTEN_AFTER)
    }

    /// True if the crank moved in the last turns.
    pub(super) fn has_moved(&self) -> bool {
        self.latest().is_some()
    }

    /// Size of the latest motion.
    pub(super) fn size(&self) -> Angle {
        self.latest().map_or(Angle::ZERO, |event| event.by)
    }

    /// True if the crank slipped when its index showed it last.
    pub(super) fn is_slipping(&self, config: &AxisConfig) -> bool {
        let is_new = self.latest().is_some_and(|event| self.age(event) == 0);
        is_new && self.name(config) == Some(FaultKind::Slip)
    }

    /// Name of the motion of the crank, if that was in the last turns.
    #[inline(never)]
    pub(super) fn name(&self, config: &AxisConfig) -> Option<FaultKind> {
        let latest = self.latest()?;
        let by = of_angle(latest.by);
        match latest.kind {
            EventKind::Jump => {}
            EventKind::Run => return Some(FaultKind::Runaway),
            _ => return Some(FaultKind::Slip),
        }
        // Jumps the same way in the turns before this one, without a break.
        let mut row = self
            .jumps()
            .skip(1)
            .zip(1_u32..)
            .take_while(|(event, ago)| {
                latest.turn.wrapping_sub(event.turn) <= *ago && (of_angle(event.by) < 0) == (by < 0)
            })
            .map(|(event, _)| of_angle(event.by));
        let (before, earlier) = (row.next(), row.next());
        let Some(before) = before else {
            return Some(config.name_of_one(by));
        };
        // A runaway gains more in its second turn than in the rest of its first. So does a crank that makes up for a lag, but it stays
        // behind.
        let gains = latest.is_ahead && by > 0 && (by > before || earlier.is_some());
        // If a crank passes its index while it jumps, the index shows a part of the jump then, and the rest a turn later.
        let whole = config.is_whole(by) && config.is_whole(before)
            || earlier.is_none() && config.is_whole_in_two(before.wrapping_add(by));
        Some(if gains {
            FaultKind::Runaway
        } else if whole {
            FaultKind::LostSteps
        } else {
            FaultKind::Slip
        })
    }
}

/// True if the extra pulse that was off by `by` may be that of a crank that runs away.
pub(super) fn may_be_fast(by: Angle) -> bool {
    RUNAWAY_PULSE_WINDOW.contains(&forward(by))
}

/// An angle from 0 up to a turn.
const fn forward(angle: Angle) -> Turns {
    Turns::from_bits(of_angle(angle).to_bits() & (ONE_TURN - 1))
}

impl AxisConfig {
    /// Name of a single jump.
    pub(super) fn name_of_one(&self, by: Turns) -> FaultKind {
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
            && by.to_bits() <= MAX_GAINED * self.cycle.to_bits() + self.cycle.to_bits() / 2
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

#[cfg(test)]
mod tests {
    use super::super::angles::angle;
    use super::*;
    use crate::settings::sample;

    const CYCLE_DEG: f64 = 7.2;

    fn deg(deg: f64) -> Turns {
        Turns::from_num(deg / 360.0)
    }

    fn config(cycle: Turns) -> AxisConfig {
        let settings = sample::settings(2);
        let tolerance = deg(0.45);
        let of_axis = AxisConfig::new(&settings.axes[0], &settings, Turns::ZERO, Turns::ZERO);
        AxisConfig {
            tolerance,
            cycle,
            ..of_axis
        }
    }

    /// Name of a jump of a stepper that is ahead of its command by then, or not.
    fn name_after(axis: &mut Events, by_deg: f64, is_ahead: bool) -> FaultKind {
        axis.jump(angle(deg(by_deg)), is_ahead);
        let name = axis.name(&config(deg(CYCLE_DEG)));
        name.expect("a jump has a name")
    }

    /// Name of a jump in the turn after the last event.
    fn next(axis: &mut Events, by_deg: f64) -> FaultKind {
        axis.pass_turn();
        name_after(axis, by_deg, true)
    }

    #[test]
    fn whole_cycles_are_lost_steps_and_nothing_else_is() {
        for cycles in [-20.0, -3.0, -1.0, 1.0, 2.0] {
            for off in [-0.4, 0.0, 0.4] {
                let by = cycles * CYCLE_DEG + off;
                assert_eq!(next(&mut Events::new(), by), FaultKind::LostSteps, "{by}");
            }
        }
        for off in [-3.6, -2.0, 2.0, 10.0, 30.0] {
            assert_eq!(next(&mut Events::new(), off), FaultKind::Slip, "{off}");
        }
        let servo = config(Turns::ZERO);
        assert_eq!(servo.name_of_one(deg(7.2)), FaultKind::Slip);
    }

    /// One jump of many may be whole by chance. The next one shows that it is a slip or a runaway.
    #[test]
    fn what_goes_on_is_no_loss_of_steps_and_what_gains_runs_away() {
        let names = |jumps: &[f64]| {
            let mut axis = Events::new();
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
        let mut axis = Events::new();
        next(&mut axis, 2.0);
        axis.pass_turn();
        assert_eq!(name_after(&mut axis, 2.6, false), FaultKind::Slip);
    }

    #[test]
    fn a_turn_without_a_jump_ends_a_row() {
        let mut axis = Events::new();
        next(&mut axis, 50.0);
        axis.pass_turn();
        assert_eq!(next(&mut axis, 83.0), FaultKind::Slip);
        assert_eq!(next(&mut axis, 90.0), FaultKind::Runaway);
    }

    /// If this fails, a sensor with occasional noise stops the machine, or one that has failed does not.
    #[test]
    fn extra_pulses_in_four_turns_in_a_row_are_a_failed_sensor() {
        let mut axis = Events::new();
        for turn in 0..4 {
            assert_eq!(axis.extra(angle(deg(90.0))), turn < 3);
            axis.pass_turn();
        }
        axis.pass_turn();
        assert!(axis.extra(angle(deg(90.0))), "a turn had none");
    }

    /// If this fails, an event of years ago is named as the reason why a crank is beyond its limit.
    #[test]
    fn an_event_is_forgotten_after_some_turns() {
        let mut axis = Events::new();
        axis.slip(angle(deg(2.0)));
        let name = |axis: &Events| axis.name(&config(Turns::ZERO));
        for _ in 0..FORGOTTEN_AFTER {
            assert_eq!(name(&axis), Some(FaultKind::Slip));
            axis.pass_turn();
        }
        assert_eq!(name(&axis), None);
    }
}
