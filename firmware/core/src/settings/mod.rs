//! Settings of the user, in physical units. They are checked once, here, and converted to coefficients.
//!
//! This is the only place where the core has floats. The tick works on the coefficients that the modules' own builders
//! make from settings that passed [`Settings::check`]. So it never has to handle a bad setting.

mod axis_motion;
mod check;
mod commanded;
mod host_loss;
mod machine;
pub mod rows;
#[cfg(test)]
pub(crate) mod sample;
mod slots;
#[cfg(test)]
mod tests;
mod wiring;

pub use cophase_motion::settings::key::{self, Key};
pub use cophase_motion::settings::{
    ACCELERATION_HZ_PER_S, BAND_HZ, BandSettings, HOMING_SPEED_HZ, JERK_HZ_PER_S2, LimitSettings,
    MAX_BANDS, PulseSettings, SPEED_HZ, STOP_ACCELERATION_HZ_PER_S, STOP_JERK_HZ_PER_S2, TICK_HZ,
    inside, tick_cycles, turns, turns_at_most,
};
pub use host_loss::{HostLossReaction, HostLossSettings, TIMEOUT_S};
pub use machine::{MachineSettings, Platform, PlatformSettings, ShaftSettings};
pub(crate) use slots::{slot_steps, slot_ticks};
pub use wiring::{ActiveLevel, InputWiring, WiringSettings};

use cophase_motion::keys;
use cophase_motion::settings::key::or;

use crate::axes::{CamSettings, FollowerSettings, MAX_CAMS};
use crate::mechanism::AnyMechanism;
use crate::problem::{Problem, SettingsError};
use crate::program::{CAPACITY, EntrySettings, Program, ProgramBuilder, SegmentSettings, Shape};
use crate::pulse::StepsPerTurn;
use crate::units::MAX_AXES;

/// Longest name of a machine, bytes of UTF-8.
pub const NAME_BYTES: usize = 32;

/// Settings of one machine's control loop: limits, axes and program.
///
/// The values are unchecked, as they may come from a memory chip. [`crate::controller::Controller::configure`] checks
/// them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct Settings {
    /// Name of the machine, for logs; see [`short_name`].
    pub name: heapless::String<NAME_BYTES>,
    /// Tick rate, Hz, one of [`TICK_HZ`] with a tick of whole microseconds.
    pub tick_hz: u32,
    /// Cycles of the board's step clock per second; a tick is 2048 to 262,143 whole cycles. It is not part of a settings file: the program
    /// that runs the settings sets it from its board.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub clock_hz: u32,
    /// Machine that the axes move.
    pub machine: MachineSettings,
    /// Limits of the master shaft.
    pub limits: LimitSettings,
    /// Timing of the STEP and DIR lines.
    pub pulse: PulseSettings,
    /// Filter of the index lines.
    pub index: IndexSettings,
    /// Axes, 1 to [`MAX_AXES`] entries.
    pub axes: heapless::Vec<AxisSettings, MAX_AXES>,
    /// Cam tables, which axes may follow.
    pub cams: heapless::Vec<CamSettings, MAX_CAMS>,
    /// Trims that are set at start, turns, axis by axis; an axis without an entry has none.
    pub trims_turns: heapless::Vec<f64, MAX_AXES>,
    /// Limits of the phase-drift monitor.
    pub drift: Drift,
    /// Correction of phase errors.
    pub correction: CorrectionSettings,
    /// Crank phase at which the machine parks, turns.
    pub park_turns: f64,
    /// Time for which energised drives settle before anything moves, seconds.
    pub settle_s: f64,
    /// True if a brake holds the cranks while the drives are off. A coordinated stop by a fault then ends with the drives
    /// off.
    pub has_brake: bool,
    /// Levels of the board's lines.
    pub wiring: WiringSettings,
    /// Reaction to the loss of the host.
    pub host_loss: HostLossSettings,
    /// Program amax(t): segments, and repeats of earlier entries.
    pub program: heapless::Vec<EntrySettings, CAPACITY>,
}

