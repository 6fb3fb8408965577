//! One tick of a run, as whoever looks on sees it.

use std::cell::OnceCell;

use cophase_core::signals::Telemetry;

use crate::machine::{Machine, Played, Pose};
use crate::units::turns;

/// Looks on while a scene runs.
pub trait Observer {
    /// One tick was played.
    fn tick(&mut self, moment: &Moment<'_>);
}

/// Nobody looks.
impl Observer for () {
    fn tick(&mut self, _: &Moment<'_>) {}
}

/// One that is lent looks.
impl<A: Observer> Observer for &mut A {
    fn tick(&mut self, moment: &Moment<'_>) {
        (**self).tick(moment);
    }
}

/// Both look.
impl<A: Observer, B: Observer> Observer for (A, B) {
    fn tick(&mut self, moment: &Moment<'_>) {
        self.0.tick(moment);
        self.1.tick(moment);
    }
}

/// None looks, or one.
impl<A: Observer> Observer for Option<A> {
    fn tick(&mut self, moment: &Moment<'_>) {
        if let Some(observer) = self {
            observer.tick(moment);
        }
    }
}

/// One tick that was just played: what was commanded, and what became of it.
#[derive(Debug)]
pub struct Moment<'a> {
    /// When the tick began, ns since power-up.
    pub start_ns: u64,
    /// When it ended.
    pub end_ns: u64,
    /// What the loop knew when it planned this tick.
    pub telemetry: &'a Telemetry,
    /// What was played.
    pub played: &'a Played,
    /// Whether the drives were on.
    pub drives_enabled: bool,
    /// Level of the sync line.
    pub sync: bool,
    /// When index lines rose: cycles from this tick's beginning.
    pub index: &'a [Option<u32>],
    /// Commanded phase of the master at the tick's end, turns since power-up.
    pub master_turns: f64,
    /// Commanded phases, turns since power-up.
    pub command_turns: &'a [f64],
    /// Phases at which cranks are to be: as commanded, but for what only corrects that they are elsewhere.
    pub aim_turns: &'a [f64],
    /// True phases of the cranks, turns since power-up.
    pub actual_turns: &'a [f64],
    /// The machine at the tick's end.
    pub machine: &'a Machine,
    /// Worked out where somebody asks, and once for all that do.
    pub(super) tilt_mrad: OnceCell<f64>,
}

impl Moment<'_> {
    /// How many axes the machine has. Entries of the telemetry beyond it mean nothing.
    pub fn axis_count(&self) -> usize {
        self.actual_turns.len()
    }

    /// By how much each crank is ahead of where it is to be, turns: the truth, which no controller sees.
    pub fn errors(&self) -> impl ExactSizeIterator<Item = f64> {
        let cranks = self.actual_turns.iter().zip(self.aim_turns);
        cranks.map(|(actual, aim)| actual - aim)
    }

    /// Tilt of the platform at the tick's end, mrad.
    pub fn tilt_mrad(&self) -> f64 {
        // Tilt is a difference of cranks: where they are all alike, there is none.
        let first = self.actual_turns[0];
        if self.actual_turns.iter().all(|&turns| turns == first) {
            return 0.0;
        }
        let tilt = || self.machine.tilt_mrad(self.actual_turns);
        *self.tilt_mrad.get_or_init(tilt)
    }

    /// Raises `most_mrad` to the tilt of the platform at the tick's end, if that is larger.
    pub fn raise_tilt(&self, most_mrad: &mut f64) {
        if self.machine.may_tilt_beyond(*most_mrad, self.actual_turns) {
            let tilt_mrad = self.tilt_mrad();
            if tilt_mrad > *most_mrad {
                *most_mrad = tilt_mrad;
            }
        }
    }

    /// Where the platform is at the tick's end.
    pub fn pose(&self) -> Pose {
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
