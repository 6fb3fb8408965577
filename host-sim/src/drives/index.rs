//! An index sensor between the crank and the loop. Its line rises when the flag arrives and falls when it leaves, later by the
//! sensor's delay. The loop detects the pulses that pass the core's filter.

use std::collections::VecDeque;

use cophase_core::monitor::IndexFilter;
use cophase_core::monitor::{IndexPulse, IndexPulses};
use cophase_core::units::PerAxis;

use super::Stream;

/// Divisor of a tick that limits how far noise may put a line ahead of its flag: one quarter. The filter reports a pulse no
/// further back than that.
const MAX_TICK_SHARE: u32 = 4;

/// Events at a sensor in a tick, with their times in cycles from the beginning of the tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passed {
    /// Time at which the flag arrives.
    pub rise: Option<u32>,
    /// Time at which the flag leaves. A flag without a length has none: its line falls after a fixed time.
    pub fall: Option<u32>,
    /// Time of a pulse without a flag.
    pub extra: Option<u32>,
}

impl Passed {
    /// Returns a passage that has only this rise, or none.
    pub const fn rising(rise: Option<u32>) -> Self {
        Self {
            rise,
            fall: None,
            extra: None,
        }
    }
}

/// Events at the sensors of all axes in a tick; most ticks have none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Passages {
    /// Axes for which [`Self::passed`] holds an entry, one bit each.
    brought: u8,
    passed: PerAxis<Passed>,
}

impl Passages {
    /// Records the events at the sensor of an axis.
    #[inline]
    pub fn put(&mut self, axis: usize, passed: Option<Passed>) {
        match passed {
            None => self.brought &= !(1 << axis),
            Some(passed) => {
                self.brought |= 1 << axis;
                self.passed[axis] = passed;
            }
        }
    }

    /// Axes whose sensors have events, one bit each.
    pub const fn brought(&self) -> u8 {
        self.brought
    }

    /// Events at the sensor of an axis, if there are any.
    #[inline]
    pub fn get(&self, axis: usize) -> Option<Passed> {
        (self.brought >> axis & 1 == 1).then(|| self.passed[axis])
    }
}

/// Changes of an index line in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Line {
    /// Cycle at which the line first rose, if it did.
    pub rose: Option<u32>,
    /// Cycle at which the line last fell, if it did.
    pub fell: Option<u32>,
    /// Pulse that the loop detects, if any.
    pub pulse: Option<IndexPulse>,
}

/// One index line with its filter.
#[derive(Clone, Debug)]
pub struct IndexSensor {
    filter: IndexFilter<1>,
    high_cycles: u32,
    has_length: bool,
    delay_cycles: i64,
    time: Option<Stream>,
    /// Number of edges of the flag so far. It selects the noise of the next edge.
    edges: i64,
    /// Pending changes of the line, in order: cycles from the beginning of the present tick, and the level.
    changes: VecDeque<(i64, bool)>,
    /// True if the sensor misses the flag that is in front of it.
    blind: bool,
    /// Level of the line at the end of the last tick.
    is_high: bool,
}

impl IndexSensor {
    /// Creates the sensor of a flag that passes in `high_cycles`, with a filter of `width` cycles.
    pub fn new(width: u32, high_cycles: u32) -> Self {
        Self {
            filter: IndexFilter::new(width, 1, 0),
            high_cycles,
            has_length: false,
            delay_cycles: 0,
            time: None,
            edges: 0,
            changes: VecDeque::new(),
            blind: false,
            is_high: false,
        }
    }

    /// Converts the sensor to one of a flag with a length. `is_over` is true if the flag is now in front of it.
    #[must_use]
    pub fn of_length(mut self, width: u32, is_over: bool) -> Self {
        self.filter = IndexFilter::new(width, 1, is_over.into());
        self.has_length = true;
        self.is_high = is_over;
        self
    }

    /// Delays the changes of the line by `cycles`, with noise on the delay, in cycles.
    #[must_use]
    pub fn delayed(mut self, cycles: u32, noise: Option<Stream>) -> Self {
        self.delay_cycles = i64::from(cycles);
        self.time = noise;
        self
    }

