//! The input of a drive that takes pulses: it counts rising edges of STEP, up or down as DIR has it.

use cophase_core::pulse::Runs;

/// Levels of STEP and DIR, and the count.
#[derive(Clone, Debug)]
pub struct PulseCounter {
    step_high: bool,
    /// Level of DIR, in the axis's own sense.
    forward: bool,
    counted: i64,
}

impl PulseCounter {
    /// At power-up: STEP low, DIR forward, nothing counted.
    pub const fn new() -> Self {
        Self {
            step_high: false,
            forward: true,
            counted: 0,
        }
    }

    /// Edges counted since power-up, in the axis's own sense.
    pub const fn counted(&self) -> i64 {
        self.counted
    }

    /// Counts the rising edges of a tick, with the sign of DIR, which only pauses turn; how many those are.
    pub fn count(&mut self, runs: &Runs) -> i64 {
        let before = self.counted;
        for run in runs {
            if run.is_pause() {
                self.forward = run.forward();
            }
            let rises = i64::from(run.edges() + u32::from(!self.step_high)) / 2;
            self.step_high ^= run.edges() % 2 == 1;
            self.counted += if self.forward { rises } else { -rises };
        }
        self.counted - before
    }

    /// Cycle of the rising edge in the tick counted last after which `beyond` more came.
    pub fn cycle_before(&self, runs: &Runs, beyond: i64) -> u32 {
        let mut high = self.step_high;
        let mut end: u32 = runs.iter().map(|run| run.cycles()).sum();
        let mut left = beyond;
        for run in runs.iter().rev() {
            for _ in 0..run.edges() {
                if high {
                    if left == 0 {
                        return end;
                    }
                    left -= 1;
                }
                high = !high;
                end -= run.period();
            }
            if run.is_pause() {
                end -= run.period();
            }
        }
        // A slip, not an edge, took the crank past its index: it passed at some time in the tick.
        end
    }
}
