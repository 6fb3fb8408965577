//! The flag on a crank that its index sensor detects: its edges, and when a moving crank brings them to the sensor.
//!
//! A flag without a length is a point, which the sensor detects in forward motion only. A flag with a length is detected at its start
//! in forward motion, and at its end in backward motion. Noise moves each edge from turn to turn. Within one turn an edge has one
//! position, however often the crank reverses there.
//!
//! A crank has *passed* an edge if it is at the edge or beyond it. That depends on its position alone. It meets an edge in the tick in
//! which that changes, so in exactly one, wherever ticks begin and end.

use cophase_core::settings::AxisSettings;
use cophase_scene::file::Noise;

use super::{Sensor, Stream};

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
    /// Pulses without a flag that begin in this tick. If there are several, each further one begins a tick later.
    begins: Vec<Extra>,
    /// Positions of the next pulses without a flag, turns, and the number of pulses left of each kind.
    again: Vec<(f64, u32)>,
    /// Interval in which the crank meets no edge. It avoids rounding to whole turns in most ticks, which is slow.
    clear: (f64, f64),
}

/// Empty interval.
const NOWHERE: (f64, f64) = (0.0, 0.0);

/// Rounding error of positions, turns, after a month at 200 rev/s.
const ROUNDING: f64 = 1e-6;

