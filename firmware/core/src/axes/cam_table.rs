//! Cam table: a curve over one turn of the master gives the position of the axis.
//!
//! The follower keeps the phase of the master within its turn as an integer, and the position there. The turns of a tick are the
//! difference of two positions, so no error accumulates over any number of turns, in either direction.

use core::hash::{Hash, Hasher};

use super::bounds::Bounds;
use super::cams::Cams;
use super::follower::Follower;
use super::spline::{MAX_CAM_POINTS, MIN_CAM_POINTS, Spline};
use crate::problem::{Problem, SettingsError};
use crate::units::{ONE_TURN, Phase, Turns};
use cophase_motion::settings::key::{Key, or};
use cophase_motion::settings::{self as motion, inside, turns};

/// Greatest position and net travel of a table, turns, and greatest slope.
const MAX_TURNS: f64 = 1000.0;

/// `cam_table.net_turns`
pub const NET_TURNS: Key = or(0.0).from(-MAX_TURNS, MAX_TURNS);
/// `cam_table.max_speed_hz`: no usual motor of a positioning drive turns faster than the default.
pub const MAX_SPEED_HZ: Key = or(100.0).from(1e-3, 1e3);
/// `cam_table.max_acceleration_hz_per_s`: a usual servo motor reaches twice the default without a load.
pub const MAX_ACCELERATION_HZ_PER_S: Key = or(10_000.0).from(1e-3, 1e9);
/// `axis.cam_shift_deg`
pub const CAM_SHIFT_DEG: Key = or(0.0).from(-360.0, 360.0);

/// Greatest second derivative, turns per turn²: 48 fraction bits and a sign leave 15 bits.
const MAX_BEND: f64 = 30_000.0;
/// Roughness of a closing step that is a jump, over that of the table without it.
const JUMP: f64 = 3.0;
/// Roughness that a table has by the rounding of its points to six decimals, turns.
const ROUNDING_TURNS: f64 = 2e-6;

/// Cam table: positions of an axis over one turn of the master.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct CamSettings {
    /// Whole turns of the axis in one turn of the master, in the range of [`NET_TURNS`]; 0 if the axis comes back.
    pub net_turns: i32,
    /// Limit on the speed of an axis that follows the table, rev/s, in the range of [`MAX_SPEED_HZ`].
    pub max_speed_hz: f64,
    /// Limit on the acceleration of an axis that follows the table, rev/s², in the range of [`MAX_ACCELERATION_HZ_PER_S`].
    pub max_acceleration_hz_per_s: f64,
    /// Positions at equally spaced phases of the master from 0 on, turns, −1000 to 1000. 4 to [`MAX_CAM_POINTS`] points.
    pub points_turns: heapless::Vec<f64, MAX_CAM_POINTS>,
}

impl CamSettings {
    /// Speed limit of an axis whose own is not given, rev/s.
    pub const USUAL_MAX_SPEED_HZ: f64 = MAX_SPEED_HZ.number();
    /// Acceleration limit of an axis whose own is not given, rev/s².
    pub const USUAL_MAX_ACCELERATION_HZ_PER_S: f64 = MAX_ACCELERATION_HZ_PER_S.number();

    /// Checks every number, and that the table keeps to its axes' limits when the master reaches `master`: rev/s, rev/s², rev/s³.
    ///
    /// # Errors
    /// The first number that is wrong, a curve that jumps where it closes, or one that is too steep.
    #[cold]
    pub fn check(&self, master: &Bounds) -> Result<(), SettingsError> {
        let count = self.points_turns.len() as f64;
        let (min, max) = (MIN_CAM_POINTS as f64, MAX_CAM_POINTS as f64);
        inside("cam_table.points", count, min, max)?;
        let net_turns = f64::from(self.net_turns);
        NET_TURNS.check("cam_table.net_turns", net_turns)?;
        for &point in &self.points_turns {
            inside("cam_table.points", point, -MAX_TURNS, MAX_TURNS)?;
        }
        MAX_SPEED_HZ.check("cam_table.max_speed_hz", self.max_speed_hz)?;
        MAX_ACCELERATION_HZ_PER_S.check(
            "cam_table.max_acceleration_hz_per_s",
            self.max_acceleration_hz_per_s,
        )?;
        self.check_closing()?;
        let (slope, bend) = self.steepest();
        if slope > MAX_TURNS || bend > MAX_BEND {
            return Err(SettingsError::new(
                "cam_table.points",
                Problem::CamTooSteep { slope, bend },
            ));
        }
        self.check_limits(master)
    }

    /// Step of the axis from point `i` to the next one, turns. The last one closes the table.
    fn step(&self, i: usize) -> f64 {
        let points = &self.points_turns;
        let count = points.len().max(1);
        let at = |i: usize| {
            let turn = (i / count) as f64 * f64::from(self.net_turns);
            points.get(i % count).copied().unwrap_or(0.0) + turn
        };
        let i = i % count;
        at(i + 1) - at(i)
    }

