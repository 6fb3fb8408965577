//! One tick of a run, as an observer receives it.

use std::cell::OnceCell;

use cophase_core::signals::Telemetry;
use cophase_scene::units::turns;

use crate::drives::Played;
use crate::pose::Pose;
use crate::simulated_machine::SimulatedMachine;

/// Receives each tick of a run.
pub trait Observer {
    /// Receives a tick that was played.
    fn tick(&mut self, moment: &Moment<'_>);
}

/// Observer that ignores every tick.
impl Observer for () {
    fn tick(&mut self, _: &Moment<'_>) {}
}

/// Observer that is borrowed.
impl<A: Observer + ?Sized> Observer for &mut A {
    fn tick(&mut self, moment: &Moment<'_>) {
        (**self).tick(moment);
    }
}

/// Pair of observers that both receive each tick.
impl<A: Observer, B: Observer> Observer for (A, B) {
    fn tick(&mut self, moment: &Moment<'_>) {
        self.0.tick(moment);
        self.1.tick(moment);
    }
}

/// Observer that may be absent.
impl<A: Observer> Observer for Option<A> {
    fn tick(&mut self, moment: &Moment<'_>) {
        if let Some(observer) = self {
            observer.tick(moment);
        }
    }
}

/// One tick that was just played: its commands, and the response of the machine.
#[derive(Debug)]
pub struct Moment<'a> {
    /// Beginning of the tick, ns since power-up.
    pub start_ns: u64,
    /// End of the tick, ns since power-up.
    pub end_ns: u64,
    /// State of the loop when it planned this tick.
    pub telemetry: &'a Telemetry,
    /// Pulses and setpoints that were played.
    pub played: &'a Played,
    /// True if the drives were on.
    pub drives_enabled: bool,
    /// Level of the sync line.
    pub sync: bool,
    /// Rises of the index lines: cycles from the beginning of this tick.
    pub index: &'a [Option<u32>],
    /// Falls of the index lines: cycles from the beginning of this tick.
    pub index_fell: &'a [Option<u32>],
    /// Levels of the index lines at the end of the tick.
    pub index_high: &'a [bool],
    /// Commanded phase of the master at the end of the tick, turns since power-up.
    pub master_turns: f64,
    /// Commanded phases, turns since power-up.
    pub command_turns: &'a [f64],
    /// Target phases of the cranks, turns since power-up: the commanded phases without the corrections,
    /// which only compensate phase errors.
    pub aim_turns: &'a [f64],
    /// Actual phases of the cranks, turns since power-up.
    pub actual_turns: &'a [f64],
    /// Machine at the end of the tick.
    pub machine: &'a SimulatedMachine,
    /// Tilt and pose of the moved part, each computed once, when first needed.
    pub(super) tilt_mrad: OnceCell<Option<f64>>,
    pub(super) pose: OnceCell<Pose>,
}

impl Moment<'_> {
    /// Number of axes of the machine. Telemetry entries beyond it have no meaning.
    pub fn axis_count(&self) -> usize {
        self.actual_turns.len()
    }

    /// Lead of each crank over its target, turns. These are the true errors, which a controller cannot
    /// measure.
    pub fn errors(&self) -> impl ExactSizeIterator<Item = f64> {
        let cranks = self.actual_turns.iter().zip(self.aim_turns);
        cranks.map(|(actual, aim)| actual - aim)
    }

    /// Tilt of the moved part at the end of the tick, mrad. `None` if it does not tilt.
    pub fn tilt_mrad(&self) -> Option<f64> {
        let tilt = || {
            let tilt_mrad = self.machine.tilt_mrad(self.actual_turns);
            tilt_mrad.map(|mrad| if self.is_level() { 0.0 } else { mrad })
        };
        *self.tilt_mrad.get_or_init(tilt)
    }

    /// True if all shafts are alike. Differences between them cause a tilt, so there is none then.
    fn is_level(&self) -> bool {
        let first = self.actual_turns[0];
        self.actual_turns.iter().all(|&turns| turns == first)
    }

    /// Raises `max_mrad` to the tilt of the moved part at the end of the tick, if that is larger.
    pub fn raise_tilt(&self, max_mrad: &mut f64) {
        if self.is_level() {
            return;
        }
        let is_known = self.tilt_mrad.get().is_some();
        if is_known || self.machine.may_tilt_beyond(*max_mrad, self.actual_turns) {
            *max_mrad = max_mrad.max(self.tilt_mrad().unwrap_or(0.0));
        }
    }

    /// Pose of the moved part at the end of the tick.
    pub fn pose(&self) -> &Pose {
        self.pose.get_or_init(|| self.computed_pose())
    }

    fn computed_pose(&self) -> Pose {
        let ticks_per_s = 1e9 / (self.end_ns - self.start_ns) as f64;
        let motion = &self.telemetry.motion;
        let omega_turns_s = turns(motion.speed) * ticks_per_s;
        let acceleration_turns_s2 = turns(motion.acceleration) * ticks_per_s * ticks_per_s;
        let commanded = (
            omega_turns_s * std::f64::consts::TAU,
            acceleration_turns_s2 * std::f64::consts::TAU,
        );
        self.machine
            .pose(self.actual_turns, self.aim_turns, commanded)
    }
}
