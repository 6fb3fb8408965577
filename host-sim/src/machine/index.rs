//! An index sensor between the crank and the loop: the line rises as its flag comes and falls as it goes, later by the
//! sensor's delay, and the loop detects what the core's filter makes of that.

use std::collections::VecDeque;

use cophase_core::drift::{IndexFilter, IndexPulse};
use cophase_core::units::PerAxis;

use crate::faults::Stream;

/// How much of a tick a line may be ahead of its flag, by noise: one in four is as far back as the filter reports a pulse.
const MOST_OF_TICK: u32 = 4;

/// What comes before a sensor in a tick, and when: cycles from its beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passed {
    /// The flag comes.
    pub rise: Option<u32>,
    /// It goes. Of a flag without a length that is not said: the line falls by itself.
    pub fall: Option<u32>,
    /// A pulse comes without it.
    pub extra: Option<u32>,
}

impl Passed {
    /// The flag comes, or does not.
    pub const fn rising(rise: Option<u32>) -> Self {
        Self {
            rise,
            fall: None,
            extra: None,
        }
    }
}

/// What comes before the sensors of all axes in a tick; most ticks bring nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Passages {
    /// Axes of which [`Self::passed`] holds something, a bit each.
    brought: u8,
    passed: PerAxis<Passed>,
}

impl Passages {
    /// Puts down what came before the sensor of an axis.
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

    /// Axes before whose sensors something came, a bit each.
    pub const fn brought(&self) -> u8 {
        self.brought
    }

    /// What came before the sensor of an axis, if anything did.
    #[inline]
    pub fn get(&self, axis: usize) -> Option<Passed> {
        (self.brought >> axis & 1 == 1).then(|| self.passed[axis])
    }
}

/// What an index line did in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Line {
    /// The cycle at which it rose, if it did.
    pub rose: Option<u32>,
    /// What the loop detects.
    pub pulse: Option<IndexPulse>,
}

/// One index line with its filter.
#[derive(Clone, Debug)]
pub struct IndexSensor {
    filter: IndexFilter,
    high_cycles: u32,
    has_length: bool,
    delay_cycles: i64,
    time: Option<Stream>,
    /// Edges of the flag so far: the numbers of their noise.
    edges: i64,
    /// Changes to come, in order: cycles from the present tick's beginning.
    changes: VecDeque<(i64, bool)>,
    /// The flag that is before it is not seen.
    blind: bool,
}

impl IndexSensor {
    /// Of a flag that passes in `high_cycles`, through a filter of `width` cycles.
    pub fn new(width: u32, high_cycles: u32) -> Self {
        Self {
            filter: IndexFilter::new(width, false),
            high_cycles,
            has_length: false,
            delay_cycles: 0,
            time: None,
            edges: 0,
            changes: VecDeque::new(),
            blind: false,
        }
    }

    /// The same, of a flag with a length, which is before it now or is not.
    #[must_use]
    pub fn of_length(mut self, width: u32, is_over: bool) -> Self {
        self.filter = IndexFilter::new(width, is_over);
        self.has_length = true;
        self
    }

    /// The same, whose line changes so many cycles late, and with noise on that, in cycles.
    #[must_use]
    pub fn delayed(mut self, cycles: u32, noise: Option<Stream>) -> Self {
        self.delay_cycles = i64::from(cycles);
        self.time = noise;
        self
    }

    /// One tick of `cycles`. `missed` is asked once for each flag that comes: it may not be seen.
    pub fn tick(&mut self, passed: Passed, cycles: u32, mut missed: impl FnMut() -> bool) -> Line {
        // Of a short flag, or one on which the crank turns back, the end may come first.
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
        let mut rose = None;
        // A rise at the very end is of this tick, a fall there of the next.
        while let Some((at, level)) = self.changes.pop_front_if(|(at, level)| {
            *at < i64::from(cycles) || (*level && *at == i64::from(cycles))
        }) {
            self.filter.change(at as i32, level);
            if level {
                rose = rose.or(Some(at.max(0) as u32));
            }
        }
        for (at, _) in &mut self.changes {
            *at -= i64::from(cycles);
        }
        Line {
            rose,
            pulse: self.filter.end_tick(cycles),
        }
    }

    /// Whether a tick of `cycles` in which nothing comes before it changes nothing, and need not be played.
    pub fn is_quiet(&self, cycles: u32) -> bool {
        self.changes.is_empty() && self.filter.is_quiet(cycles)
    }

    fn fall(&mut self, fall: Option<u32>, cycles: u32) {
        let Some(fall) = fall else { return };
        if std::mem::take(&mut self.blind) {
            return;
        }
        let at = self.late(fall, cycles);
        self.push(at, false);
    }

    /// A rise while the line is high has it stay so.
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

    /// When the line follows. No line of a sensor is ahead of its flag by more than what can still be reported of the tick before.
    fn late(&mut self, cycle: u32, cycles: u32) -> i64 {
        let noise = self.time.as_ref().map_or(0.0, |time| time.draw(self.edges));
        self.edges += 1;
        let at = i64::from(cycle) + self.delay_cycles + noise.round() as i64;
        at.max(-i64::from(cycles / MOST_OF_TICK))
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

    /// Were a passage reported twice, or not at its edge, the phase error would be wrong where a tick ends.
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
            // And the next passage is detected.
            assert_eq!(tick(&mut sensor, Passed::rising(Some(500))), edge(500));
        }
    }

    /// Were it wrong, a late line would be reported at its flag's time, or not at all where that is a tick later.
    #[test]
    fn a_late_line_is_late_across_ticks() {
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

    /// Were it wrong, a flag that is before its sensor at power-up would be a passage, or one that is not seen would come as
    /// it goes.
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
