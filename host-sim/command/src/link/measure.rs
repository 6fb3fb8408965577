//! Measurement of one crank in bring-up: its turns, by its index sensor, against those that are commanded.
//!
//! A *reading* is a sample of the controller: the commanded turns of the crank, and the number of index pulses so far. A pulse lies between
//! two readings, so its place has bounds, and so has the *period*: the commanded turns from one pulse to the next. With the right settings
//! it is 1. All bounds follow from the readings, so that nothing is assumed of the line's speed, and a lost sample only widens them.

use std::fmt;

/// Commanded turns after which a measurement ends, whatever it has found. A period of up to half of that is measured.
pub(super) const MAX_TURNS: f64 = 20.0;

/// Commanded turns from the first pulse on that a measurement covers at least.
const MIN_TURNS: f64 = 3.0;

/// Ticks by which the commanded turns of a sample are ahead of its pulses. While the speed is constant, this changes nothing.
const LEAD_TICKS: f64 = 2.0;

/// Largest numerator and denominator of a ratio that is named.
const MAX_TERM: u32 = 1000;

/// Reading of the crank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    /// Control ticks since power-up.
    pub(super) tick: u32,
    /// Commanded turns.
    pub(super) turns: f64,
    /// Commanded steps.
    pub(super) steps: i64,
    /// Index pulses so far, wrapping.
    pub(super) index_count: u8,
}

/// Bounds of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bounds {
    min: f64,
    max: f64,
}

/// Measurement that takes readings in the order of their time.
#[derive(Debug, Default)]
pub(super) struct Measurement {
    first: Option<Reading>,
    last: Option<Reading>,
    /// Commanded turns at each pulse.
    pulses: Vec<Bounds>,
    /// Largest speed, turns a tick.
    max_speed: f64,
}

/// Result of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Finding {
    /// Fewer than two pulses came.
    TooFewPulses {
        /// Number of pulses.
        pulses: usize,
        /// Commanded turns.
        turns: f64,
    },
    /// The distances between pulses contradict each other.
    Uneven {
        /// Distances from pulse to pulse, turns.
        distances: Vec<f64>,
    },
    /// The crank makes a turn each time that these turns are commanded.
    Period {
        /// Commanded turns per pulse, as the simplest fraction within the bounds.
        ratio: (u32, u32),
        /// Largest relative error of the period.
        error: f64,
        /// Steps of a turn, by the settings.
        steps_per_turn: f64,
    },
}

impl Measurement {
    /// Takes in a reading. Returns true if the measurement is over.
    pub(super) fn take(&mut self, reading: Reading) -> bool {
        let first = *self.first.get_or_insert(reading);
        if let Some(last) = self.last.replace(reading) {
            let ticks = f64::from(reading.tick.wrapping_sub(last.tick)).max(1.0);
            let speed = (reading.turns - last.turns).abs() / ticks;
            self.max_speed = self.max_speed.max(speed);
            let place = Bounds {
                min: last.turns,
                max: reading.turns,
            };
            let pulses = reading.index_count.wrapping_sub(last.index_count);
            self.pulses.extend((0..pulses).map(|_| place));
        }
        let since = |turns: f64| reading.turns - turns;
        let is_measured = self.pulses.len() >= 2 && since(self.pulses[0].max) >= MIN_TURNS;
        is_measured || since(first.turns) >= MAX_TURNS
    }

    /// Evaluates the readings.
    pub(super) fn finding(&self) -> Finding {
        let (Some(first), Some(last)) = (self.first, self.last) else {
            return Finding::TooFewPulses {
                pulses: 0,
                turns: 0.0,
            };
        };
        let turns = last.turns - first.turns;
        let Some(period) = self.period() else {
            let pulses = self.pulses.len();
            return Finding::TooFewPulses { pulses, turns };
        };
        if period.min > period.max {
            let middle = |place: &Bounds| (place.min + place.max) / 2.0;
            let pairs = self.pulses.windows(2);
            let distances = pairs.map(|pair| middle(&pair[1]) - middle(&pair[0]));
            return Finding::Uneven {
                distances: distances.collect(),
            };
        }
        let steps = (last.steps - first.steps) as f64;
        Finding::Period {
            ratio: simplest(period),
            error: (period.max - period.min) / (period.max + period.min),
            steps_per_turn: (steps / turns).abs(),
        }
    }

    /// Returns the bounds that all pairs of pulses leave to the period; none if there is no pair.
    fn period(&self) -> Option<Bounds> {
        let lead = LEAD_TICKS * self.max_speed;
        let mut period = Bounds {
            min: 0.0,
            max: f64::INFINITY,
        };
        for (i, from) in self.pulses.iter().enumerate() {
            for (apart, to) in (1_u32..).zip(&self.pulses[i + 1..]) {
                let apart = f64::from(apart);
                period.min = period.min.max((to.min - from.max - lead) / apart);
                period.max = period.max.min((to.max - from.min + lead) / apart);
            }
        }
        (self.pulses.len() >= 2).then_some(period)
    }
}

/// Returns the fraction with the smallest terms within bounds, by a walk down the tree of Stern and Brocot.
fn simplest(bounds: Bounds) -> (u32, u32) {
    let (mut low, mut high) = ((0, 1), (1, 0));
    loop {
        let middle: (u32, u32) = (low.0 + high.0, low.1 + high.1);
        let value = f64::from(middle.0) / f64::from(middle.1);
        if middle.0.max(middle.1) >= MAX_TERM || (bounds.min..=bounds.max).contains(&value) {
            return middle;
        }
        if value < bounds.min {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Writes a fraction, or a whole number.
struct Times((u32, u32));

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            (over, 1) => write!(f, "{over}"),
            (over, under) => write!(f, "{over}/{under}"),
        }
    }
}

