//! Recording of a run of a machine of its own kind.

use std::fmt::Debug;
use std::sync::Arc;

use super::{Figure, Plant};
use crate::machine::Pose;

/// State of the equations of motion at a tick's end.
#[derive(Clone, Copy, Debug)]
pub struct State<'a> {
    /// Positions.
    pub q: &'a [f64],
    /// Their rates.
    pub v: &'a [f64],
    /// The rates of those.
    pub a: &'a [f64],
    /// Torque of each motor, N·m.
    pub torques_nm: &'a [f64],
}

/// One control tick that was played.
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a> {
    /// Time of its end, s since power-up.
    pub t_s: f64,
    /// Length, s.
    pub tick_s: f64,
    /// Whether the drives were on.
    pub drives_enabled: bool,
    /// Commanded speed of the master, rad/s.
    pub omega_rad_s: f64,
    /// Commanded acceleration of the master, rad/s².
    pub acceleration_rad_s2: f64,
    /// Phases of the shafts, turns since power-up.
    pub turns: &'a [f64],
    /// Commanded phases, turns since power-up.
    pub command_turns: &'a [f64],
    /// Position of what the shafts move.
    pub pose: Pose,
    /// State of the equations; none on the kinematic model level.
    pub state: Option<State<'a>>,
}

/// Copy of a [`Record`]: each that is `Clone` has it.
pub trait CloneRecord {
    /// Copy of the record.
    fn clone_box(&self) -> Box<dyn Record>;
}

impl<R: Record + Clone + 'static> CloneRecord for R {
    fn clone_box(&self) -> Box<dyn Record> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Record> {
    fn clone(&self) -> Self {
        (**self).clone_box()
    }
}

/// Figures of a run, gathered tick by tick.
pub trait Record: CloneRecord + Debug {
    /// Takes in one tick.
    fn tick(&mut self, tick: &Tick<'_>);

    /// Figures for the report, in its order.
    fn figures(&self) -> Vec<Figure>;

    /// Warnings for the report, a sentence each.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A machine of its own kind while it runs.
#[derive(Clone, Debug)]
pub struct Recorder {
    /// The machine.
    pub plant: Arc<dyn Plant>,
    /// Its record.
    pub record: Box<dyn Record>,
    ticks: u64,
    omega_before: f64,
}

impl Recorder {
    /// At power-up.
    pub fn new(plant: &Arc<dyn Plant>) -> Self {
        Self {
            plant: Arc::clone(plant),
            record: plant.record(),
            ticks: 0,
            omega_before: 0.0,
        }
    }

    /// Motion of the master in the tick that is played now: its speed, rad/s, and acceleration, rad/s².
    pub fn master(&mut self, turns: f64, tick_s: f64) -> (f64, f64) {
        let omega = turns * std::f64::consts::TAU / tick_s;
        let acceleration = (omega - self.omega_before) / tick_s;
        self.omega_before = omega;
        (omega, acceleration)
    }

    /// End of the tick that is played now, s since power-up.
    pub fn end_s(&mut self, tick_s: f64) -> f64 {
        self.ticks += 1;
        self.ticks as f64 * tick_s
    }
}
