//! Planner: converts the turns of a tick into runs of edges.
//!
//! Within a tick the commanded phase moves at constant speed. With T the tick's cycles, the edge that lies d half-steps
//! ahead, of the h half-steps of the tick, is due at T d / h. These times are equally spaced, but seldom by whole
//! cycles. So the edges are planned in chunks of at most [`CHUNK`]. A chunk ends on the whole cycle nearest to the time
//! at which its last edge is due. It consists of two runs whose periods differ by one cycle. It begins with the run that
//! continues the run before, if either does, so that most chunks take one run.
//!
//! **Bound.** An edge of a chunk of m deviates from its straight line by at most m/4 = 16 cycles. (The chunk's edges are
//! late, or early, by up to r (m − r)/m with r of them in the longer run.) Rounding a chunk's end adds at most ½ cycle,
//! and the limited precision of the spacing less than ⅓ (14 fraction bits, at most 4,800 edges). The first and the last
//! edge of a tick keep [`GUARD`] = 8 cycles from its ends, as the hardware needs them to read a run. That moves edges by
//! at most 8 cycles. The sum is 24.83 cycles: **0.199 µs at 125 MHz**. No error carries over from one tick to the next.
//!
//! **Cost.** One reciprocal and four products a tick; then additions, and for each chunk a shift.
//!
//! **Changes of direction.** DIR changes only for an edge that needs it. The tick then begins with the times that STEP
//! and DIR need (end of the pulse, hold, set-up), and its edges share the rest. They are late by at most that time,
//! which is at most a quarter of a tick. A pause carries the change, and the line follows [`Run::DIR_DELAY`] cycles
//! after the pause begins. Hold and set-up are counted from there.

use core::hash::{Hash, Hasher};

use super::run::RunsOf;
use super::runs::Appending;
use super::step_rate::{HALF_STEP, StepRate, StepRates, TIME_BITS};
use super::{PulseTiming, Run, Runs, StepsPerTurn};
use crate::functions::Ratio;
use crate::units::{FRACTION_BITS, Turns};

/// Greatest number of edges in a chunk.
pub const CHUNK: u32 = 1 << CHUNK_BITS;
const CHUNK_BITS: u32 = 6;

/// Least distance of an edge from either end of its tick, cycles.
pub const GUARD: u32 = Run::MIN_CYCLES;

/// Step planner of one axis. Its state is the position within a step and the levels of STEP and DIR.
///
/// An edge is at most 0.199 µs from the time at which the commanded phase crosses it (see the [module](self)). A tick
/// that changes the direction delays its edges further, by at most a quarter of a tick.
#[derive(Clone, Debug)]
pub struct Planner {
    timing: PulseTiming,
    place: Place,
}

/// Position of an axis within a step, and the levels of its lines. The edges of a tick also depend on its turns, and on the lines' timing,
/// which is the same for all axes of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    half_steps_per_turn: u32,
    /// Half-steps beyond the last whole step, 0 ≤ within < 2 half-steps.
    within: u64,
    /// Level of STEP.
    high: bool,
    /// Level of DIR.
    forward: bool,
    /// Fraction of a half-step that each turn has on top of the whole ones, with the remainder so far; none in the usual case.
    fraction: Option<Ratio>,
}

impl Place {
    /// Half-steps of 2⁻⁴⁸ that some turns have on top of the whole half-steps per turn, beside an `offset`.
    #[inline(always)]
    const fn beside(&mut self, turns: Turns, offset: i64) -> i64 {
        match &mut self.fraction {
            None => offset,
            Some(fraction) => offset + fraction.advance(turns.to_bits()),
        }
    }
}

impl Planner {
    /// Planner at step 0, with STEP low and DIR forward.
    pub const fn new(timing: PulseTiming, steps_per_turn: StepsPerTurn) -> Self {
        let (half_steps_per_turn, fraction) = steps_per_turn.half_steps();
        Self {
            timing,
            place: Place {
                half_steps_per_turn,
                within: 0,
                high: false,
                forward: true,
                fraction,
            },
        }
    }

    /// Returns the position of the axis within a step.
    pub const fn place(&self) -> &Place {
        &self.place
    }

    /// Hashes one half of what never changes: timing and steps per turn.
    #[inline(always)]
    pub fn hash_half(&self, second: bool, hasher: &mut impl Hasher) {
        let Self { timing, place } = self;
        let Place {
            half_steps_per_turn,
            within: _,
            high: _,
            forward: _,
            fraction,
        } = place;
        if second {
            fraction.as_ref().map(Ratio::constants).hash(hasher);
        } else {
            (timing, half_steps_per_turn).hash(hasher);
        }
    }

