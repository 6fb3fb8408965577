//! Settings of the shaft and of the step lines, in Hz and nanoseconds.
//!
//! They are checked once. The shaft and the planner then use coefficients in turns, ticks and cycles.

mod error;
pub mod key;

pub use error::{Number, Problem, SettingsError, inside};

use crate::keys;
use crate::units::{FRACTION_BITS, Turns};
use key::{Key, needed, or};

/// Range of a tick's length in cycles of the step clock, for which planner and monitor have the bits: times have 14
/// fraction bits in 32.
const MIN_TICK_CYCLES: u32 = 1 << 11;
const MAX_TICK_CYCLES: u32 = (1 << 18) - 1;

/// Greatest number of forbidden bands of a shaft.
pub const MAX_BANDS: usize = 4;

/// Cycles in a tick, of a step clock of `clock_hz` cycles per second and `tick_hz` ticks per second, which is not 0.
///
/// # Errors
/// A tick is not a whole number of cycles, or not 2048 to 262,143 of them.
#[cold]
pub const fn tick_cycles(clock_hz: u32, tick_hz: u32) -> Result<u32, SettingsError> {
    let cycles = clock_hz / tick_hz;
    let is_whole = clock_hz.is_multiple_of(tick_hz);
    if !is_whole || cycles < MIN_TICK_CYCLES || cycles > MAX_TICK_CYCLES {
        let problem = Problem::StepClock {
            clock_hz,
            tick_hz,
            min: MIN_TICK_CYCLES,
            max: MAX_TICK_CYCLES,
        };
        return Err(SettingsError::new("clock_hz", problem));
    }
    Ok(cycles)
}

/// Limits of the master shaft. [`LimitSettings::check`] checks their ranges.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct LimitSettings {
    /// Greatest speed, rev/s, in the range of [`SPEED_HZ`].
    pub speed_hz: f64,
    /// Greatest acceleration, rev/s², in the range of [`ACCELERATION_HZ_PER_S`].
    pub acceleration_hz_per_s: f64,
    /// Greatest jerk, rev/s³, in the range of [`JERK_HZ_PER_S2`].
    pub jerk_hz_per_s2: f64,
    /// Greatest acceleration of a fault stop (stop category 1), rev/s², not below the usual one: as much as the motors'
    /// torque allows.
    pub stop_acceleration_hz_per_s: f64,
    /// Greatest jerk of a fault stop, rev/s³, not below the usual one.
    pub stop_jerk_hz_per_s2: f64,
    /// Homing speed, rev/s, in the range of [`HOMING_SPEED_HZ`]: the slow speed that finds the index pulses and a parking phase.
    pub homing_speed_hz: f64,
    /// Forbidden bands: speeds at which the machine must not dwell, lowest first.
    pub bands: heapless::Vec<BandSettings, MAX_BANDS>,
}

/// Forbidden band: the shaft crosses its speeds without dwelling. Its edges are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct BandSettings {
    /// Lower edge, rev/s.
    pub from_hz: f64,
    /// Upper edge, rev/s.
    pub to_hz: f64,
}

keys! {
    /// Timing that the drives' inputs require.
    pub struct PulseSettings in "pulse" {
        /// Shortest time that STEP is high, and low. It limits the step rate: 781,250 steps/s, or 1 M with 288.
        width_ns: f64 = or(400.0).from(8.0, 100_000.0).because("what drives ask for and the step clock makes"),
        /// Shortest time that DIR is stable before a rising edge of STEP.
        dir_setup_ns: f64 = or(500.0).from(0.0, 100_000.0),
        /// Shortest time that DIR is stable after a rising edge of STEP.
        dir_hold_ns: f64 = or(500.0).from(0.0, 100_000.0),
    }
}

/// Tick rates, Hz.
pub const TICK_HZ: core::ops::RangeInclusive<u32> = 500..=10_000;

