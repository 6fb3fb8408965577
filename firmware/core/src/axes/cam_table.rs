//! Cam table: a curve over one turn of the master gives the position of the axis.
//!
//! The follower keeps the phase of the master within its turn as an integer, and the position there. The turns of a tick are the
//! difference of two positions, so no error accumulates over any number of turns, in either direction.

use super::bounds::Bounds;
use super::cams::Cams;
use super::follower::Follower;
use super::spline::{LEAST_CAM_POINTS, MAX_CAM_POINTS, Spline};
use crate::settings::{Problem, SettingsError};
use crate::units::{ONE_TURN, Phase, Turns};
use cophase_motion::settings::{self as motion, inside, turns};

/// Greatest position and net travel of a table, turns, and greatest slope.
const MOST_TURNS: f64 = 1000.0;
/// Greatest second derivative, turns per turn²: 48 fraction bits and a sign leave 15 bits.
const MOST_BEND: f64 = 30_000.0;

/// Cam table: positions of an axis over one turn of the master.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CamSettings {
    /// Whole turns of the axis in one turn of the master, −1000 to 1000; 0 if the axis comes back.
    pub net_turns: i32,
    /// Positions at equally spaced phases of the master from 0 on, turns, −1000 to 1000. 4 to [`MAX_CAM_POINTS`] points.
    pub points_turns: heapless::Vec<f64, MAX_CAM_POINTS>,
}

impl CamSettings {
    /// Checks every number.
    ///
    /// # Errors
    /// The first number that is wrong, or a curve that is too steep.
    #[cold]
    pub fn check(&self) -> Result<(), SettingsError> {
        let count = self.points_turns.len() as f64;
        let (least, most) = (LEAST_CAM_POINTS as f64, MAX_CAM_POINTS as f64);
        inside("cam_table.points", count, least, most)?;
        let net_turns = f64::from(self.net_turns);
        inside("cam_table.net_turns", net_turns, -MOST_TURNS, MOST_TURNS)?;
        for &point in &self.points_turns {
            inside("cam_table.points", point, -MOST_TURNS, MOST_TURNS)?;
        }
        let (slope, bend) = self.steepest();
        if slope > MOST_TURNS || bend > MOST_BEND {
            return Err(SettingsError::new(
                "cam_table.points",
                Problem::CamTooSteep { slope, bend },
            ));
        }
        Ok(())
    }

    /// Upper bounds on the first and the second derivative of the curve, turns per turn and turn². They need no fit, because no bend
    /// exceeds half of the largest second difference. For smooth tables the first is some percent too high, the second up to three times.
    #[cold]
    pub fn steepest(&self) -> (f64, f64) {
        let points = &self.points_turns;
        let count = points.len();
        let at = |i: usize| {
            let turn = (i / count.max(1)) as f64 * f64::from(self.net_turns);
            points.get(i % count.max(1)).copied().unwrap_or(0.0) + turn
        };
        let step = |i: usize| at(i + 1) - at(i);
        let steps = (0..count).map(|i| step(i).abs()).fold(0.0, f64::max);
        let bends = (0..count)
            .map(|i| (step(i + 1) - step(i)).abs())
            .fold(0.0, f64::max);
        let count = count as f64;
        (count * (steps + 1.5 * bends), 3.0 * count * count * bends)
    }
}

/// Settings of an axis that follows a cam table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CamTableSettings {
    /// Number of the table in the settings of the machine.
    pub table: u8,
    /// Phase of the table at the master's phase 0, turns, −1 to 1.
    pub shift_turns: f64,
}

impl CamTableSettings {
    /// Checks the numbers against the cam tables of the machine.
    ///
    /// # Errors
    /// There is no such table, or the shift is out of range.
    #[cold]
    pub fn check(&self, cams: &[CamSettings]) -> Result<(), SettingsError> {
        let tables = cams.len();
        if usize::from(self.table) >= tables {
            let table = self.table;
            return Err(SettingsError::new(
                "axes.cam",
                Problem::NoSuchCam { table, tables },
            ));
        }
        inside(
            "axes.cam_shift_deg",
            self.shift_turns * 360.0,
            -360.0,
            360.0,
        )?;
        Ok(())
    }