    /// Continues from the place of an axis whose plans this axis played.
    pub const fn continue_from(&mut self, place: &Place) {
        self.place = *place;
    }

    /// Replaces `runs` with those of a tick in which the axis covers `turns`. Returns the whole steps of the tick: their
    /// sum is the phase covered since the start, in whole steps, rounded down.
    ///
    /// `offset` are half-steps on top of the turns, in 2⁻⁴⁸. A phase offset that moves by whole steps is exact in them.
    ///
    /// Both together must not need more edges than [`PulseTiming::check_rate`] allowed. The cache of step rates may be
    /// shared by axes with the same tick length.
    #[inline]
    pub fn plan(
        &mut self,
        turns: Turns,
        offset: i64,
        step_rate: &mut StepRates,
        runs: &mut Runs,
    ) -> i32 {
        runs.clear();
        let tick_cycles = self.timing.tick;
        let offset = self.place.beside(turns, offset);
        let step_rate = step_rate.take(turns.to_bits(), offset, self.place.half_steps_per_turn);
        let travel = self.travel(step_rate);
        let forward = step_rate.forward;
        let due_high = travel.begins_low == forward;
        if travel.crossings == 0 {
            append(Run::pause(tick_cycles, self.place.forward), runs);
        } else if forward == self.place.forward && self.place.high == due_high {
            let times = (step_rate.first(travel.to_first), step_rate.spacing);
            self.place.high ^= travel.crossings % 2 == 1;
            schedule_edges(travel.crossings, 0, times, tick_cycles, forward, runs);
        } else {
            self.plan_turning(&travel, forward, due_high, step_rate, runs);
        }
        travel.steps
    }

    /// Plans a tick that does not continue as the one before ended.
    ///
    /// At the very start and after a change of direction, the level of STEP may differ from the one that phase and
    /// direction imply. Then the first crossing must not, or must also, fall.
    #[inline(never)]
    fn plan_turning(
        &mut self,
        travel: &Travel,
        forward: bool,
        due_high: bool,
        step_rate: &StepRate,
        runs: &mut Runs,
    ) {
        let tick_cycles = self.timing.tick;
        let skipped = u32::from(due_high && !self.place.high);
        let edges = travel.crossings - skipped;
        if edges == 0 {
            append(Run::pause(tick_cycles, self.place.forward), runs);
            return;
        }
        let start = self.turn_round(forward, runs);
        let (to_first, spacing) = step_rate.times(travel.to_first, tick_cycles - start);
        let first = if skipped == 0 {
            to_first
        } else {
            to_first + spacing
        };
        self.place.high ^= edges % 2 == 1;
        let times = (first, spacing);
        schedule_edges(edges, start, times, tick_cycles, self.place.forward, runs);
    }

    /// Counts the steps of a tick without pulses, for a servo axis: `runs` becomes one pause of a tick. Returns the steps
    /// as [`Self::plan`] does.
    #[inline(never)] // Inlined beside `plan` it would double the computation of step rates.
    pub fn count(
        &mut self,
        turns: Turns,
        offset: i64,
        step_rate: &mut StepRates,
        runs: &mut Runs,
    ) -> i32 {
        let offset = self.place.beside(turns, offset);
        let step_rate = step_rate.take(turns.to_bits(), offset, self.place.half_steps_per_turn);
        let travel = self.travel(step_rate);
        runs.clear();
        append(Run::pause(self.timing.tick, self.place.forward), runs);
        travel.steps
    }

    /// Advances by a tick and returns the half-steps that it crosses.
    #[inline(always)]
    fn travel(&mut self, step_rate: &StepRate) -> Travel {
        let begin = self.place.within;
        let passed = begin & (HALF_STEP - 1);
        let (end, to_first) = if step_rate.forward {
            (begin.wrapping_add(step_rate.length), HALF_STEP - passed)
        } else {
            (begin.wrapping_sub(step_rate.length), passed)
        };
        // Half-steps by number, even in the first half of a step. There are below 2^15 of them, which fit in the upper
        // word.
        let number = |place: u64| (place >> 32) as i32 >> (FRACTION_BITS - 32);
        let (first, last) = (number(begin), number(end));
        self.place.within = end & (2 * HALF_STEP - 1);
        Travel {
            to_first,
            crossings: last.abs_diff(first),
            begins_low: first == 0,
            steps: last >> 1,
        }
    }