    /// Checks that no whole turns are missing from the net travel.
    ///
    /// A step is *rough* by its distance from the mean of the two beside it, and a table as its roughest step. Whole turns are missing if
    /// the closing step is more than three times as rough as the table is with them.
    #[cold]
    fn check_closing(&self) -> Result<(), SettingsError> {
        let count = self.points_turns.len();
        let closing = count - 1;
        // With `more` turns in each turn of the master.
        let rough = |i: usize, more: f64| {
            let step = |i: usize| self.step(i) + if i % count == closing { more } else { 0.0 };
            (step(i) - 0.5 * (step(i + closing) + step(i + 1))).abs()
        };
        let beside = 0.5 * (self.step(closing - 1) + self.step(0));
        let missing = libm::round(beside - self.step(closing));
        let steps = (0..count).map(|i| rough(i, missing));
        let roughest = steps.fold(ROUNDING_TURNS, f64::max);
        if missing == 0.0 || rough(closing, 0.0) <= JUMP * roughest {
            return Ok(());
        }
        let problem = Problem::CamJump {
            step_turns: self.step(closing),
            meant: self.net_turns + missing as i32,
        };
        Err(SettingsError::new("cam_table.net_turns", problem))
    }

    /// Checks the curve against the limits of the axes.
    #[cold]
    #[inline(never)] // The curve takes a kilobyte of stack.
    fn check_limits(&self, master: &Bounds) -> Result<(), SettingsError> {
        let mut curve = Spline::NONE;
        curve.fit(&self.points_turns, self.net_turns);
        let bounds = curve.bounds(master);
        let (speed_hz, limit_hz) = (bounds.speed, self.max_speed_hz);
        if speed_hz > limit_hz {
            let steps = (0..self.points_turns.len()).map(|i| self.step(i).abs());
            let (fastest, _) = steps.enumerate().fold((0, 0.0), |fastest, (i, step)| {
                if step > fastest.1 { (i, step) } else { fastest }
            });
            let problem = Problem::CamSpeed {
                master_hz: master.speed,
                speed_hz,
                limit_hz,
                from_deg: 360.0 * fastest as f64 / self.points_turns.len() as f64,
            };
            return Err(SettingsError::new("cam_table.max_speed_hz", problem));
        }
        let limit_hz_per_s = self.max_acceleration_hz_per_s;
        if bounds.acceleration > limit_hz_per_s {
            let problem = Problem::CamAcceleration {
                master_hz: master.speed,
                hz_per_s: bounds.acceleration,
                limit_hz_per_s,
            };
            let key = "cam_table.max_acceleration_hz_per_s";
            return Err(SettingsError::new(key, problem));
        }
        Ok(())
    }

    /// Upper bounds on the first and the second derivative of the curve, turns per turn and turn². They need no fit, because no bend
    /// exceeds half of the largest second difference. For smooth tables the first is some percent too high, the second up to three times.
    #[cold]
    pub fn steepest(&self) -> (f64, f64) {
        let count = self.points_turns.len();
        let steps = (0..count).map(|i| self.step(i).abs()).fold(0.0, f64::max);
        let bends = (0..count)
            .map(|i| (self.step(i + 1) - self.step(i)).abs())
            .fold(0.0, f64::max);
        let count = count as f64;
        (count * (steps + 1.5 * bends), 3.0 * count * count * bends)
    }
}

/// Settings of an axis that follows a cam table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
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
        CAM_SHIFT_DEG.check("axes.cam_shift_deg", self.shift_turns * 360.0)?;
        Ok(())
    }

    /// Converts the error of an axis that would be too fast to one of the table. `speed_hz` is the greatest speed of the axis, and
    /// `master_hz` that of the master, rev/s.
    #[cold]
    pub fn too_fast(&self, error: SettingsError, master_hz: f64, speed_hz: f64) -> SettingsError {
        let max_hz = match error.problem {
            Problem::Motion(motion::Problem::StepRate {
                rate_hz, max_hz, ..
            })
            | Problem::Motion(motion::Problem::CountRate {
                rate_hz, max_hz, ..
            }) => speed_hz * max_hz / rate_hz,
            Problem::TooFastForTick { turns_per_tick } => 0.5 * speed_hz / turns_per_tick,
            _ => return error,
        };
        let problem = Problem::CamTooFast {
            master_hz,
            speed_hz,
            max_hz,
        };
        SettingsError::new("axes.cam", problem)
    }

    /// Upper bound on the turns of the axis per turn of the master, without a fit.
    #[cold]
    pub fn max_ratio(&self, cams: &[CamSettings]) -> f64 {
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

    fn hash_constants(&self, hasher: &mut impl Hasher) {
        let Self {
            table,
            phase: _,
            position: _,
        } = self;
        table.hash(hasher);
    }

    fn is_direct(&self) -> bool {
        false
    }

    #[cold]
    fn start(&self) -> Turns {
        Turns::from_bits(self.position)
    }

    #[cold]
    fn bounds(&self, master: &Bounds, cams: &Cams) -> Bounds {
        self.curve(cams).bounds(master)
    }

    #[cold]
    fn allows_index(&self, cams: &Cams) -> bool {
        let curve = self.curve(cams);
        curve.net() == ONE_TURN && curve.extremes().min_slope > 0.0
    }
}