impl Finding {
    /// True if the crank turns as commanded.
    pub(super) fn is_right(&self) -> bool {
        matches!(self, Self::Period { ratio: (1, 1), .. })
    }

    /// Describes the finding on an axis, with its causes and what to do.
    pub(super) fn describe(&self, axis: u8) -> String {
        match self {
            Self::TooFewPulses { pulses, turns } => {
                let came = match pulses {
                    0 => "no index pulse",
                    _ => "only one index pulse",
                };
                format!(
                    "axis {axis}: {came} in {turns:.1} commanded turns.\n\
                     Watch the crank. If it stands, its drive is off, is not wired, or has too little current. If it turns, its sensor is not\n\
                     at INDEX {axis}, never sees the flag, or has the other active level: see `cophase link bring-up inputs`.\n"
                )
            }
            Self::Uneven { distances } => {
                let list: Vec<_> = distances.iter().map(|d| format!("{d:.3}")).collect();
                format!(
                    "axis {axis}: index pulses come at unequal distances, after {} commanded turns.\n\
                     The sensor sees a second flag or magnet, its line picks up noise, or the crank slips or loses steps.\n",
                    list.join(", ")
                )
            }
            Self::Period {
                ratio: (1, 1),
                error,
                steps_per_turn,
            } => format!(
                "axis {axis}: {steps_per_turn:.0} steps from index to index, as the settings say (measured to {}).\n",
                percent(*error)
            ),
            Self::Period {
                ratio,
                error,
                steps_per_turn,
            } => wrong_ratio(axis, *ratio, *error, *steps_per_turn),
        }
    }
}

fn percent(error: f64) -> String {
    format!("{:.2} %", error * 100.0)
}

fn wrong_ratio(axis: u8, ratio: (u32, u32), error: f64, steps_per_turn: f64) -> String {
    let (over, under) = ratio;
    let (times, inverse) = (Times(ratio), Times((under, over)));
    let measured = steps_per_turn * f64::from(over) / f64::from(under);
    let named = match ratio {
        (2, 1) => "half the steps".to_owned(),
        (1, 2) => "twice the steps".to_owned(),
        _ => format!("{inverse} of the steps"),
    };
    let flags = match ratio {
        (1, flags) => format!("- The sensor sees {flags} flags or magnets in a turn: leave one.\n"),
        _ => String::new(),
    };
    format!(
        "axis {axis}: {measured:.0} steps from index to index, {steps_per_turn:.0} in the settings (measured to {}): the drive makes {named}\n\
         that the settings say. One of these is the cause:\n\
         - Its microsteps: set its switches to {inverse} of their pulses per turn, or multiply `steps_per_turn` by {times}.\n\
         - A belt or gearbox that the settings do not state, of {over} motor turns to {under} of the crank: `gear = [{over}, {under}]`,\n  \
           times a gear that they state.\n{flags}",
        percent(error)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings every `every` ticks of a crank that makes a turn for each `period` commanded turns, at 1 turn in 2000 ticks.
    fn measured(period: f64, every: u32, pulses: impl Fn(f64) -> f64) -> Finding {
        let mut measurement = Measurement::default();
        for tick in (0_u32..).step_by(every as usize) {
            let turns = f64::from(tick) / 2000.0;
            // The pulses of a sample lag by two ticks; the first comes at 0.3 turns of the crank.
            let passed = pulses((turns - 0.001) / period + 0.7).floor();
            let is_over = measurement.take(Reading {
                tick,
                turns,
                steps: (turns * 3200.0) as i64,
                index_count: (250.0 + passed) as u64 as u8,
            });
            if is_over {
                break;
            }
        }
        measurement.finding()
    }

    /// If this fails, bring-up names another ratio than the drive or the gear has.
    #[test]
    fn the_ratio_of_microsteps_or_of_a_gear_is_named() {
        let ratios = [
            (1, 1),
            (1, 2),
            (2, 1),
            (1, 4),
            (4, 1),
            (1, 8),
            (8, 1),
            (5, 8),
            (8, 5),
            (57, 11),
            (50, 17),
            (36, 20),
            (20, 36),
            (3, 1),
        ];
        for (over, under) in ratios {
            let period = f64::from(over) / f64::from(under);
            for every in [1, 2, 4] {
                let Finding::Period { ratio, error, .. } = measured(period, every, |turns| turns)
                else {
                    panic!("{over}/{under} every {every}");
                };
                assert_eq!(
                    ratio.0 * under,
                    ratio.1 * over,
                    "{over}/{under} every {every}"
                );
                assert!(error < 0.005, "{error}");
            }
        }
    }

    #[test]
    fn missing_and_uneven_pulses_are_no_ratio() {
        let none = measured(1.0, 2, |_| 0.0);
        assert!(matches!(none, Finding::TooFewPulses { pulses: 0, turns } if turns >= MAX_TURNS));
        // A second magnet a third of a turn after the first.
        let two = measured(1.0, 2, |turns| turns.floor() + (turns + 2.0 / 3.0).floor());
        assert!(matches!(two, Finding::Uneven { .. }), "{two:?}");
        assert!(!none.is_right() && !two.is_right());
    }

    #[test]
    fn a_wrong_ratio_is_reported_with_both_causes() {
        let text = measured(2.0, 2, |turns| turns).describe(1);
        for words in [
            "axis 1: 6400 steps from index to index, 3200 in the settings",
            "the drive makes half the steps",
            "multiply `steps_per_turn` by 2",
            "`gear = [2, 1]`",
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
        let twice = measured(0.5, 2, |turns| turns).describe(0);
        assert!(
            twice.contains("twice the steps") && twice.contains("2 flags"),
            "{twice}"
        );
    }
}