/// Least acceleration and jerk, in units of the last place. The shaft's exact stop rounds the jerk by up to four units; below this limit
/// that would be a noticeable part of it.
const MIN_BITS: f64 = 64.0 / (1_u64 << FRACTION_BITS) as f64;
/// The same, in rev/s² and rev/s³.
const MIN: f64 = 0.01;

const MAX_SPEED_HZ: f64 = 200.0;
const MAX_TICK_HZ: f64 = *TICK_HZ.end() as f64;
const RESOLUTION: &str = "what a tick can resolve and limits.speed_hz can use";

/// `limits.speed_hz`
pub const SPEED_HZ: Key = needed("60")
    .from(0.1, MAX_SPEED_HZ)
    .because("the speeds that such cranks are turned at");
/// `limits.acceleration_hz_per_s`
pub const ACCELERATION_HZ_PER_S: Key = needed("25")
    .from(MIN, MAX_SPEED_HZ * MAX_TICK_HZ)
    .at_least(MIN_BITS, &[("control.tick_hz", 2)])
    .at_most(1.0, &[("limits.speed_hz", 1), ("control.tick_hz", 1)])
    .because(RESOLUTION);
/// `limits.jerk_hz_per_s2`
pub const JERK_HZ_PER_S2: Key = needed("250")
    .from(MIN, MAX_SPEED_HZ * MAX_TICK_HZ * MAX_TICK_HZ)
    .at_least(MIN_BITS, &[("control.tick_hz", 3)])
    .at_most(1.0, &[("limits.speed_hz", 1), ("control.tick_hz", 2)])
    .because(RESOLUTION);
/// `limits.stop_acceleration_hz_per_s`: a fault stop is at least as fast as any other.
pub const STOP_ACCELERATION_HZ_PER_S: Key = ACCELERATION_HZ_PER_S
    .or_left_out()
    .such_as("100")
    .at_least(1.0, &[("limits.acceleration_hz_per_s", 1)])
    .because("not below the usual one, and within what limits.speed_hz can use");
/// `limits.stop_jerk_hz_per_s2`
pub const STOP_JERK_HZ_PER_S2: Key = JERK_HZ_PER_S2
    .or_left_out()
    .such_as("1000")
    .at_least(1.0, &[("limits.jerk_hz_per_s2", 1)])
    .because("not below the usual one, and within what limits.speed_hz can use");
/// `limits.homing_speed_hz`
pub const HOMING_SPEED_HZ: Key = or(1.0)
    .from(0.01, 10.0)
    .at_most(1.0, &[("limits.speed_hz", 1)])
    .because("slow enough to find an index pulse at, and within limits.speed_hz");
/// `limits.band.from_hz` and `limits.band.to_hz`
pub const BAND_HZ: Key = needed("10").from(0.0, MAX_SPEED_HZ);

/// Longest ramp to full speed: its time, and the turns at full speed in that time.
const MAX_RAMP_S: f64 = 600.0;
const MAX_RAMP_TURNS: f64 = 30_000.0;

/// Least gap between two forbidden bands, and between the homing speed and the first band.
const MIN_GAP_HZ: f64 = 1e-3;

impl LimitSettings {
    /// Greatest acceleration that the shaft can reach, rev/s²: the limit, or less where the jerk bounds it.
    ///
    /// Reducing an acceleration a to zero at the jerk J gains a²/2J of speed. Between rest and full speed V the
    /// acceleration therefore stays below sqrt(2 J V). The result is at most 2 sqrt(J V), which is above that.
    pub fn reachable_acceleration_hz_per_s(&self) -> f64 {
        self.reachable(self.acceleration_hz_per_s, self.jerk_hz_per_s2)
    }

    /// Greatest acceleration that a fault stop can reach, rev/s². It is the greatest of all, as no limit of that stop is
    /// below the usual one.
    ///
    /// Reducing it to zero takes at most 2 sqrt(V/J), which is the minimum of V/a + a/J. So the check of the usual
    /// ramp's length covers this one.
    #[cold]
    pub fn reachable_stop_acceleration_hz_per_s(&self) -> f64 {
        self.reachable(self.stop_acceleration_hz_per_s, self.stop_jerk_hz_per_s2)
    }

