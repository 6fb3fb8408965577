//! Recording of a plant's run.

use std::fmt::Debug;

use cophase_core::supervisor::FaultKind;

use super::Figure;
use crate::pose::Pose;

/// State of the equations of motion at the end of a tick.
#[derive(Clone, Copy, Debug)]
pub struct State<'a> {
    /// Positions.
    pub q: &'a [f64],
    /// First time derivatives of the positions.
    pub v: &'a [f64],
    /// Second time derivatives of the positions.
    pub a: &'a [f64],
    /// Torque of each motor, N·m.
    pub torques_nm: &'a [f64],
}

/// One control tick of the simulation.
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a> {
    /// End of the tick, s since power-up.
    pub t_s: f64,
    /// Duration, s.
    pub tick_s: f64,
    /// True if the drives were on.
    pub drives_enabled: bool,
    /// Commanded speed of the master, rad/s.
    pub omega_rad_s: f64,
    /// Commanded acceleration of the master, rad/s².
    pub acceleration_rad_s2: f64,
    /// Phases of the shafts, turns since power-up.
    pub turns: &'a [f64],
    /// Commanded phases, turns since power-up.
    pub command_turns: &'a [f64],
    /// Position of the part that the shafts move.
    pub pose: Pose,
    /// State of the equations of motion. `None` on the kinematic model level.
    pub state: Option<State<'a>>,
}

/// Copying of a boxed [`Record`]. Every record that is `Clone` implements it.
pub trait CloneRecord {
    /// Returns a copy of the record.
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

/// Figures of a run, collected tick by tick.
pub trait Record: CloneRecord + Debug {
    /// Adds one tick to the record.
    fn tick(&mut self, tick: &Tick<'_>);

    /// Ends the record. `faults` are the kinds that latched in the run. The default ignores them.
    fn end(&mut self, _faults: &[FaultKind]) {}

    /// Figures for the report, in the order of the report.
    fn figures(&self) -> Vec<Figure>;

    /// Warnings for the report, one sentence each.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}