    /// Plays one tick of `cycles`. `missed` is called once for each flag that arrives, and returns true if the sensor misses it.
    pub fn tick(&mut self, passed: Passed, cycles: u32, mut missed: impl FnMut() -> bool) -> Line {
        // With a short flag, or a crank that reverses on it, the end may come first.
        if passed.fall < passed.rise {
            self.fall(passed.fall, cycles);
        }
        if let Some(rise) = passed.rise {
            self.blind = missed();
            if !self.blind {
                let at = self.late(rise, cycles);
                self.rise_at(at);
                if !self.has_length {
                    self.changes
                        .push_back((at + i64::from(self.high_cycles), false));
                }
            }
        }
        if passed.fall >= passed.rise {
            self.fall(passed.fall, cycles);
        }
        if let Some(extra) = passed.extra {
            let at = i64::from(extra);
            self.rise_at(at);
            self.changes
                .push_back((at + i64::from(self.high_cycles), false));
        }
        let (mut rose, mut fell) = (None, None);
        // A rise exactly at the end belongs to this tick, and a fall there to the next.
        while let Some((at, level)) = self.changes.pop_front_if(|(at, level)| {
            *at < i64::from(cycles) || (*level && *at == i64::from(cycles))
        }) {
            self.filter.change(at as i32, level.into());
            self.is_high = level;
            let at = at.max(0) as u32;
            if level {
                rose = rose.or(Some(at));
            } else {
                fell = Some(at);
            }
        }
        for (at, _) in &mut self.changes {
            *at -= i64::from(cycles);
        }
        let mut pulses = IndexPulses::NONE;
        self.filter.end_tick(cycles, &mut pulses);
        Line {
            rose,
            fell,
            pulse: pulses.of(0),
        }
    }

    /// True if a tick without events changes nothing, and need not be played.
    pub fn is_quiet(&self) -> bool {
        self.changes.is_empty() && !self.filter.is_pending()
    }

    /// Level of the line at the end of the last tick.
    pub const fn is_high(&self) -> bool {
        self.is_high
    }

    fn fall(&mut self, fall: Option<u32>, cycles: u32) {
        let Some(fall) = fall else { return };
        if std::mem::take(&mut self.blind) {
            return;
        }
        let at = self.late(fall, cycles);
        self.push(at, false);
    }

    /// Adds a rise. A line that is already high stays high.
    fn rise_at(&mut self, at: i64) {
        while self
            .changes
            .pop_back_if(|(last, level)| !*level && *last >= at)
            .is_some()
        {}
        self.push(at, true);
    }

    fn push(&mut self, at: i64, level: bool) {
        let last = self.changes.back().map_or(at, |(last, _)| *last);
        self.changes.push_back((at.max(last), level));
    }

    /// Returns the time at which the line follows its flag. No line is ahead of its flag by more than the filter can still report
    /// for the tick before.
    fn late(&mut self, cycle: u32, cycles: u32) -> i64 {
        let noise = self.time.as_ref().map_or(0.0, |time| time.draw(self.edges));
        self.edges += 1;
        let at = i64::from(cycle) + self.delay_cycles + noise.round() as i64;
        at.max(-i64::from(cycles / MAX_TICK_SHARE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(sensor: &mut IndexSensor, passed: Passed) -> Option<IndexPulse> {
        sensor.tick(passed, 1000, || false).pulse
    }

    const fn edge(cycle: i32) -> Option<IndexPulse> {
        Some(IndexPulse { cycle })
    }

    /// If this fails, passages near the end of a tick are reported twice or at the wrong time, and the phase error is wrong.
    #[test]
    fn a_passage_is_reported_once_wherever_the_tick_ends() {
        for rise in 0..=1000 {
            let mut sensor = IndexSensor::new(50, 120);
            let commanded = [Some(rise), None].map(|rise| tick(&mut sensor, Passed::rising(rise)));
            let expected = if rise <= 950 {
                [edge(rise as i32), None]
            } else {
                [None, edge(rise as i32 - 1000)]
            };
            assert_eq!(commanded, expected, "a rise at {rise}");
            // The next passage is detected as well.
            assert_eq!(tick(&mut sensor, Passed::rising(Some(500))), edge(500));
        }
    }

    /// If this fails, the pulse of a late line is reported at the time of its flag, or not at all if the line changes a tick
    /// later.
    #[test]
    fn a_line_delay_shifts_edges_across_ticks() {
        for delay in [0, 300, 1700] {
            let mut sensor = IndexSensor::new(50, 120).delayed(delay, None);
            let rises = [Some(600), None, None];
            let commanded = rises.map(|rise| tick(&mut sensor, Passed::rising(rise)));
            let mut expected = [None; 3];
            let at = 600 + delay as i32;
            expected[(at / 1000) as usize] = edge(at % 1000);
            assert_eq!(commanded, expected, "late by {delay}");
        }
    }

    /// If this fails, a flag in front of its sensor at power-up counts as a passage, or a flag that the sensor misses causes a
    /// pulse when it leaves.
    #[test]
    fn a_flag_with_a_length_is_detected_at_its_rising_edge() {
        let mut sensor = IndexSensor::new(50, 120).of_length(50, true);
        let at = |rise, fall| Passed {
            rise,
            fall,
            extra: None,
        };
        assert_eq!(tick(&mut sensor, at(None, Some(200))), None);
        assert_eq!(tick(&mut sensor, at(Some(300), None)), edge(300));
        assert_eq!(tick(&mut sensor, at(None, None)), None);
        assert_eq!(tick(&mut sensor, at(None, Some(100))), None);
        let blind = sensor.tick(at(Some(300), Some(700)), 1000, || true);
        assert_eq!((blind.rose, blind.pulse), (None, None));
        assert_eq!(tick(&mut sensor, at(Some(10), Some(400))), edge(10));
    }
}