/// Reciprocal of the greatest width of the index filter as a part of a tick: one fourth.
pub const MAX_TICK_SHARE: u32 = 4;

/// `index.width_us`
const INDEX_WIDTH_US: Key = or(2.0)
    .from(0.1, 100.0)
    .at_most(1e6 / MAX_TICK_SHARE as f64, &[("control.tick_hz", -1)])
    .because("a quarter of a tick at most, so that a pulse is known in the next tick");

keys! {
    /// Filter of the index lines.
    pub struct IndexSettings in "index" {
        /// Shortest time for which an index line must keep a level, at most a quarter of a tick. A shorter level is a glitch.
        width_us: f64 = INDEX_WIDTH_US,
    }
}

keys! {
    /// Settings of the loop, in the units of a scene.
    pub struct Control in "control" {
        /// Control ticks per second. A tick is a whole number of microseconds.
        tick_hz: u32 = or(2000.0).from(*TICK_HZ.start() as f64, *TICK_HZ.end() as f64)
            .because("the rates at which the loop runs"),
        /// Crank phase at which the machine parks. 180 is the bottom of a platform above the cranks.
        park_deg: f64 = or(180.0).from(0.0, 360.0).because("one turn"),
        /// Time between switching the drives on and moving.
        settle_s: f64 = or(0.1).from(0.0, 10.0),
    }
}

keys! {
    /// Limits on the spatial modes of phase errors.
    pub struct Drift in "drift" {
        /// Platform tilt at the worst crank phase.
        tilt_limit_mrad: f64 = or(3.0).from(1e-3, 100.0),
        /// Deviation of a crank from the plane through all, from four axes on.
        warp_limit_deg: f64 = or(3.0).from(1e-3, 90.0),
        /// Lag that is common to all cranks.
        common_limit_deg: f64 = or(15.0).from(1e-3, 180.0),
        /// Largest error of one reading from noise alone. A smaller deviation is no finding.
        reading_error_deg: f64 = or(0.25).from(0.01, 5.0),
        /// Delay with which all cranks follow in normal operation. It is subtracted before the limits are checked.
        lag_us: f64 = or(0.0).from(0.0, 100_000.0),
    }
}

/// Kind of drive of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub enum DriveKind {
    /// Step and direction pulses, open loop.
    Stepper,
    /// Position, velocity and torque setpoints each tick.
    Servo,
    /// Step and direction pulses to a servo drive, which closes its own position loop: it loses no steps, and has an
    /// alarm.
    PulseServo,
}

impl DriveKind {
    /// True if STEP and DIR command the drive, and not setpoints.
    pub const fn takes_pulses(self) -> bool {
        !matches!(self, Self::Servo)
    }

    /// True if the drive does not measure its rotor. It loses whole electrical cycles, and has no alarm for a rotor that does not follow.
    pub const fn is_open_loop(self) -> bool {
        matches!(self, Self::Stepper)
    }
}

/// Belt or gearbox between a motor and its crank: turns of both that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct Transmission {
    /// Turns of the motor, 1 to [`Self::MAX_TURNS`].
    pub motor_turns: u32,
    /// Turns of the crank in that time, 1 to [`Self::MAX_TURNS`].
    pub crank_turns: u32,
}

impl Transmission {
    /// Motor on the crank's own shaft.
    pub const DIRECT: Self = Self {
        motor_turns: 1,
        crank_turns: 1,
    };
    /// Largest number of either turns.
    pub const MAX_TURNS: u32 = 1000;

    /// Turns of the motor per turn of the crank. Speeds and positions of the motor are this multiple of the crank's, and torques of the
    /// crank this multiple of the motor's.
    pub fn ratio(&self) -> f64 {
        f64::from(self.motor_turns) / f64::from(self.crank_turns)
    }
}

