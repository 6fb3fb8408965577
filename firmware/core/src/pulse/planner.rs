//! From turns in a tick to runs of edges.
//!
//! Within a tick the commanded phase moves at constant speed. With T the tick's cycles, the edge
//! that lies d half-steps ahead, of the h half-steps that the tick makes, is due at T d / h. These
//! times are equally spaced, but seldom by whole cycles. So the edges are taken in chunks of at
//! most [`CHUNK`]: a chunk ends on the whole cycle next to which its last edge is due, and is made of
//! two runs whose periods differ by one cycle. It begins with the one that goes on with the run before, if either
//! does, so that most chunks take one run.
//!
//! **Bound.** An edge of a chunk of m is off its straight line by at most m/4 = 16 cycles (the
//! chunk's edges are late, or early, by up to r (m − r)/m with r of them in the longer run). Rounding a chunk's end
//! takes at most ½ cycle, and the limited precision of the spacing less than ⅓ (14 fraction
//! bits, at most 4,800 edges). The first and the last edge of a tick keep [`GUARD`] = 8 cycles from
//! its ends, which the hardware needs to take up a run; that moves edges by at most 8 cycles. In all
//! 24.83 cycles: **0.199 µs at 125 MHz**. Nothing is carried from one tick to the next.
//!
//! **Cost.** One reciprocal and four products a tick; then additions, and for each chunk a shift.
//!
//! **Changes of direction.** DIR is changed only for an edge that needs it. The tick then begins
//! with what STEP and DIR need (end of the pulse, hold, set-up), and its edges share what is left:
//! they are late by at most that time, which is at most a quarter of a tick. The change is carried by
//! a pause, and the line follows [`Run::DIR_DELAY`] cycles after that begins; hold and set-up are
//! reckoned from there.

use super::{MAX_EDGES, Run, Runs};
use crate::functions::{multiply_high, multiply_long, reciprocal};
use crate::settings::{AxisSettings, CLOCK_HZ, Problem, PulseSettings, SettingsError};
use crate::units::{FRACTION_BITS, Turns};

/// Most edges that share a chunk.
pub const CHUNK: u32 = 1 << CHUNK_BITS;
const CHUNK_BITS: u32 = 6;

/// Least distance of an edge from either end of its tick, cycles.
pub const GUARD: u32 = Run::LEAST_CYCLES;

/// Most counts of a servo axis in a tick: half of what 64 bits hold, as half-steps of 2⁻⁴⁸.
const MOST_COUNTS: f64 = 8192.0;

/// One half-step, in the planner's units of 2⁻⁴⁸.
const HALF_STEP: u64 = 1 << FRACTION_BITS;

/// Fraction bits of times within a tick: the longest tick, 250,000 cycles, then has 32 bits.
const TIME_BITS: u32 = 14;

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
    half_steps_per_turn: u32,
    /// Half-steps past the last whole step, 0 ≤ within < 2 half-steps.
    within: u64,
    /// Whole steps made.
    steps: i64,
    /// Level of STEP.
    high: bool,
    /// Level of DIR.
    forward: bool,
}