    /// Ends a pulse that is still high, and changes the direction if needed; returns the cycles that this takes.
    fn turn_round(&mut self, forward: bool, runs: &mut Runs) -> u32 {
        let mut end = 0;
        if self.place.high {
            end = self.timing.width.max(GUARD);
            append(Run::new(1, end, self.place.forward), runs);
            self.place.high = false;
        }
        if forward != self.place.forward {
            append(
                Run::pause(self.timing.before_turn, self.place.forward),
                runs,
            );
            append(Run::pause(self.timing.turn, forward), runs);
            end += self.timing.before_turn + self.timing.turn;
            self.place.forward = forward;
        }
        end
    }
}

/// Half-steps of one tick.
struct Travel {
    /// Half-steps to the first crossing, in 2⁻⁴⁸; at most the tick's, if there is a crossing.
    to_first: u64,
    /// Crossings of whole or half steps.
    crossings: u32,
    /// True if the tick begins in the first half of a step.
    begins_low: bool,
    /// Whole steps made, rounded down.
    steps: i32,
}

/// Distributes `edges` (at least 1) over the tick from `start` on, and appends them and the pause after them.
///
/// The first is due after `first`, the others `spacing` apart, both with [`TIME_BITS`].
#[inline(always)] // A call with seven arguments costs 40 cycles.
fn schedule_edges(
    edges: u32,
    start: u32,
    (first, spacing): (u32, u32),
    tick: u32,
    forward: bool,
    runs: &mut Runs,
) {
    let half_a_cycle = 1 << (TIME_BITS - 1);
    let mut time = (start << TIME_BITS) + half_a_cycle + first;
    let latest = tick - GUARD;
    let runs_of = RunsOf::new(forward);
    let mut runs = runs.append();
    // Only the first edge may come too early, and only the last too late, as half a step is longer than the guard.
    let mut end = (time >> TIME_BITS).min(latest).max(start + GUARD);
    let mut last = runs_of.run(1, end - start);
    let mut left = edges - 1;
    while left > CHUNK {
        left -= CHUNK;
        time += spacing << CHUNK_BITS;
        let begin = end;
        end = time >> TIME_BITS;
        let cycles = end - begin;
        last = chunk(
            runs_of,
            CHUNK,
            cycles >> CHUNK_BITS,
            cycles % CHUNK,
            last,
            &mut runs,
        );
    }
    if left > 0 {
        time += left * spacing;
        let begin = end;
        end = (time >> TIME_BITS).min(latest);
        let (period, slower) = split(end - begin, left, spacing >> TIME_BITS);
        last = chunk(runs_of, left, period, slower, last, &mut runs);
    }
    runs.push(last);
    runs.push(runs_of.run(0, tick - end));
    runs.finish();
}

/// Shorter period of `edges` edges in `cycles`, and the number of edges whose period is a cycle longer.
///
/// The period is close to `near`; rounding and the guards move it slightly. A few corrections replace a division.
#[inline(always)]
fn split(cycles: u32, edges: u32, near: u32) -> (u32, u32) {
    let (mut period, edges) = (near, edges as i32);
    let mut slower = cycles as i32 - period as i32 * edges;
    while slower < 0 {
        slower += edges;
        period -= 1;
    }
    while slower >= edges {
        slower -= edges;
        period += 1;
    }
    (period, slower as u32)
}

/// Appends `edges` edges of a `period`, `slower` of them a cycle longer, after the run `last`, which may still grow.
///
/// Edges that continue `last` come first. Returns the run that may grow now.
#[inline(always)]
fn chunk(
    runs_of: RunsOf,
    edges: u32,
    period: u32,
    slower: u32,
    last: Run,
    runs: &mut Appending<'_>,
) -> Run {
    let short = runs_of.run(edges - slower, period);
    let long = runs_of.run(slower, period + 1);
    let (grown, next) = if last.goes_on_with(short) {
        (last.lengthened(edges - slower), long)
    } else if slower > 0 && last.goes_on_with(long) {
        (last.lengthened(slower), short)
    } else {
        runs.push(last);
        (short, long)
    };
    if slower == 0 {
        return grown;
    }
    runs.push(grown);
    next
}

fn append(run: Run, runs: &mut Runs) {
    // Checked settings keep to MAX_EDGES, for which MAX_RUNS are enough.
    let pushed = runs.push(run);
    debug_assert!(pushed, "more runs than a tick holds");
}

#[cfg(test)]
mod tests;
