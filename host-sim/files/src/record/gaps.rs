//! Samples that were lost.

use serde::Serialize;

/// Number of gaps that are kept with their times. Further gaps are only counted.
const MAX: usize = 1000;

/// Consecutive samples that were lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Gap {
    /// Tick of the first one.
    pub from_tick: u32,
    /// Their number.
    pub samples: u32,
}

/// Received and lost samples between the first and the last received one.
#[derive(Clone, Debug, Serialize)]
pub struct Gaps {
    /// Number of received samples.
    pub recorded: u64,
    /// Number of lost samples.
    pub lost: u64,
    /// Number of gaps.
    pub gaps: u64,
    /// The first thousand gaps.
    pub list: Vec<Gap>,
    /// Ticks of the first and the last received sample.
    #[serde(skip)]
    pub ticks: Option<(u32, u32)>,
    #[serde(skip)]
    every: u32,
}

impl Gaps {
    pub(super) const fn new(every: u16) -> Self {
        Self {
            recorded: 0,
            lost: 0,
            gaps: 0,
            list: Vec::new(),
            ticks: None,
            every: if every == 0 { 1 } else { every as u32 },
        }
    }

    /// Adds the tick of a sample. Returns the number of samples that were lost before it.
    pub(super) fn push(&mut self, tick: u32) -> u32 {
        let due = |(_, last): (u32, u32)| last.wrapping_add(self.every);
        let from_tick = self.ticks.map_or(tick, due);
        let samples = tick.wrapping_sub(from_tick) / self.every;
        self.ticks = Some((self.ticks.map_or(tick, |(first, _)| first), tick));
        self.recorded += 1;
        if samples > 0 {
            self.lost += u64::from(samples);
            self.gaps += 1;
            if self.list.len() < MAX {
                self.list.push(Gap { from_tick, samples });
            }
        }
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lost_sample_is_counted_once() {
        let mut gaps = Gaps::new(5);
        let lost: Vec<u32> = [10, 15, 35, 40, 50].map(|tick| gaps.push(tick)).into();
        assert_eq!(lost, [0, 0, 3, 0, 1]);
        assert_eq!((gaps.recorded, gaps.lost, gaps.gaps), (5, 4, 2));
        assert_eq!(gaps.ticks, Some((10, 50)));
        let (first, second) = (gaps.list[0], gaps.list[1]);
        assert_eq!((first.from_tick, first.samples), (20, 3));
        assert_eq!((second.from_tick, second.samples), (45, 1));
    }
}