/// One motor and its crank.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct AxisSettings {
    /// Kind of drive.
    pub drive: DriveKind,
    /// Steps (or encoder counts) per turn of the motor, 4 to [`StepsPerTurn::MAX`]. Per turn of the crank there may be as many, too.
    pub steps_per_turn: u32,
    /// Belt or gearbox from the motor to the crank.
    pub gear: Transmission,
    /// True if the crank turns in the opposite sense of axis 0.
    pub reversed: bool,
    /// Follower of the crank: its relation to the master.
    pub follower: FollowerSettings,
    /// Crank phase relative to the one that its follower gives, turns, −½ to ½.
    pub offset_turns: f64,
    /// Crank phase at which its index flag begins, going forward, turns, −½ to ½; none if it has no sensor.
    pub index_turns: Option<f64>,
    /// Length of the index flag, turns of the crank, 0 to ¼. In reverse a crank reaches the other end first.
    pub index_width_turns: f64,
    /// Delay from the edge of the flag to that of the line, seconds, 0 to 1 ms.
    pub index_delay_s: f64,
    /// True if the encoder of the motor is read, with `steps_per_turn` counts per turn of the motor.
    pub encoder: bool,
    /// Steps of one electrical cycle of the stepper; 0 if the axis has none.
    pub cycle_steps: u32,
    /// Greatest trim in either direction, turns, 0 to 0.1.
    pub trim_limit_turns: f64,
    /// Rate at which the trim changes, turns/s, above 0, up to 1.
    pub trim_rate_hz: f64,
    /// Inertia of the rotor and of all parts that turn with the motor, kg·m², 0 to 1000.
    pub rotor_inertia_kgm2: f64,
}

impl AxisSettings {
    /// Stepper of 3200 steps per turn on the crank's own shaft, with an index sensor at phase 0.
    pub const DEFAULT: Self = Self {
        drive: DriveKind::Stepper,
        steps_per_turn: 3200,
        gear: Transmission::DIRECT,
        reversed: false,
        follower: FollowerSettings::DIRECT,
        offset_turns: 0.0,
        index_turns: Some(0.0),
        index_width_turns: 0.0,
        index_delay_s: 0.0,
        encoder: false,
        cycle_steps: 64,
        trim_limit_turns: 5.0 / 360.0,
        trim_rate_hz: 1.0 / 360.0,
        rotor_inertia_kgm2: 0.0,
    };

    /// Steps, or encoder counts, per turn of the crank.
    pub const fn steps_per_crank_turn(&self) -> StepsPerTurn {
        let gear = (self.gear.motor_turns, self.gear.crank_turns);
        StepsPerTurn::geared(self.steps_per_turn, gear)
    }

    /// Electrical cycle of a stepper, turns of the crank; 0 if the axis has none.
    pub fn cycle_turns(&self) -> f64 {
        let cycle_steps = f64::from(self.cycle_steps);
        self.steps_per_crank_turn().turns_of(cycle_steps)
    }
}

/// Correction of phase errors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct CorrectionSettings {
    /// Gain of the correction: the fraction of a difference between cranks that is trimmed in a turn, 0 (never) to 1.
    pub gain: f64,
    /// True if homing proves the wiring: it trims each crank by an amount of its own, and only that crank may follow.
    pub prove_wiring: bool,
    /// Proportional gain of the servos' cross-coupling, from the deviation from the mean of all axes, 0 to 20.
    pub coupling: f64,
    /// Integral gain of the cross-coupling, 1/s, 0 to 10,000.
    pub coupling_per_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self::new()
    }
}

impl CorrectionSettings {
    /// No correction: within the limits phase errors are only monitored.
    pub const NONE: Self = Self {
        gain: 0.0,
        prove_wiring: false,
        coupling: 0.0,
        coupling_per_s: 0.0,
    };
}

