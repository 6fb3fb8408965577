//! Settings of the shaft and of the step lines, in Hz and nanoseconds.
//!
//! They are checked once; the shaft and the planner then work on coefficients in turns, ticks and cycles.

mod error;

use error::finite;
pub use error::{Number, Problem, SettingsError, inside};

use crate::units::{FRACTION_BITS, Turns};

/// Clock of the step hardware: one cycle is 8 ns.
pub const CLOCK_HZ: u32 = 125_000_000;

/// How many forbidden bands a shaft may have.
pub const MAX_BANDS: usize = 4;

/// What the master shaft may do.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LimitSettings {
    /// Greatest speed, rev/s, up to 200.
    pub speed_hz: f64,
    /// Greatest acceleration, rev/s².
    pub acceleration_hz_per_s: f64,
    /// Greatest jerk, rev/s³.
    pub jerk_hz_per_s2: f64,
    /// Greatest acceleration of a stop that a fault asks for, rev/s², not below the usual one: what the motors'
    /// torque allows.
    pub stop_acceleration_hz_per_s: f64,
    /// Its greatest jerk, rev/s³, not below the usual one.
    pub stop_jerk_hz_per_s2: f64,
    /// Speed of the slow turn that finds the index pulses and a parking phase, rev/s.
    pub creep_hz: f64,
    /// Speeds at which the machine must not dwell, lowest first.
    pub bands: heapless::Vec<BandSettings, MAX_BANDS>,
}

/// A band of speeds that is crossed, never dwelt in; its edges are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BandSettings {
    /// Lower edge, rev/s.
    pub from_hz: f64,
    /// Upper edge, rev/s.
    pub to_hz: f64,
}

/// Timing that the drives' inputs ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PulseSettings {
    /// Shortest time that STEP must stay high, and low, nanoseconds.
    pub width_ns: f64,
    /// DIR must be stable this long before a rising STEP edge, nanoseconds.
    pub dir_setup_ns: f64,
    /// DIR must stay this long after a rising STEP edge, nanoseconds.
    pub dir_hold_ns: f64,
}

impl PulseSettings {
    /// Checks every number by itself.
    ///
    /// # Errors
    /// The first setting that is wrong.
    #[cold]
    pub fn check(&self) -> Result<(), SettingsError> {
        inside("pulse.width_ns", self.width_ns, 8.0, 100_000.0)?;
        inside("pulse.dir_setup_ns", self.dir_setup_ns, 0.0, 100_000.0)?;
        inside("pulse.dir_hold_ns", self.dir_hold_ns, 0.0, 100_000.0)?;
        Ok(())
    }
}

/// The shaft's exact stop rounds by up to four units of the last place of jerk; below this the
/// rounding would be a noticeable part of the limit.
const LEAST_JERK_BITS: f64 = 64.0;

/// Longest way to full speed: time, and turns at full speed for that time.
const MOST_RAMP_S: f64 = 600.0;
const MOST_RAMP_TURNS: f64 = 30_000.0;

/// Least room between two forbidden bands, and between the creep speed and the first.
const LEAST_GAP_HZ: f64 = 1e-3;

impl LimitSettings {
    /// The acceleration limit, or what the jerk lets the shaft reach at all: between rest and full
    /// speed V its acceleration stays below sqrt(2 J V), as letting it go gains a²/2J of speed.
    pub fn reachable_acceleration_hz_per_s(&self) -> f64 {
        self.reachable(self.acceleration_hz_per_s, self.jerk_hz_per_s2)
    }

    /// The same in a stop that a fault asks for. It is the greatest of all, as no limit of that stop is below the usual.
    ///
    /// Letting it go takes 2 sqrt(V/J) at most, which is the least that V/a + a/J can be: the check of the usual ramp's
    /// length holds for this one too.
    pub fn reachable_stop_acceleration_hz_per_s(&self) -> f64 {
        self.reachable(self.stop_acceleration_hz_per_s, self.stop_jerk_hz_per_s2)
    }

    fn reachable(&self, acceleration_hz_per_s: f64, jerk_hz_per_s2: f64) -> f64 {
        acceleration_hz_per_s.min(2.0 * libm::sqrt(jerk_hz_per_s2 * self.speed_hz))
    }

    /// Checks every number by itself and against the others, for a tick rate in Hz.
    ///
    /// # Errors
    /// The first setting that is wrong.
    #[cold]
    pub fn check(&self, tick_hz: f64) -> Result<(), SettingsError> {
        let one = (1_u64 << FRACTION_BITS) as f64;
        let speed_hz = inside("limits.speed_hz", self.speed_hz, 0.1, 200.0)?;
        let least = LEAST_JERK_BITS / one * tick_hz * tick_hz;
        inside(
            "limits.acceleration_hz_per_s",
            self.acceleration_hz_per_s,
            least.max(0.01),
            speed_hz * tick_hz,
        )?;
        inside(
            "limits.jerk_hz_per_s2",
            self.jerk_hz_per_s2,
            (least * tick_hz).max(0.01),
            speed_hz * tick_hz * tick_hz,
        )?;
        // A fault's stop is at least as fast as any other.
        inside(
            "limits.stop_acceleration_hz_per_s",
            self.stop_acceleration_hz_per_s,
            self.acceleration_hz_per_s,
            speed_hz * tick_hz,
        )?;
        inside(
            "limits.stop_jerk_hz_per_s2",
            self.stop_jerk_hz_per_s2,
            self.jerk_hz_per_s2,
            speed_hz * tick_hz * tick_hz,
        )?;
        // A ramp's way is to fit into the phase's own format, which holds 32,768 turns.
        let acceleration = self.reachable_acceleration_hz_per_s();
        let ramp_s = speed_hz / acceleration + acceleration / self.jerk_hz_per_s2;
        if ramp_s > MOST_RAMP_S || ramp_s * speed_hz > MOST_RAMP_TURNS {
            return Err(SettingsError::new(
                "limits.acceleration_hz_per_s",
                Problem::RampTooLong {
                    ramp_s,
                    turns: ramp_s * speed_hz,
                },
            ));
        }
        inside("limits.creep_hz", self.creep_hz, 0.01, speed_hz.min(10.0))?;
        let mut below = self.creep_hz;
        for (i, band) in self.bands.iter().enumerate() {
            let place = |e: SettingsError| e.on_entry(i);
            finite("limits.band.from_hz", band.from_hz).map_err(place)?;
            finite("limits.band.to_hz", band.to_hz).map_err(place)?;
            if band.to_hz <= band.from_hz {
                return Err(place(SettingsError::new(
                    "limits.band.to_hz",
                    Problem::BandUpsideDown(band.from_hz, band.to_hz),
                )));
            }
            // A hair between two bands would be lost when their edges become whole numbers.
            if band.from_hz - below < LEAST_GAP_HZ {
                let problem = if i == 0 {
                    Problem::BandCoversCreep(band.from_hz, below)
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

/// A checked number of turns, to the nearest unit of the last place.
pub fn turns(value: f64) -> Turns {
    Turns::saturating_from_num(value)
}

/// A checked limit in turns, rounded down so that keeping to it keeps to what was asked.
pub fn turns_at_most(value: f64) -> i64 {
    libm::floor(value * (1_u64 << FRACTION_BITS) as f64) as i64
}
