//! Samples of a run: its cranks and lines at every tick.

use cophase_core::signals::Feedback;
use host_sim::checked::Checked;
use host_sim::sim::{Moment, Observer, Outcome, simulate};

/// One tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Its number by the clock.
    pub tick: u64,
    /// Commanded and true positions of the cranks at its end, turns.
    pub command: Vec<f64>,
    pub actual: Vec<f64>,
    /// Times at which index lines rose, µs since power-up.
    pub rose_us: Vec<Option<f64>>,
    /// Readings of encoders.
    pub encoder: Vec<i32>,
    /// True if the drives were on.
    pub enabled: bool,
}

/// A run.
#[derive(Clone, Debug)]
pub struct Samples {
    pub ticks: Vec<Sample>,
    pub outcome: Outcome,
}

impl Samples {
    /// The tick of that number by the clock.
    #[track_caller]
    pub fn at(&self, tick: u64) -> &Sample {
        let found = self.ticks.iter().find(|sample| sample.tick == tick);
        found.unwrap_or_else(|| panic!("nothing was played in tick {tick}"))
    }

    /// Returns the distance of crank `axis` ahead of its command at a tick's end, turns.
    #[track_caller]
    pub fn ahead(&self, axis: usize, tick: u64) -> f64 {
        let sample = self.at(tick);
        sample.actual[axis] - sample.command[axis]
    }

    /// Returns the travel of crank `axis` in a tick, turns.
    #[track_caller]
    pub fn distance(&self, axis: usize, tick: u64) -> f64 {
        self.at(tick).actual[axis] - self.at(tick - 1).actual[axis]
    }

    /// Returns the times at which the index line of an axis rose, µs since power-up.
    pub fn rises_us(&self, axis: usize) -> Vec<f64> {
        let rose = self.ticks.iter().filter_map(|sample| sample.rose_us[axis]);
        rose.collect()
    }
}

struct Recorder(Vec<Sample>);

impl Observer for Recorder {
    fn tick(&mut self, moment: &Moment<'_>) {
        let tick_ns = moment.end_ns - moment.start_ns;
        let start_us = moment.start_ns as f64 * 1e-3;
        let at_us = |cycle: u32| start_us + f64::from(cycle) * 0.008;
        self.0.push(Sample {
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

/// Runs a scene and records its samples.
pub fn observe(checked: &Checked) -> Samples {
    let mut recorder = Recorder(Vec::new());
    let outcome = simulate(checked, &mut recorder, |_, _| {}).expect("a checked scene runs");
    Samples {
        ticks: recorder.0,
        outcome,
    }
}

/// Returns the readings of the fault layer in successive ticks, for three axes without other events.
pub fn readings(checked: &Checked, ticks: std::ops::Range<u64>) -> Vec<Feedback> {
    let mut faults = host_sim::faults::Faults::new(checked);
    let read = |tick: u64| {
        let mut feedback = Feedback::with_command(None);
        faults.read((tick * 500).saturating_sub(500), tick * 500, &mut feedback);
        feedback
    };
    ticks.map(read).collect()
}