impl Settings {
    /// Creates settings without axes or program, for a caller to fill in.
    pub const fn new() -> Self {
        Self {
            name: heapless::String::new(),
            tick_hz: 0,
            clock_hz: 0,
            machine: MachineSettings::Shafts(ShaftSettings { length_m: 0.0 }),
            limits: LimitSettings {
                speed_hz: 0.0,
                acceleration_hz_per_s: 0.0,
                jerk_hz_per_s2: 0.0,
                stop_acceleration_hz_per_s: 0.0,
                stop_jerk_hz_per_s2: 0.0,
                homing_speed_hz: 0.0,
                bands: heapless::Vec::new(),
            },
            pulse: PulseSettings::DEFAULT,
            index: IndexSettings::DEFAULT,
            axes: heapless::Vec::new(),
            cams: heapless::Vec::new(),
            trims_turns: heapless::Vec::new(),
            drift: Drift::DEFAULT,
            correction: CorrectionSettings::NONE,
            park_turns: 0.0,
            settle_s: 0.0,
            has_brake: false,
            wiring: WiringSettings::DEFAULT,
            host_loss: HostLossSettings::NONE,
            program: heapless::Vec::new(),
        }
    }

    /// Mechanism of the machine, for this tick rate.
    #[cold]
    pub fn mechanism(&self) -> AnyMechanism {
        self.machine.mechanism(self.tick_hz)
    }

    /// Creates a builder of programs for this machine, which empties `program` first.
    #[cold]
    pub fn program_builder<'a>(&self, program: &'a mut Program) -> ProgramBuilder<'a> {
        ProgramBuilder::new(
            self.tick_hz,
            self.mechanism(),
            self.limits.speed_hz,
            program,
        )
    }

    /// Replaces a program by that of these settings.
    #[cold]
    pub(crate) fn fill_program(&self, program: &mut Program) -> Result<(), SettingsError> {
        let mut builder = self.program_builder(program);
        for (i, entry) in self.program.iter().enumerate() {
            builder.entry(entry).map_err(|error| error.on_entry(i))?;
        }
        builder.finish()
    }

    /// Keeps one axis of several, for bring-up: its crank can be homed and jogged while its rod is detached. Corrections
    /// and the program, which are for all axes together, are removed. Returns false, without a change, if there is no such
    /// axis.
    #[cold]
    pub fn keep_axis(&mut self, number: usize) -> bool {
        let Some(&axis) = self.axes.get(number) else {
            return false;
        };
        let trim = self.trims_turns.get(number).copied().unwrap_or(0.0);
        self.axes.clear();
        self.trims_turns.clear();
        self.program.clear();
        // Each list has room for one entry.
        let _ = self.axes.push(axis);
        let _ = self.trims_turns.push(trim);
        let _ = self.program.push(EntrySettings::Segment(SegmentSettings {
            amax_mps2: 0.0,
            ramp_s: 0.1,
            hold_s: 0.0,
            shape: Shape::Linear,
        }));
        self.correction = CorrectionSettings::NONE;
        true
    }

    /// Removes the index sensors, so that the loop does not judge by them: for bring-up, which measures their pulses.
    #[cold]
    pub fn ignore_index(&mut self) {
        for axis in &mut self.axes {
            axis.index_turns = None;
        }
    }

    /// Cycles of the step clock in one control tick.
    pub const fn tick_cycles(&self) -> u32 {
        self.clock_hz / self.tick_hz
    }

    /// Width of the index filter in cycles of the step clock, rounded to the nearest.
    #[cold]
    pub fn index_width_cycles(&self) -> u32 {
        libm::round(self.index.width_us * 1e-6 * f64::from(self.clock_hz)) as u32
    }
}

/// Cuts a name to [`NAME_BYTES`], between characters.
#[cold]
pub fn short_name(name: &str) -> heapless::String<NAME_BYTES> {
    let mut short = heapless::String::new();
    for c in name.chars() {
        if short.push(c).is_err() {
            break;
        }
    }
    short
}
