//! Limits on the modes.

use core::hash::{Hash, Hasher};

use super::modes::{Modes, Mount};
use crate::functions::multiply;
use crate::settings::{Drift, MachineSettings, turns};
use crate::supervisor::FaultKind;
use crate::units::Turns;

/// Limits of the platform, turns of crank angle.
#[derive(Clone, Copy, Debug, Hash)]
pub(super) struct Limits {
    tilt: Turns,
    warp: Turns,
}

impl Limits {
    /// Limit that the modes exceed by `margin`, if they do.
    pub(super) fn exceeded(&self, modes: &Modes, margin: Turns) -> Option<FaultKind> {
        let tilt = self.tilt.wrapping_add(margin);
        if square(modes.tilt_x) + square(modes.tilt_y) > square(tilt) {
            Some(FaultKind::Tilt)
        } else if modes.warp > self.warp.wrapping_add(margin) {
            Some(FaultKind::Warp)
        } else {
            None
        }
    }
}

/// Limits on the modes, in turns of crank angle.
///
/// A limit on tilt is one on the platform: an error of mode 1 with amplitude e (radians of crank) at a
/// mount radius ρ tilts it by s(α) R e/ρ. The limit is for the crank angle at which that is worst, so
/// that one measurement a turn bounds the tilt over the whole turn. Shafts without a platform have one limit for all modes, in degrees.
///
/// A crank beyond a limit must be detected whatever the error of its reading is. So where one has moved, the limits are lower by a
/// reading error. That covers the error of one crank in each mode. If all readings err at once, a tilt errs by up to √2 of it, and by
/// more if sensors are missing ([`Mount::with`]).
#[derive(Clone, Copy, Debug)]
pub struct DriftLimits {
    /// Limits on the cranks themselves.
    pub(super) of_cranks: Limits,
    pub(super) common: Turns,
    /// Delay with which all axes follow, `lag_us` in ticks, 16 fraction bits.
    lag: i64,
    /// Error of a reading, turns.
    pub(super) reading: Turns,
}

impl DriftLimits {
    /// Limits of a monitor without axes: zero.
    pub(super) const NONE: Self = {
        const NONE: Limits = Limits {
            tilt: Turns::ZERO,
            warp: Turns::ZERO,
        };
        Self {
            of_cranks: NONE,
            common: Turns::ZERO,
            lag: 0,
            reading: Turns::ZERO,
        }
    };

    /// Hashes one half.
    #[inline(always)]
    pub(crate) fn hash_half(&self, second: bool, hasher: &mut impl Hasher) {
        let Self {
            of_cranks,
            common,
            lag,
            reading,
        } = self;
        if second {
            (lag, reading).hash(hasher);
        } else {
            (of_cranks, common).hash(hasher);
        }
    }

    /// Limits from checked settings.
    #[cold]
    pub fn new(settings: &Drift, machine: &MachineSettings, tick_hz: u32) -> Self {
        let warp = turns(settings.warp_limit_deg / 360.0);
        let tilt = machine.platform().map_or(warp, |_| {
            turns((settings.tilt_limit_mrad / machine.tilt_mrad_per_turn(tick_hz)).min(0.5))
        });
        let reading = turns(settings.reading_error_deg / 360.0);
        Self {
            of_cranks: Limits { tilt, warp },
            common: turns(settings.common_limit_deg / 360.0),
            lag: libm::round(settings.lag_us * 1e-6 * f64::from(tick_hz) * 65_536.0) as i64,
            reading,
        }
    }

    /// Limits on readings of cranks that have moved: lower by a reading error.
    pub(super) fn of_readings(&self) -> Limits {
        // A limit that is narrower than two reading errors is halved, so that some of it is left.
        let less = |limit: Turns| {
            let half = Turns::from_bits(limit.to_bits() / 2);
            limit.wrapping_sub(self.reading).max(half)
        };
        Limits {
            tilt: less(self.of_cranks.tilt),
            warp: less(self.of_cranks.warp),
        }
    }

    /// The common lag as a fault, if it exceeds its limit at this speed of the master, turns per tick.
    pub(super) fn of_common(&self, modes: &Modes, speed: Turns) -> Option<FaultKind> {
        (self.beyond_natural(modes, speed).abs() > self.common).then_some(FaultKind::CommonLag)
    }

    /// Common phase error, without the lag that belongs to the speed.
    pub(super) fn beyond_natural(&self, modes: &Modes, speed: Turns) -> Turns {
        modes.common.wrapping_add(self.natural(speed))
    }

    /// Lag that belongs to the speed: speed times `lag_us`.
    pub(super) fn natural(&self, speed: Turns) -> Turns {
        Turns::from_bits((speed.to_bits() >> 16).wrapping_mul(self.lag))
    }

    /// Phase error with which one of `count` axes alone exceeds a limit, turns.
    #[cold]
    pub(super) fn single_axis_limit(&self, mount: &Mount, axis: usize, count: usize) -> Turns {
        let (tilt, warp) = mount.single_axis_limit(axis);
        let max = |limit: Turns, share: f64| {
            if share > 1e-6 {
                limit.to_num::<f64>() / share
            } else {
                f64::INFINITY
            }
        };
        let limits = self.of_readings();
        let min = max(limits.tilt, tilt).min(max(limits.warp, warp));
        // With one sensor, only the common lag is known.
        let common = self.common.to_num::<f64>() * count as f64;
        turns(min.min(common).min(0.25))
    }
}

/// The square, in units of 2⁻³⁰ turn, of up to 2 turns: the sum of two fits.
const fn square(turns: Turns) -> u64 {
    let scaled = (turns.to_bits().unsigned_abs() >> 18) as u32;
    multiply(scaled, scaled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{ShaftSettings, sample};

    /// If this fails, shafts of a large machine are stopped within the limit that their scene gives.
    #[test]
    fn shafts_have_the_limit_of_their_settings_whatever_their_length() {
        let mut drift = sample::settings(2).drift;
        for (length_m, limit_deg) in [(1e-4, 90.0), (0.5, 90.0), (1.0, 90.0), (0.5, 0.01)] {
            drift.warp_limit_deg = limit_deg;
            let machine = MachineSettings::Shafts(ShaftSettings { length_m });
            let limits = DriftLimits::new(&drift, &machine, 2000).of_cranks;
            assert_eq!(limits.tilt, turns(limit_deg / 360.0), "{length_m} m");
            assert_eq!(limits.warp, limits.tilt);
        }
    }
}
