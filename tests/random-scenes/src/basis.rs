//! Values that several tables of a scene depend on.

use cophase_scene::file::{Drive, Fidelity};
use host_sim::drives::DriveModel;
use host_sim::mechanism::{AnyMechanism, Mechanism};

use crate::source::Source;

/// Kinds of the scenes that are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds {
    /// Some scenes have faults, noise of loads, and events from outside.
    pub disturbed: bool,
    /// All scenes have `[questions]` and leave `fidelity` to be chosen. They have cranks that torque moves, or cams with masses.
    pub has_questions: bool,
}

impl Kinds {
    /// All scenes.
    pub const ALL: Self = Self {
        disturbed: true,
        has_questions: false,
    };
    /// Scenes with questions, without faults or events.
    pub const QUESTIONS: Self = Self {
        disturbed: false,
        has_questions: true,
    };
}

/// Motors and drives of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Cranks under a platform.
    Cranks,
    /// Cam shafts with followers.
    Shafts,
    /// Pushers on screws that follow cam tables.
    Screws,
}

/// RandomScene values that several tables depend on.
pub(crate) struct Basis {
    pub(crate) kinds: Kinds,
    pub(crate) kind: Kind,
    pub(crate) fidelity: Fidelity,
    pub(crate) count: usize,
    /// Drive of most axes, and of those that have one of their own.
    pub(crate) drive: Drive,
    pub(crate) other_drive: Option<Drive>,
    pub(crate) has_encoder: bool,
    /// Motors have torque: pull-out torque, gains and rotor inertia are given.
    pub(crate) has_torque: bool,
    pub(crate) tick_hz: u32,
    /// The mechanism that gives amax. For a cam, it is one of the same greatest acceleration.
    pub(crate) mechanism: AnyMechanism,
    pub(crate) load_kg: f64,
    /// Greatest speed of the master, rev/s.
    pub(crate) speed_hz: f64,
    pub(crate) homing_hz: f64,
    /// Time from rest to the greatest speed, s.
    pub(crate) ramp_s: f64,
    /// Crank turns per master turn.
    pub(crate) ratio: (u32, u32),
    /// Motor turns and crank turns that belong together.
    pub(crate) gear: (u32, u32),
    /// Times of the program, s, and its start.
    pub(crate) program_s: f64,
    pub(crate) begins_s: f64,
}

impl Basis {
    /// True if all cranks must be at one angle, as on the rigid level.
    pub(crate) fn is_rigid(&self) -> bool {
        self.fidelity == Fidelity::Rigid
    }

    /// True if a key of drives acts on an axis.
    pub(crate) fn uses(&self, key: &str) -> bool {
        let mut drives = [Some(self.drive), self.other_drive].into_iter().flatten();
        drives.any(|drive| DriveModel::for_drive(drive).uses(key))
    }

    /// Greatest acceleration at the greatest speed, m/s².
    pub(crate) fn max_amax_mps2(&self) -> f64 {
        self.mechanism
            .amax_mps2(self.speed_hz * std::f64::consts::TAU)
    }

    /// Greatest speed of a crank, rev/s.
    pub(crate) fn crank_hz(&self) -> f64 {
        self.speed_hz * f64::from(self.ratio.0) / f64::from(self.ratio.1)
    }

    /// Motor turns per crank turn.
    pub(crate) fn motor_turns(&self) -> f64 {
        f64::from(self.gear.0) / f64::from(self.gear.1)
    }

    /// A time from power-up to somewhat after the program, s.
    pub(crate) fn time_s(&self, source: &mut Source) -> f64 {
        source.between(0.0, self.begins_s + 1.2 * self.program_s)
    }
}