    /// Converts the error of an axis that would be too fast to one of the table. `speed_hz` is the greatest speed of the axis, and
    /// `master_hz` that of the master, rev/s.
    #[cold]
    pub fn too_fast(&self, error: SettingsError, master_hz: f64, speed_hz: f64) -> SettingsError {
        let most_hz = match error.problem {
            Problem::Motion(motion::Problem::StepRate {
                rate_hz, most_hz, ..
            })
            | Problem::Motion(motion::Problem::CountRate {
                rate_hz, most_hz, ..
            }) => speed_hz * most_hz / rate_hz,
            Problem::TooFastForTick { turns_per_tick } => 0.5 * speed_hz / turns_per_tick,
            _ => return error,
        };
        let problem = Problem::CamTooFast {
            master_hz,
            speed_hz,
            most_hz,
        };
        SettingsError::new("axes.cam", problem)
    }

    /// Upper bound on the turns of the axis per turn of the master, without a fit.
    #[cold]
    pub fn most_ratio(&self, cams: &[CamSettings]) -> f64 {
        let table = cams.get(usize::from(self.table));
        table.map_or(0.0, |table| table.steepest().0)
    }
}

/// Follower of a cam table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CamTable {
    table: u8,
    /// Phase within the table, turns, 0 ≤ phase < 1.
    phase: Turns,
    /// Position at this phase, within the table's turn.
    position: i64,
}

impl CamTable {
    /// Follower at the master's phase 0.
    #[cold]
    pub fn new(settings: &CamTableSettings, cams: &Cams) -> Self {
        let phase = Phase::from_turns(turns(settings.shift_turns)).within_turn();
        let mut follower = Self {
            table: settings.table,
            phase,
            position: 0,
        };
        follower.position = follower.curve(cams).position(phase.to_bits() as u64);
        follower
    }

    fn curve<'a>(&self, cams: &'a Cams) -> &'a Spline {
        // Checked settings name a table that exists.
        let [first, ..] = cams;
        cams.get(usize::from(self.table)).unwrap_or(first)
    }
}

impl Follower for CamTable {
    #[inline(never)]
    fn advance(&mut self, master: Turns, cams: &Cams) -> Turns {
        let curve = self.curve(cams);
        let phase = self.phase.wrapping_add(master);
        self.phase = Phase::from_turns(phase).within_turn();
        let position = curve.position(self.phase.to_bits() as u64);
        let mut travel = position - self.position;
        // At most one turn of the master, so at most one seam of the table.
        if phase < 0 {
            travel -= curve.net();
        } else if phase.to_bits() >= ONE_TURN {
            travel += curve.net();
        }
        self.position = position;
        Turns::from_bits(travel)
    }

    fn acceleration(&self, speed: Turns, acceleration: Turns, cams: &Cams) -> Turns {
        let phase = self.phase.to_bits() as u64;
        self.curve(cams).acceleration(phase, speed, acceleration)
    }

    fn is_direct(&self) -> bool {
        false
    }

    #[cold]
    fn start(&self) -> Turns {
        Turns::from_bits(self.position)
    }

    /// Applies the chain rule: v = y′ ω, a = y′ α + y″ ω², j = y′ J + 3 y″ ω α + y‴ ω³.
    #[cold]
    fn bounds(&self, master: &Bounds, cams: &Cams) -> Bounds {
        let curve = self.curve(cams).extremes().greatest;
        let Bounds {
            speed,
            acceleration,
            jerk,
        } = *master;
        Bounds {
            speed: curve.speed * speed,
            acceleration: curve.speed * acceleration + curve.acceleration * speed * speed,
            jerk: curve.speed * jerk
                + 3.0 * curve.acceleration * speed * acceleration
                + curve.jerk * speed * speed * speed,
        }
    }

    #[cold]
    fn allows_index(&self, cams: &Cams) -> bool {
        let curve = self.curve(cams);
        curve.net() == ONE_TURN && curve.extremes().least_slope > 0.0
    }
}
