//! From turns in a tick to runs of edges.
//!
//! Within a tick the commanded phase moves at constant speed. With T the tick's cycles, the edge
//! that lies d half-steps ahead, of the h half-steps that the tick makes, is due at T d / h. These
//! times are equally spaced, but seldom by whole cycles. So the edges are taken in chunks of at
//! most [`CHUNK`]: a chunk ends on the last whole cycle before its last edge is due, and is made of
//! two runs whose periods differ by one cycle.
//!
//! **Bound.** An edge of a chunk of m is off its straight line by at most m/4 = 20 cycles (the
//! chunk's edges are late, or early, by up to r (m − r)/m with r of them in the longer run). Rounding a chunk's end
//! down takes less than 1 cycle, and the limited precision of the spacing less than ¼ (15 fraction
//! bits, at most 4,800 edges). The first and the last edge of a tick keep [`GUARD`] = 8 cycles from
//! its ends, which the hardware needs to take up a run; that moves edges by at most 8 cycles. In all
//! 29.25 cycles: **0.234 µs at 125 MHz**. Nothing is carried from one tick to the next.
//!
//! **Changes of direction.** DIR is changed only for an edge that needs it. The tick then begins
//! with what STEP and DIR need (end of the pulse, hold, set-up), and its edges share what is left:
//! they are late by at most that time, which is at most a quarter of a tick. The change is carried by
//! a pause, and the line follows [`Run::DIR_DELAY`] cycles after that begins; hold and set-up are
//! reckoned from there.

use super::{MAX_EDGES, Run, Runs};
use crate::settings::{AxisSettings, CLOCK_HZ, Problem, PulseSettings, SettingsError};
use crate::units::{FRACTION_BITS, Turns};

/// Most edges that share a chunk.
pub const CHUNK: u32 = 80;

/// Least distance of an edge from either end of its tick, cycles.
pub const GUARD: u32 = Run::LEAST_CYCLES;

/// Most counts of a servo axis in a tick: half of what 64 bits hold, as half-steps of 2⁻⁴⁸.
const MOST_COUNTS: f64 = 8192.0;

/// One half-step, in the planner's units of 2⁻⁴⁸.
const HALF_STEP: u64 = 1 << FRACTION_BITS;

/// Fraction bits of times within a tick.
const TIME_BITS: u32 = 15;

/// The half-steps of a tick are brought to at most this many bits before dividing by them.
const SCALED_BITS: u32 = 30;

/// Timing of the step and direction lines, in cycles.
#[derive(Clone, Copy, Debug)]
pub struct PulseTiming {
    tick: u32,
    width: u32,
    /// The pause before the one that carries a change of direction.
    before_turn: u32,
    /// The pause that carries it.
    turn: u32,
}

impl PulseTiming {
    /// Timing for a tick rate.
    ///
    /// # Errors
    /// A direction change that needs more than a quarter of a tick.
    pub fn new(settings: &PulseSettings, tick_hz: u32) -> Result<Self, SettingsError> {
        let cycles = |ns: f64| libm::ceil(ns * f64::from(CLOCK_HZ) / 1e9) as u32;
        let width = cycles(settings.width_ns);
        // The line is held for this pause, and turns DIR_DELAY after it.
        let before_turn = cycles(settings.dir_hold_ns)
            .saturating_sub(Run::DIR_DELAY)
            .max(Run::LEAST_CYCLES);
        // The next edge comes at least GUARD after the pause, which makes up for DIR_DELAY. A change of
        // direction follows a falling edge, and STEP must stay low for its width, too.
        const { assert!(GUARD >= Run::DIR_DELAY) };
        let turn = cycles(settings.dir_setup_ns)
            .max(width.saturating_sub(before_turn + GUARD))
            .max(Run::LEAST_CYCLES);
        let timing = Self {
            tick: CLOCK_HZ / tick_hz,
            width,
            before_turn,
            turn,
        };
        let turn_round = width.max(GUARD) + before_turn + turn + 2 * GUARD;
        if turn_round > timing.tick / 4 {
            let us = |cycles: u32| f64::from(cycles) * 1e6 / f64::from(CLOCK_HZ);
            return Err(SettingsError::new(
                "pulse.dir_setup_ns",
                Problem::SetupTooLong {
                    need_us: us(turn_round),
                    most_us: us(timing.tick / 4),
                },
            ));
        }
        Ok(timing)
    }

