//! A run, as its cranks and lines were at every tick.

use cophase_core::signals::Feedback;
use host_sim::scene::Checked;
use host_sim::sim::{Moment, Observer, Outcome, simulate};

/// One tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Its number by the clock.
    pub tick: u64,
    /// Where cranks were told to be at its end, and where they were, turns.
    pub command: Vec<f64>,
    pub actual: Vec<f64>,
    /// When index lines rose, µs since power-up.
    pub rose_us: Vec<Option<f64>>,
    /// What encoders would read.
    pub encoder: Vec<i32>,
    /// Whether the drives were on.
    pub enabled: bool,
}

/// A run.
#[derive(Clone, Debug)]
pub struct Looks {
    pub ticks: Vec<Look>,
    pub outcome: Outcome,
}

impl Looks {
    /// The tick of that number by the clock.
    #[track_caller]
    pub fn at(&self, tick: u64) -> &Look {
        let found = self.ticks.iter().find(|look| look.tick == tick);
        found.unwrap_or_else(|| panic!("nothing was played in tick {tick}"))
    }

    /// By how much crank `axis` was ahead of its command at a tick's end, turns.
    #[track_caller]
    pub fn ahead(&self, axis: usize, tick: u64) -> f64 {
        let look = self.at(tick);
        look.actual[axis] - look.command[axis]
    }

    /// How far crank `axis` went in a tick, turns.
    #[track_caller]
    pub fn way(&self, axis: usize, tick: u64) -> f64 {
        self.at(tick).actual[axis] - self.at(tick - 1).actual[axis]
    }

    /// When the index line of an axis rose, µs since power-up.
    pub fn rises_us(&self, axis: usize) -> Vec<f64> {
        let rose = self.ticks.iter().filter_map(|look| look.rose_us[axis]);
        rose.collect()
    }
}

struct Eyes(Vec<Look>);

impl Observer for Eyes {
    fn tick(&mut self, moment: &Moment<'_>) {
        let tick_ns = moment.end_ns - moment.start_ns;
        let start_us = moment.start_ns as f64 * 1e-3;
        let at_us = |cycle: u32| start_us + f64::from(cycle) * 0.008;
        self.0.push(Look {
            tick: moment.start_ns / tick_ns,
            command: moment.command_turns.to_vec(),
            actual: moment.actual_turns.to_vec(),
            rose_us: moment.index.iter().map(|rose| rose.map(at_us)).collect(),
            encoder: (0..moment.axis_count())
                .map(|i| moment.machine.encoder(i))
                .collect(),
            enabled: moment.drives_enabled,
        });
    }
}

/// Runs a scene and looks.
pub fn look(checked: &Checked) -> Looks {
    let mut eyes = Eyes(Vec::new());
    let outcome = simulate(checked, &mut eyes, |_, _| {}).expect("a checked scene runs");
    Looks {
        ticks: eyes.0,
        outcome,
    }
}

/// What the layer says at one reading after another, a tick apart, of three axes on which nothing else happens.
pub fn readings(checked: &Checked, ticks: std::ops::Range<u64>) -> Vec<Feedback> {
    let mut faults = host_sim::faults::Faults::new(checked);
    let read = |tick: u64| {
        let mut feedback = Feedback::of(None);
        faults.read(tick * 500, &mut feedback);
        feedback
    };
    ticks.map(read).collect()
}
