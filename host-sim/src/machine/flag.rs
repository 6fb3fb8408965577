//! The flag on a crank that its index sensor detects: its edges, and when a moving crank brings them to the sensor.
//!
//! A flag without a length is a point, which the sensor detects in forward motion only. A flag with a length is detected at its start
//! in forward motion, and at its end in backward motion. Noise moves each edge from turn to turn. Within one turn an edge has one
//! position, however often the crank reverses there.

use crate::faults::{Sensor, Stream};
use crate::scene::Checked;

/// Pulses of a sensor without a flag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extra {
    /// Fraction of the tick after which the first pulse comes.
    pub part: f64,
    /// Number of pulses, one turn of the crank apart.
    pub count: u32,
}

/// Events at a sensor in a tick. Positions are in turns since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Met {
    /// Position at which the flag arrives at the sensor.
    pub rise: Option<f64>,
    /// Position at which the flag leaves the sensor.
    pub fall: Option<f64>,
    /// Fraction of the tick after which a pulse without a flag comes.
    pub extra: Option<f64>,
}

/// A flag, and the noise of its edges.
#[derive(Clone, Debug)]
pub struct Flag {
    start: Edge,
    end: Edge,
    /// Pulses without a flag that begin in this tick.
    begins: Option<Extra>,
    /// Position of the next pulse without a flag, turns, and the number of pulses left.
    again: Option<(f64, u32)>,
    /// Interval in which the crank meets no edge. It avoids rounding to whole turns in most ticks, which is slow.
    clear: (f64, f64),
}

/// Empty interval.
const NOWHERE: (f64, f64) = (0.0, 0.0);

/// Rounding error of positions, turns, after a month at 200 rev/s.
const ROUNDING: f64 = 1e-6;

impl Flag {
    /// Creates the flag of axis `number` of a scene; none if it has no sensor.
    pub fn new(checked: &Checked, number: usize) -> Option<Self> {
        let axis = &checked.settings.axes[number];
        let noise = &checked.scene.noise;
        let stream = |sensor| Stream::new(noise.seed, sensor, number, noise.index_deg / 360.0);
        let start_turns = axis.index_turns?;
        let end_turns = start_turns + axis.index_width_turns;
        Some(Self {
            start: Edge::new(start_turns, stream(Sensor::FlagStart)),
            end: Edge::new(end_turns, stream(Sensor::FlagEnd)),
            begins: None,
            again: None,
            clear: NOWHERE,
        })
    }

    /// True if the flag has a length, and so an end that the sensor detects.
    pub fn has_length(&self) -> bool {
        self.end.nominal > self.start.nominal
    }

    /// True if the flag is in front of the sensor of a crank at rest at `turns`. The edges have the same noise as when the crank moves
    /// on.
    pub fn is_over(&self, turns: f64) -> bool {
        let turn = (turns - self.start.nominal).floor();
        [turn - 1.0, turn, turn + 1.0]
            .into_iter()
            .any(|turn| self.start.place(turn) <= turns && turns < self.end.place(turn))
    }

    /// Adds pulses that no flag causes, from the next played tick on.
    pub fn add(&mut self, extra: Extra) {
        self.begins = Some(extra);
        self.clear = NOWHERE;
    }

    /// Returns the events of a crank that moves from `before` to `after`, if there are any.
    #[inline]
    pub(super) fn meet(&mut self, before: f64, after: f64) -> Option<Met> {
        let (from, to) = self.clear;
        if from < before && before < to && from < after && after < to {
            return None;
        }
        self.find_edges(before, after)
    }

    #[inline(never)]
    fn find_edges(&mut self, before: f64, after: f64) -> Option<Met> {
        let mut met = self.pass(before, after);
        met.extra = self.extra(before, after);
        self.clear = if self.again.is_some() {
            NOWHERE
        } else {
            self.clear_around(after)
        };
        (met != Met::default()).then_some(met)
    }

    /// Returns an interval around `turns` that contains no edge, whatever its noise.
    fn clear_around(&self, turns: f64) -> (f64, f64) {
        let (from, to) = self.start.clear_around(turns);
        if !self.has_length() {
            return (from, to);
        }
        let end = self.end.clear_around(turns);
        (from.max(end.0), to.min(end.1))
    }