    /// Most steps a second: the pulse's width must be left when an edge has moved by the guard, also
    /// in the three quarters of a tick that a change of direction leaves.
    fn most_step_hz(&self, tick_hz: u32) -> f64 {
        let half_step = f64::from((self.width + GUARD + 2).max(2 * GUARD)) * 4.0 / 3.0;
        let by_width = f64::from(CLOCK_HZ) / (2.0 * half_step);
        let by_edges = f64::from(MAX_EDGES - 2) * f64::from(tick_hz) / 2.0;
        by_width.min(by_edges)
    }

    /// Checks that an axis can make its steps at its greatest speed.
    ///
    /// # Errors
    /// More steps a second than the pulse width, or the edges of a tick, allow.
    pub fn check_rate(
        &self,
        axis: &AxisSettings,
        axis_speed_hz: f64,
        tick_hz: u32,
    ) -> Result<(), SettingsError> {
        let rate_hz = axis_speed_hz * f64::from(axis.steps_per_turn);
        let most_hz = self.most_step_hz(tick_hz);
        if rate_hz > most_hz {
            return Err(SettingsError::new(
                "axes.steps_per_turn",
                Problem::StepRate {
                    speed_hz: axis_speed_hz,
                    rate_hz,
                    most_hz,
                    edges: MAX_EDGES,
                },
            ));
        }
        Ok(())
    }

    /// Checks that an axis that is only counted, a servo's, can be: 64 bits hold a tick's counts.
    ///
    /// # Errors
    /// More than 8192 counts a tick.
    pub fn check_counts(
        axis: &AxisSettings,
        axis_speed_hz: f64,
        tick_hz: u32,
    ) -> Result<(), SettingsError> {
        let rate_hz = axis_speed_hz * f64::from(axis.steps_per_turn);
        let most_hz = MOST_COUNTS * f64::from(tick_hz);
        if rate_hz > most_hz {
            return Err(SettingsError::new(
                "axes.steps_per_turn",
                Problem::CountRate {
                    speed_hz: axis_speed_hz,
                    rate_hz,
                    most_hz,
                    most_steps: (most_hz / axis_speed_hz) as u32,
                },
            ));
        }
        Ok(())
    }

    /// Cycles in a tick.
    pub const fn tick(&self) -> u32 {
        self.tick
    }
}

/// Plans the pulses of one axis.
#[derive(Clone, Debug)]
pub struct Planner {
    timing: PulseTiming,
    half_steps_per_turn: i64,
    /// Half-steps past the last whole step, 0 ≤ within < 2 half-steps.
    within: u64,
    /// Whole steps made.
    steps: i64,
    /// Level of STEP.
    high: bool,
    /// Level of DIR.
    forward: bool,
    /// Whether the next chunk begins with its longer periods; alternating lets runs merge.
    long_first: bool,
}

impl Planner {
    /// At step 0, STEP low, DIR forward.
    pub const fn new(timing: PulseTiming, steps_per_turn: u32) -> Self {
        Self {
            timing,
            half_steps_per_turn: 2 * steps_per_turn as i64,
            within: 0,
            steps: 0,
            high: false,
            forward: true,
            long_first: false,
        }
    }

    /// Steps commanded since the start: the whole steps in the phase travelled, rounded down.
    pub const fn steps(&self) -> i64 {
        self.steps
    }

    /// Replaces `runs` with those of a tick in which the axis makes `turns`.
    ///
    /// `turns` must not ask for more edges than [`PulseTiming::check_rate`] allowed.
    pub fn plan(&mut self, turns: Turns, runs: &mut Runs) {
        let way = self.travel(turns);
        let mut tick = Tick::new(runs, self.forward);

        // Where STEP's level is not what the phase and the way it moves would have it (at the very
        // start, and after a change of direction), the first crossing must not, or must also, fall.
        let due_high = way.first_index.is_multiple_of(2) == way.forward;
        let skipped = u32::from(way.crossings > 0 && due_high && !self.high);
        let edges = way.crossings - skipped;
        if edges > 0 {
            if way.forward != self.forward || self.high != due_high {
                self.turn_round(way.forward, &mut tick);
            }
            self.long_first = tick.edges(&way, 1 + skipped, self.timing.tick, self.long_first);
            self.high ^= edges % 2 == 1;
        }
        tick.pause(self.timing.tick - tick.cursor);
    }

    /// Counts on without pulses, for a servo axis: `runs` is one pause of a tick.
    pub fn count(&mut self, turns: Turns, runs: &mut Runs) {
        self.travel(turns);
        Tick::new(runs, self.forward).pause(self.timing.tick);
    }

