//! Limits of the master shaft as coefficients of the tick.

use core::hash::{Hash, Hasher};

use super::Band;
use super::gain::{Gain, Step};
use crate::settings::{LimitSettings, MAX_BANDS, turns_at_most};
use crate::units::FRACTION_BITS;

/// Limits of the shaft in units of 2⁻⁴⁸ turn and one tick, rounded so that they stay within the settings.
///
/// Speed, acceleration and jerk are rounded down by less than one unit. Bands are widened by at most one unit on either
/// side.
#[derive(Clone, Debug)]
pub struct ShaftLimits {
    /// Greatest speed, turns a tick.
    pub(crate) speed: i64,
    /// Homing speed, turns a tick.
    pub(crate) homing_speed: i64,
    /// Forbidden bands, lowest first and not touching, between homing speed and greatest speed.
    pub(crate) bands: heapless::Vec<Band, MAX_BANDS>,
    /// Ramp limits of all motion but the stops below.
    pub(crate) usual: RampLimits,
    /// Ramp limits of a fault stop; not slower than `usual`.
    pub(crate) fault: RampLimits,
    /// Ramp limits of a stop at a phase: gentler than `usual` by as much as rounding its phase may add.
    pub(super) parking: RampLimits,
}

/// Limits on the change of speed.
#[derive(Clone, Debug)]
pub(crate) struct RampLimits {
    /// Greatest acceleration, turns a tick².
    pub acceleration: i64,
    /// Greatest jerk, turns a tick³.
    pub jerk: i64,
    /// Speed gained while an acceleration is released.
    pub(super) gain: Gain,
    /// Step of the gain at or below the greatest acceleration.
    pub(super) limit: Step,
    /// Speed gained by one tick of the greatest acceleration and its release.
    pub(super) gain_from_limit: u64,
}

impl RampLimits {
    /// Ramp limits for speeds up to `speed`, turns a tick.
    #[cold]
    fn new(acceleration_hz_per_s: f64, jerk_hz_per_s2: f64, speed: i64, hz: f64) -> Self {
        let acceleration = turns_at_most(acceleration_hz_per_s / (hz * hz)).max(1);
        let jerk = turns_at_most(jerk_hz_per_s2 / (hz * hz * hz)).max(1);
        Self::within(acceleration, jerk, acceleration, speed)
    }

    /// Ramp limits in units. The gain covers accelerations up to `requested`.
    #[cold]
    const fn within(acceleration: i64, jerk: i64, requested: i64, speed: i64) -> Self {
        let gain = Gain::new(
            jerk.unsigned_abs(),
            requested.unsigned_abs(),
            speed.unsigned_abs(),
        );
        let limit = gain.step(acceleration.unsigned_abs());
        Self {
            acceleration,
            jerk,
            gain_from_limit: gain.above(&limit, acceleration.unsigned_abs()),
            limit,
            gain,
        }
    }

    /// Hashes one of four slices.
    #[inline(always)]
    fn hash_slice(&self, slice: usize, hasher: &mut impl Hasher) {
        let Self {
            acceleration,
            jerk,
            gain,
            limit,
            gain_from_limit,
        } = self;
        match slice {
            0 => (acceleration, jerk, gain_from_limit).hash(hasher),
            1 => limit.hash(hasher),
            _ => gain.hash_half(slice == 3, hasher),
        }
    }

    /// Limits for a motion whose phase is rounded afterwards, by less than a unit. The rounding changes the acceleration
    /// by less than two units and the jerk by less than four.
    #[cold]
    fn before_rounding(&self, speed: i64) -> Self {
        let acceleration = (self.acceleration - 2).max(1);
        let jerk = (self.jerk - 4).max(1);
        Self::within(acceleration, jerk, self.acceleration, speed)
    }
}

impl ShaftLimits {
    /// Limits of a shaft that does not move.
    pub const STANDSTILL: Self = {
        const RAMP: RampLimits = RampLimits::within(64, 64, 64, 1);
        Self {
            speed: 1,
            homing_speed: 1,
            bands: heapless::Vec::new(),
            usual: RAMP,
            fault: RAMP,
            parking: RAMP,
        }
    };

    /// Converts settings that [`LimitSettings::check`] has accepted, for a tick rate in Hz.
    #[cold]
    pub fn from_settings(settings: &LimitSettings, tick_hz: u32) -> Self {
        let hz = f64::from(tick_hz);
        let speed = turns_at_most(settings.speed_hz / hz);
        let usual = RampLimits::new(
            settings.reachable_acceleration_hz_per_s(),
            settings.jerk_hz_per_s2,
            speed,
            hz,
        );
        Self {
            speed,
            homing_speed: turns_at_most(settings.homing_speed_hz / hz).max(1),
            bands: settings
                .bands
                .iter()
                .map(|band| Band {
                    from: turns_at_most(band.from_hz / hz),
                    to: turns_at_most(band.to_hz / hz) + 1,
                })
                .collect(),
            parking: usual.before_rounding(speed),
            usual,
            fault: RampLimits::new(
                settings.reachable_stop_acceleration_hz_per_s(),
                settings.stop_jerk_hz_per_s2,
                speed,
                hz,
            ),
        }
    }

    /// Hashes the limits of speed, and the number of bands.
    #[inline(always)]
    pub fn hash_speeds(&self, hasher: &mut impl Hasher) {
        let Self {
            speed,
            homing_speed,
            bands,
            usual: _,
            fault: _,
            parking: _,
        } = self;
        (speed, homing_speed, bands.len()).hash(hasher);
    }

    /// Hashes one of four slices of some ramp limits. Returns false for the ones after the last.
    #[inline(always)]
    pub fn hash_ramp(&self, number: usize, slice: usize, hasher: &mut impl Hasher) -> bool {
        let ramp = match number {
            0 => &self.usual,
            1 => &self.fault,
            2 => &self.parking,
            _ => return false,
        };
        ramp.hash_slice(slice, hasher);
        true
    }

    /// Forbidden bands.
    pub const fn bands(&self) -> &heapless::Vec<Band, MAX_BANDS> {
        &self.bands
    }

    /// Returns true if a speed, turns a tick, lies in a forbidden band or just above it. The margin above is the speed that the shaft gains
    /// within a turn of full acceleration, v² = to² + 2 a · 1 turn. The reason for the margin is that an index shows the motion of its
    /// crank in the band only once a turn.
    pub fn is_at_band(&self, speed: crate::units::Turns) -> bool {
        // Bits of a speed that are left out, so that a square has 64.
        const CUT: u32 = 20;
        let square = |speed: i64| (speed.unsigned_abs() >> CUT).pow(2);
        let gained = self.usual.acceleration.unsigned_abs() << (1 + FRACTION_BITS - 2 * CUT);
        let speed = speed.to_bits();
        let mut bands = self.bands.iter();
        bands.any(|band| band.from < speed && square(speed) <= square(band.to) + gained)
    }

    /// Homing speed, turns a tick.
    pub const fn homing_speed(&self) -> crate::units::Turns {
        crate::units::Turns::from_bits(self.homing_speed)
    }
}