    fn pass(&self, before: f64, after: f64) -> Met {
        let forward = after > before;
        if !self.has_length() && self.start.noise.is_none() {
            let passes = (after - self.start.nominal).floor();
            let passed = passes > (before - self.start.nominal).floor();
            return Met {
                rise: passed.then_some(passes + self.start.nominal),
                ..Met::default()
            };
        }
        let start = self.start.between(before, after);
        if !self.has_length() {
            return Met {
                rise: start.filter(|_| forward),
                ..Met::default()
            };
        }
        let end = self.end.between(before, after);
        let (rise, fall) = if forward { (start, end) } else { (end, start) };
        Met {
            rise,
            fall,
            extra: None,
        }
    }

    fn extra(&mut self, before: f64, after: f64) -> Option<f64> {
        if let Some(extra) = self.begins.take() {
            let place = before + extra.part * (after - before);
            self.again = (extra.count > 1).then_some((place + 1.0, extra.count - 1));
            return Some(extra.part);
        }
        let (place, left) = self.again.filter(|(place, _)| *place <= after)?;
        self.again = (left > 1).then_some((place + 1.0, left - 1));
        Some((place - before) / (after - before))
    }
}

/// Edge of a flag, which a crank meets once a turn.
#[derive(Clone, Debug)]
struct Edge {
    /// Position without noise, turns.
    nominal: f64,
    noise: Option<Stream>,
    /// Largest deviation that the noise causes, turns.
    reach: f64,
}

impl Edge {
    fn new(nominal: f64, noise: Option<Stream>) -> Self {
        Self {
            nominal,
            reach: noise.as_ref().map_or(0.0, Stream::reach),
            noise,
        }
    }

    /// Returns the position of the edge in a turn, turns since power-up.
    fn place(&self, turn: f64) -> f64 {
        turn + self.nominal
            + self
                .noise
                .as_ref()
                .map_or(0.0, |noise| noise.draw(turn as i64))
    }

    /// Returns an interval around `turns` that does not contain the edge, whatever its noise.
    fn clear_around(&self, turns: f64) -> (f64, f64) {
        let turn = (turns - self.nominal).floor();
        let beyond = self.reach + ROUNDING;
        (
            turn + self.nominal + beyond,
            turn + 1.0 + self.nominal - beyond,
        )
    }

    /// Returns the position of the edge between two positions of the crank, if it lies there.
    fn between(&self, before: f64, after: f64) -> Option<f64> {
        let (low, high) = (before.min(after), before.max(after));
        let (mut turn, last) = (
            (low - self.nominal - self.reach).ceil(),
            (high - self.nominal + self.reach).floor(),
        );
        while turn <= last {
            let place = self.place(turn);
            if low < place && place <= high {
                return Some(place);
            }
            turn += 1.0;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a sensor at power-up may be on the wrong side of an edge that the crank stands close to, within the noise. The
    /// next flag then does not rise, and a working sensor is reported as faulty.
    #[test]
    fn the_flag_state_at_rest_agrees_with_its_edges() {
        for seed in 0..50 {
            let noise = |sensor| Stream::new(seed, sensor, 0, 0.05 / 360.0);
            let mut flag = Flag {
                start: Edge::new(0.3, noise(Sensor::FlagStart)),
                end: Edge::new(0.3 + 6.0 / 360.0, noise(Sensor::FlagEnd)),
                begins: None,
                again: None,
                clear: NOWHERE,
            };
            let mut is_over = flag.is_over(0.28);
            assert!(!is_over);
            // Back and forth over both edges, in steps of a fifth of the noise.
            let there = (0..2000).map(|step| 0.28 + f64::from(step) * 3e-5);
            let places: Vec<f64> = there.clone().chain(there.rev()).collect();
            for pair in places.windows(2) {
                let met = flag.meet(pair[0], pair[1]).unwrap_or_default();
                is_over = (is_over || met.rise.is_some()) && met.fall.is_none();
                assert_eq!(is_over, flag.is_over(pair[1]), "seed {seed}, {pair:?}");
            }
        }
    }
}