impl Flag {
    /// Creates the flag of axis `number`; none if it has no sensor. A crank that no torque moves, moves by whole steps.
    pub fn new(
        axis: &AxisSettings,
        noise: &Noise,
        number: usize,
        moves_by_torque: bool,
    ) -> Option<Self> {
        let stream = |sensor| Stream::new(noise.seed, sensor, number, noise.index_deg / 360.0);
        let start_turns = axis.index_turns?;
        let mut width_turns = axis.index_width_turns;
        if width_turns > 0.0 && !moves_by_torque {
            // By whole steps there is no time between two edges in the same step.
            width_turns = width_turns.max(axis.steps_per_crank_turn().turns_of(1.0));
        }
        let end_turns = start_turns + width_turns;
        Some(Self {
            start: Edge::new(start_turns, stream(Sensor::FlagStart)),
            end: Edge::new(end_turns, stream(Sensor::FlagEnd)),
            begins: Vec::new(),
            again: Vec::new(),
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
        self.start.passed(turns) > self.end.passed(turns)
    }

    /// Adds pulses that no flag causes, from the next played tick on.
    pub fn add(&mut self, extra: Extra) {
        self.begins.push(extra);
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
        self.clear = if !(self.again.is_empty() && self.begins.is_empty()) {
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
        let start = self.start.met(before, after);
        if !self.has_length() {
            return Met {
                rise: start.filter(|_| forward),
                ..Met::default()
            };
        }
        let end = self.end.met(before, after);
        let (rise, fall) = if forward { (start, end) } else { (end, start) };
        Met {
            rise,
            fall,
            extra: None,
        }
    }

    fn extra(&mut self, before: f64, after: f64) -> Option<f64> {
        if let Some(extra) = self.begins.pop() {
            if extra.count > 1 {
                let place = before + extra.part * (after - before);
                self.again.push((place + 1.0, extra.count - 1));
            }
            return Some(extra.part);
        }
        let due = self.again.iter().position(|(place, _)| *place <= after)?;
        let (place, left) = self.again.swap_remove(due);
        if left > 1 {
            self.again.push((place + 1.0, left - 1));
        }
        // It is before this tick if another one came in its own.
        Some(((place - before) / (after - before)).max(0.0))
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

    /// Returns the number of the last turn whose edge a crank at this position has passed.
    fn passed(&self, turns: f64) -> f64 {
        // Noise and rounding move an edge by less than a turn.
        let mut turn = (turns - self.nominal).floor() + 1.0;
        while self.place(turn) > turns {
            turn -= 1.0;
        }
        turn
    }

    /// Returns the position of the edge that a crank meets on its way, if it meets one.
    fn met(&self, before: f64, after: f64) -> Option<f64> {
        let (before, after) = (self.passed(before), self.passed(after));
        (before != after).then(|| self.place(before.max(after)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flag(start_turns: f64, width_turns: f64) -> Flag {
        Flag {
            start: Edge::new(start_turns, None),
            end: Edge::new(start_turns + width_turns, None),
            begins: Vec::new(),
            again: Vec::new(),
            clear: NOWHERE,
        }
    }

    /// Moves a crank through `places`, each of which begins and ends ticks. Returns the level of the line of a flag with a length, after
    /// it has checked that rises and falls alternate.
    fn level_after(flag: &mut Flag, places: &[f64], case: &str) -> bool {
        let mut level = flag.is_over(places[0]);
        for pair in places.windows(2) {
            let met = flag.meet(pair[0], pair[1]).unwrap_or_default();
            let rises_twice = level && met.rise.is_some();
            let falls_twice = !level && met.fall.is_some() && met.rise.is_none();
            assert!(
                !rises_twice && !falls_twice,
                "{case}: an edge is met twice, {pair:?}"
            );
            level = (level || met.rise.is_some()) && met.fall.is_none();
        }
        level
    }

    /// If this fails, a fault that adds pulses to an index ends those of another one there.
    #[test]
    fn pulses_of_two_faults_on_one_index_all_come() {
        let mut flag = flag(0.5, 0.0);
        let mut extras = Vec::new();
        for tick in 0..50 {
            if tick == 3 || tick == 8 {
                flag.add(Extra {
                    part: 0.5,
                    count: 3,
                });
            }
            let turns = |tick: i32| f64::from(tick) * 0.1;
            let met = flag.meet(turns(tick), turns(tick + 1)).unwrap_or_default();
            extras.extend(met.extra.map(|_| tick));
        }
        assert_eq!(extras, [3, 8, 13, 18, 23, 28]);
    }

    /// If this fails, an edge on a whole step is met in neither of two ticks, or in both. A working sensor is then reported as faulty.
    ///
    /// The judge knows only that a crank well inside the flag is over it, and one well outside is not.
    #[test]
    fn every_edge_is_met_once_whatever_steps_widths_and_directions() {
        // Steps per turn, some of them behind a gear: 57:11, 50:17 and 20:36.
        let geared = |steps: f64, motor: f64, crank: f64| steps * motor / crank;
        let counts = [
            24.0,
            200.0,
            400.0,
            1000.0,
            3200.0,
            6400.0,
            10_000.0,
            25_600.0,
            102_400.0,
            geared(3200.0, 57.0, 11.0),
            geared(400.0, 50.0, 17.0),
            geared(6400.0, 20.0, 36.0),
        ];
        for steps in counts {
            for half_degrees in (0..720).step_by(7) {
                for width in [0.5, 1.0, 3.0, 6.0, 7.5, 9.0, 18.0, 33.3, 45.0, 90.0, 120.0] {
                    for turn in [0.0, 1.0, -3.0, 1e5] {
                        let start = f64::from(half_degrees) / 720.0;
                        let mut flag = flag(start, width / 360.0);
                        let case = format!("{steps} steps, flag at {start} turns, {width}° long");
                        for edge in [start, start + width / 360.0] {
                            let at = ((turn + edge) * steps).round();
                            // Steps around the edge, and between two of them the places next to the edge itself.
                            let near = (-2..=2).map(|step| (at + f64::from(step)) / steps);
                            let exact = turn + edge;
                            let next = [exact.next_down(), exact, exact.next_up()];
                            let mut places: Vec<f64> = near.chain(next).collect();
                            places.sort_by(f64::total_cmp);
                            let inside = |sign: f64| exact + sign * 0.2 * width / 360.0;
                            let (low, high) = (inside(-1.0), inside(1.0));
                            places.retain(|&place| low < place && place < high);
                            let is_start = edge == start;
                            // Forward and back over the edge, turning round in every place, and standing there.
                            for &reversal in &places {
                                let up = places.iter().copied().filter(|&place| place <= reversal);
                                let there: Vec<f64> = [low].into_iter().chain(up).collect();
                                let back = there.iter().rev().copied();
                                let path: Vec<f64> = there.iter().copied().chain(back).collect();
                                let level = level_after(&mut flag, &path, &case);
                                assert_eq!(level, !is_start, "{case}: back from {reversal}");
                            }
                            let over: Vec<f64> =
                                [low].into_iter().chain(places).chain([high]).collect();
                            let level = level_after(&mut flag, &over, &case);
                            assert_eq!(level, is_start, "{case}: forward over {exact}");
                            let back: Vec<f64> = over.into_iter().rev().collect();
                            let level = level_after(&mut flag, &back, &case);
                            assert_eq!(level, !is_start, "{case}: back over {exact}");
                        }
                    }
                }
            }
        }
    }

    /// If this fails, a flag without a length is missed, or detected twice, where its place is on a whole step.
    #[test]
    fn a_flag_without_a_length_rises_once_per_forward_passage() {
        for steps in [200.0, 3200.0, 102_400.0, 3200.0 * 57.0 / 11.0] {
            for degrees in 0..360 {
                let start = f64::from(degrees) / 360.0;
                let mut flag = flag(start, 0.0);
                let at = (start * steps).round();
                let there: Vec<f64> = (-2..=2)
                    .map(|step| (at + f64::from(step)) / steps)
                    .collect();
                for _ in 0..2 {
                    let rises = |places: &[f64], flag: &mut Flag| {
                        let met = places.windows(2).map(|pair| flag.meet(pair[0], pair[1]));
                        met.flatten().filter(|met| met.rise.is_some()).count()
                    };
                    assert_eq!(rises(&there, &mut flag), 1, "{steps} steps, {degrees}°");
                    let back: Vec<f64> = there.iter().rev().copied().collect();
                    assert_eq!(rises(&back, &mut flag), 0, "{steps} steps, {degrees}°");
                }
            }
        }
    }

    /// If this fails, a sensor at power-up may be on the wrong side of an edge that the crank stands close to, within the noise. The
    /// next flag then does not rise, and a working sensor is reported as faulty.
    #[test]
    fn the_flag_state_at_rest_agrees_with_its_edges() {
        for seed in 0..50 {
            let noise = |sensor| Stream::new(seed, sensor, 0, 0.05 / 360.0);
            let mut flag = Flag {
                start: Edge::new(0.3, noise(Sensor::FlagStart)),
                end: Edge::new(0.3 + 6.0 / 360.0, noise(Sensor::FlagEnd)),
                begins: Vec::new(),
                again: Vec::new(),
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