    /// Moves on, and says over which steps.
    fn travel(&mut self, turns: Turns) -> Way {
        let way = Way::new(self.within, turns.to_bits() * self.half_steps_per_turn);
        self.steps += way.steps;
        self.within = way.within;
        way
    }

    /// Ends a pulse that is still high, and changes direction if that is needed.
    fn turn_round(&mut self, forward: bool, tick: &mut Tick<'_>) {
        if self.high {
            tick.run(1, self.timing.width.max(GUARD));
            self.high = false;
        }
        if forward != self.forward {
            tick.pause(self.timing.before_turn);
            tick.forward = forward;
            self.forward = forward;
            tick.pause(self.timing.turn);
        }
    }
}

/// The half-steps of one tick.
struct Way {
    forward: bool,
    /// Half-steps made, without their sign, in 2⁻⁴⁸.
    length: u64,
    /// Half-steps to the first crossing, in 2⁻⁴⁸.
    to_first: u64,
    /// Crossings of whole or half steps.
    crossings: u32,
    /// Number of the half-step in which the tick begins: even in the first half of a step.
    first_index: u64,
    /// Whole steps made, with their sign.
    steps: i64,
    /// Half-steps past the last whole step at the end.
    within: u64,
}

impl Way {
    fn new(within: u64, moved: i64) -> Self {
        let first_index = within / HALF_STEP;
        let past = within % HALF_STEP;
        let end = within as i64 + moved;
        let whole = 2 * HALF_STEP as i64;
        let steps = end.div_euclid(whole);
        let last_index = end.div_euclid(HALF_STEP as i64);
        Self {
            forward: moved >= 0,
            length: moved.unsigned_abs(),
            to_first: if moved >= 0 { HALF_STEP - past } else { past },
            crossings: (last_index - first_index as i64).unsigned_abs() as u32,
            first_index,
            steps,
            within: end.rem_euclid(whole) as u64,
        }
    }
}

/// A tick being filled.
struct Tick<'a> {
    runs: &'a mut Runs,
    forward: bool,
    /// Cycles filled so far.
    cursor: u32,
}

impl<'a> Tick<'a> {
    fn new(runs: &'a mut Runs, forward: bool) -> Self {
        runs.clear();
        Self {
            runs,
            forward,
            cursor: 0,
        }
    }

    /// Spreads the crossings from number `first` (counted from 1) on over what is left of the tick.
    fn edges(&mut self, way: &Way, first: u32, tick: u32, mut long_first: bool) -> bool {
        let start = self.cursor;
        let window = tick - start;
        let bits = u64::BITS - way.length.leading_zeros();
        let shift = bits.saturating_sub(SCALED_BITS);
        let length = (way.length >> shift).max(1);
        let at = |half_steps: u64| {
            // Below 2^30 · 2^18 · 2^15 = 2^63: the half-steps are at most the tick's own.
            (((half_steps >> shift) * u64::from(window)) << TIME_BITS) / length
        };
        let to_first = at(way.to_first);
        let spacing = if way.crossings > 1 { at(HALF_STEP) } else { 0 };
        let due = |number: u32| {
            let cycles = (to_first + u64::from(number - 1) * spacing) >> TIME_BITS;
            start + (cycles as u32).clamp(GUARD, window - GUARD)
        };

        self.run(1, due(first) - self.cursor);
        let mut number = first;
        while number < way.crossings {
            let count = (way.crossings - number).min(CHUNK);
            number += count;
            let cycles = due(number) - self.cursor;
            let (period, longer) = (cycles / count, cycles % count);
            if long_first {
                self.run(longer, period + 1);
                self.run(count - longer, period);
            } else {
                self.run(count - longer, period);
                self.run(longer, period + 1);
            }
            long_first = !long_first;
        }
        long_first
    }

    /// Appends a run, or lengthens the last one if it is alike.
    fn run(&mut self, edges: u32, period: u32) {
        if edges == 0 {
            return;
        }
        self.cursor += edges * period;
        if let Some(last) = self.runs.last_mut()
            && !last.is_pause()
            && last.period() == period
        {
            *last = Run::new(last.edges() + edges, period, self.forward);
            return;
        }
        self.push(Run::new(edges, period, self.forward));
    }

    fn pause(&mut self, cycles: u32) {
        self.cursor += cycles;
        self.push(Run::pause(cycles, self.forward));
    }

    fn push(&mut self, run: Run) {
        // MAX_EDGES, which the settings keep, is what MAX_RUNS hold.
        let pushed = self.runs.push(run);
        debug_assert!(pushed.is_ok(), "more runs than a tick holds");
    }
}

#[cfg(test)]
mod tests;