impl Planner {
    /// At step 0, STEP low, DIR forward.
    pub const fn new(timing: PulseTiming, steps_per_turn: u32) -> Self {
        Self {
            timing,
            half_steps_per_turn: 2 * steps_per_turn,
            within: 0,
            steps: 0,
            high: false,
            forward: true,
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
        let due_high = way.begins_low == way.forward;
        let skipped = u32::from(way.crossings > 0 && due_high && !self.high);
        let edges = way.crossings - skipped;
        if edges > 0 {
            if way.forward != self.forward || self.high != due_high {
                self.turn_round(way.forward, &mut tick);
            }
            tick.edges(&way, 1 + skipped, self.timing.tick);
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
        let turns = turns.to_bits();
        let length = multiply_long(turns.unsigned_abs(), self.half_steps_per_turn);
        let forward = turns >= 0;
        let begin = self.within;
        let end = if forward {
            begin.wrapping_add(length)
        } else {
            begin.wrapping_sub(length)
        } as i64;
        // Half-steps by number: even in the first half of a step. Below 2^15 of them, so the upper word has room.
        let number = |place: i64| (place >> 32) as i32 >> (FRACTION_BITS - 32);
        let (first, last) = (number(begin as i64), number(end));
        self.steps += i64::from(last >> 1);
        self.within = end as u64 & (2 * HALF_STEP - 1);
        let past = begin & (HALF_STEP - 1);
        Way {
            forward,
            length,
            to_first: if forward { HALF_STEP - past } else { past },
            crossings: last.abs_diff(first),
            begins_low: first == 0,
        }
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
    /// Half-steps to the first crossing, in 2⁻⁴⁸; at most `length`, if there is a crossing.
    to_first: u64,
    /// Crossings of whole or half steps.
    crossings: u32,
    /// Whether the tick begins in the first half of a step.
    begins_low: bool,
}

impl Way {
    /// Times within a tick of `window` cycles, with [`TIME_BITS`]: of the first crossing, and between two.
    fn times(&self, window: u32) -> (u32, u32) {
        // Both scaled alike, so that the length has 32 bits: d and f.
        let words = |x: u64| ((x >> 32) as u32, x as u32);
        let ((high, low), (first_high, first_low)) = (words(self.length), words(self.to_first));
        let slow = high == 0;
        let ((high, low), (first_high, first_low)) = if slow {
            ((low, 0), (first_low, 0))
        } else {
            ((high, low), (first_high, first_low))
        };
        let zeros = high.leading_zeros();
        let scale = |high: u32, low: u32| high << zeros | low >> 1 >> (31 - zeros);
        let (d, f) = (scale(high, low), scale(first_high, first_low));
        // With r = 2^63/d: m is T r / 2^32, a crossing at f comes at T f/d = 2 f m / 2^32, and a half-step,
        // 2^48 of length d 2^(32 − zeros), takes m 2^(zeros − 15). Below one half-step there are no two crossings.
        let m = multiply_high(window << TIME_BITS, reciprocal(d));
        let spacing = if slow || zeros > 15 {
            0
        } else {
            m >> (15 - zeros)
        };
        (multiply_high(f, m) << 1, spacing)
    }
}

/// A tick being filled.
struct Tick<'a> {
    runs: &'a mut Runs,
    /// The last run, which may still grow; none if its edges are 0.
    last: (u32, u32),
    forward: bool,
    /// Cycles filled so far.
    cursor: u32,
}

impl<'a> Tick<'a> {
    fn new(runs: &'a mut Runs, forward: bool) -> Self {
        runs.clear();
        Self {
            runs,
            last: (0, 0),
            forward,
            cursor: 0,
        }
    }

    /// Spreads the crossings from number `first` (1 or 2) on over what is left of the tick.
    fn edges(&mut self, way: &Way, first: u32, tick: u32) {
        let start = self.cursor;
        let window = tick - start;
        let (to_first, spacing) = way.times(window);
        let due = |time: u32| start + (time >> TIME_BITS).clamp(GUARD, window - GUARD);

        let half_a_cycle = 1 << (TIME_BITS - 1);
        let mut time = half_a_cycle + to_first + (first - 1) * spacing;
        self.run(1, due(time) - self.cursor);
        let mut left = way.crossings - first;
        while left >= CHUNK {
            left -= CHUNK;
            time += spacing << CHUNK_BITS;
            let cycles = due(time) - self.cursor;
            self.chunk(CHUNK, cycles >> CHUNK_BITS, cycles & (CHUNK - 1));
        }
        if left > 0 {
            time += left * spacing;
            let cycles = due(time) - self.cursor;
            // The spacing says the period, but for what rounding and the guards have moved: a few corrections cost
            // less than a division.
            let mut period = spacing >> TIME_BITS;
            while period * left > cycles {
                period -= 1;
            }
            let mut longer = cycles - period * left;
            while longer >= left {
                longer -= left;
                period += 1;
            }
            self.chunk(left, period, longer);
        }
    }

    /// `edges` edges, `longer` of them after `period + 1` cycles, the others after `period`.
    fn chunk(&mut self, edges: u32, period: u32, longer: u32) {
        if longer > 0 && self.last.1 == period + 1 {
            self.run(longer, period + 1);
            self.run(edges - longer, period);
        } else {
            self.run(edges - longer, period);
            if longer > 0 {
                self.run(longer, period + 1);
            }
        }
    }

    /// Appends a run, or lengthens the last one if it is alike.
    fn run(&mut self, edges: u32, period: u32) {
        self.cursor += edges * period;
        if self.last.1 == period {
            self.last.0 += edges;
        } else {
            self.end_run();
            self.last = (edges, period);
        }
    }

    fn end_run(&mut self) {
        let (edges, period) = self.last;
        if edges > 0 {
            self.push(Run::new(edges, period, self.forward));
            self.last = (0, 0);
        }
    }

    fn pause(&mut self, cycles: u32) {
        self.end_run();
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