    fn reachable(&self, acceleration_hz_per_s: f64, jerk_hz_per_s2: f64) -> f64 {
        acceleration_hz_per_s.min(2.0 * libm::sqrt(jerk_hz_per_s2 * self.speed_hz))
    }

    /// Checks every number alone and against the others, for a tick rate in Hz.
    ///
    /// # Errors
    /// The first setting that is wrong, with its key and the problem.
    #[cold]
    pub fn check(&self, tick_hz: f64) -> Result<(), SettingsError> {
        let speed_hz = self.speed_hz;
        let others = [
            ("control.tick_hz", tick_hz),
            ("limits.speed_hz", speed_hz),
            ("limits.acceleration_hz_per_s", self.acceleration_hz_per_s),
            ("limits.jerk_hz_per_s2", self.jerk_hz_per_s2),
        ];
        SPEED_HZ.check("limits.speed_hz", speed_hz)?;
        ACCELERATION_HZ_PER_S.check_beside(
            &others,
            "limits.acceleration_hz_per_s",
            self.acceleration_hz_per_s,
        )?;
        JERK_HZ_PER_S2.check_beside(&others, "limits.jerk_hz_per_s2", self.jerk_hz_per_s2)?;
        STOP_ACCELERATION_HZ_PER_S.check_beside(
            &others,
            "limits.stop_acceleration_hz_per_s",
            self.stop_acceleration_hz_per_s,
        )?;
        STOP_JERK_HZ_PER_S2.check_beside(
            &others,
            "limits.stop_jerk_hz_per_s2",
            self.stop_jerk_hz_per_s2,
        )?;
        // The distance of a ramp must fit in the format of the phase, which holds 32,768 turns.
        let acceleration = self.reachable_acceleration_hz_per_s();
        let ramp_s = speed_hz / acceleration + acceleration / self.jerk_hz_per_s2;
        if ramp_s > MAX_RAMP_S || ramp_s * speed_hz > MAX_RAMP_TURNS {
            return Err(SettingsError::new(
                "limits.acceleration_hz_per_s",
                Problem::RampTooLong {
                    ramp_s,
                    turns: ramp_s * speed_hz,
                },
            ));
        }
        HOMING_SPEED_HZ.check_beside(&others, "limits.homing_speed_hz", self.homing_speed_hz)?;
        let mut below = self.homing_speed_hz;
        for (i, band) in self.bands.iter().enumerate() {
            let place = |e: SettingsError| e.on_entry(i);
            BAND_HZ
                .check("limits.band.from_hz", band.from_hz)
                .map_err(place)?;
            BAND_HZ
                .check("limits.band.to_hz", band.to_hz)
                .map_err(place)?;
            if band.to_hz <= band.from_hz {
                return Err(place(SettingsError::new(
                    "limits.band.to_hz",
                    Problem::BandUpsideDown(band.from_hz, band.to_hz),
                )));
            }
            // A tiny gap between two bands would vanish when their edges become integers.
            if band.from_hz - below < MIN_GAP_HZ {
                let problem = if i == 0 {
                    Problem::BandCoversHomingSpeed(band.from_hz, below)
                } else {
                    Problem::BandsOverlap(band.from_hz, below)
                };
                return Err(place(SettingsError::new("limits.band.from_hz", problem)));
            }
            if band.to_hz >= speed_hz {
                return Err(place(SettingsError::new(
                    "limits.band.to_hz",
                    Problem::BandCoversTop(band.to_hz, speed_hz),
                )));
            }
            below = band.to_hz;
        }
        Ok(())
    }
}

/// Converts a checked number of turns, to the nearest 2⁻⁴⁸ turn.
#[cold]
pub fn turns(value: f64) -> Turns {
    Turns::saturating_from_num(value)
}

/// Converts a checked limit in turns to units of 2⁻⁴⁸, rounded down so that it stays within the setting.
pub fn turns_at_most(value: f64) -> i64 {
    libm::floor(value * (1_u64 << FRACTION_BITS) as f64) as i64
}
