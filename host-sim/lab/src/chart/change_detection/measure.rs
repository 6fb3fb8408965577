//! Delays of alarms, and the load that causes none, by simulation.

use rayon::prelude::*;

use super::noise::{Errors, Noise};
use super::rules::{Rule, WINDOW};

/// Change of the phase error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// At once, by so many tolerances.
    Step(f64),
    /// By so many tolerances a turn.
    Drift(f64),
}

impl Change {
    /// All changes of the chart.
    pub const ALL: [Self; 7] = [
        Self::Step(0.5),
        Self::Step(1.0),
        Self::Step(2.0),
        Self::Step(4.0),
        Self::Drift(1e-2),
        Self::Drift(1e-3),
        Self::Drift(1e-4),
    ];

    /// Kind and size in the data.
    pub const fn kind_and_size(self) -> (&'static str, f64) {
        match self {
            Self::Step(size) => ("step", size),
            Self::Drift(size) => ("drift", size),
        }
    }

    /// Title of its panel.
    pub fn title(self) -> String {
        match self {
            Self::Step(size) => format!("step of {size} r"),
            Self::Drift(size) => format!("drift of {size} r a turn"),
        }
    }

    /// Phase error in turn `turn` of the change, from 1 on.
    fn at(self, turn: u32) -> f64 {
        match self {
            Self::Step(size) => size,
            Self::Drift(size) => size * f64::from(turn),
        }
    }

    /// Turns after which a change counts as not detected. A drift is beyond the gate and all noise by then.
    fn limit(self) -> u32 {
        match self {
            Self::Step(_) => 16_384,
            Self::Drift(size) => (5.0 / size) as u32 + 1000,
        }
    }
}

/// Share of runs that may end without an alarm. They count as detected at the limit.
const UNDETECTED: f64 = 0.01;

/// Returns the mean number of turns from a change to the alarm; `None` if it is often not detected. A run with an alarm before the change
/// does not count.
pub fn delay(rule: Rule, threshold: f64, noise: Noise, change: Change, runs: u64) -> Option<f64> {
    let limit = change.limit();
    let delays: Vec<_> = (0..runs)
        .into_par_iter()
        .filter_map(|run| {
            let mut errors = Errors::new(noise, run);
            let mut detector = rule.detector(threshold);
            // The change may come anywhere in a window.
            let lead = 2 * WINDOW + (errors.uniform() * WINDOW as f64) as usize;
            if (0..lead).any(|_| detector(errors.draw())) {
                return None;
            }
            let delay = (1..=limit).find(|&turn| detector(change.at(turn) + errors.draw()));
            Some(delay)
        })
        .collect();
    let late = delays.iter().filter(|delay| delay.is_none()).count();
    if delays.is_empty() || late as f64 > UNDETECTED * delays.len() as f64 {
        return None;
    }
    let sum: f64 = delays
        .iter()
        .map(|delay| f64::from(delay.unwrap_or(limit)))
        .sum();
    Some(sum / delays.len() as f64)
}

/// Load that comes and goes: turns in which it comes, and goes.
pub const RAMPS: [u32; 2] = [0, 1024];
/// Turns for which a load stays.
const STAYS: u32 = 1024;
/// Largest load that is tried, and the increment, tolerances.
pub const LOADS: (f64, f64) = (4.0, 0.125);

/// Returns the largest load, tolerances of phase error, that comes and goes `times` times without an alarm.
pub fn tolerated_load(rule: Rule, threshold: f64, noise: Noise, ramp: u32, times: u32) -> f64 {
    let period = 2 * (ramp + STAYS);
    let causes_alarm = |load: f64| {
        let mut errors = Errors::new(noise, 1);
        let mut detector = rule.detector(threshold);
        (0..times * period).any(|turn| {
            let turn = turn % period;
            // Away, coming, there, going.
            let part = match turn.checked_sub(STAYS) {
                None => 0.0,
                Some(turn) if turn < ramp => f64::from(turn) / f64::from(ramp),
                Some(turn) => match turn.checked_sub(ramp + STAYS) {
                    None => 1.0,
                    Some(turn) => 1.0 - f64::from(turn) / f64::from(ramp),
                },
            };
            detector(load * part + errors.draw())
        })
    };
    let count = (LOADS.0 / LOADS.1) as u32;
    let loads: Vec<_> = (1..=count).map(|i| f64::from(i) * LOADS.1).collect();
    let first = loads.iter().find(|&&load| causes_alarm(load));
    first.map_or(LOADS.0, |first| first - LOADS.1)
}
