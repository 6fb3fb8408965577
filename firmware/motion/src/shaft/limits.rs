//! The master shaft's limits, as the tick uses them.

use super::Band;
use super::gain::Gain;
use crate::settings::{LimitSettings, MAX_BANDS, turns_at_most};

/// Limits in units of 2⁻⁴⁸ turn and one tick, rounded so that keeping to them keeps to the settings.
#[derive(Clone, Debug)]
pub struct ShaftLimits {
    /// Turns a tick.
    pub(crate) speed: i64,
    /// The slow speed, turns a tick.
    pub(crate) creep: i64,
    /// Forbidden bands, lowest first, apart from each other, between creep and greatest speed.
    pub(crate) bands: heapless::Vec<Band, MAX_BANDS>,
    /// How fast the speed may change.
    pub(crate) usual: RampLimits,
    /// … in a stop that a fault asks for; not slower.
    pub(crate) fault: RampLimits,
    /// … in a stop at a phase: gentler than `usual` by what rounding its phase may add.
    pub(super) parking: RampLimits,
}

/// How fast the speed may change.
#[derive(Clone, Debug)]
pub(crate) struct RampLimits {
    /// Turns a tick².
    pub acceleration: i64,
    /// Turns a tick³.
    pub jerk: i64,
    /// What the speed gains while an acceleration is let go.
    pub(super) gain: Gain,
    /// What it still gains from the limit.
    pub(super) gain_from_limit: u64,
}

impl RampLimits {
    /// Up to `speed`, turns a tick.
    #[cold]
    fn new(acceleration_hz_per_s: f64, jerk_hz_per_s2: f64, speed: i64, hz: f64) -> Self {
        let acceleration = turns_at_most(acceleration_hz_per_s / (hz * hz)).max(1);
        let jerk = turns_at_most(jerk_hz_per_s2 / (hz * hz * hz)).max(1);
        Self::within(acceleration, jerk, acceleration, speed)
    }

    /// For limits of which accelerations up to `asked` are asked about.
    const fn within(acceleration: i64, jerk: i64, asked: i64, speed: i64) -> Self {
        let gain = Gain::new(
            jerk.unsigned_abs(),
            asked.unsigned_abs(),
            speed.unsigned_abs(),
        );
        Self {
            acceleration,
            jerk,
            gain_from_limit: gain.of(acceleration.unsigned_abs()),
            gain,
        }
    }

    /// Limits that a motion may keep whose phase is rounded afterwards, by less than a unit: that changes the
    /// acceleration by less than two and the jerk by less than four.
    #[cold]
    fn before_rounding(&self, speed: i64) -> Self {
        let acceleration = (self.acceleration - 2).max(1);
        let jerk = (self.jerk - 4).max(1);
        Self::within(acceleration, jerk, self.acceleration, speed)
    }
}

impl ShaftLimits {
    /// Limits of a shaft that is not to move.
    pub const STANDSTILL: Self = {
        const RAMP: RampLimits = RampLimits::within(64, 64, 64, 1);
        Self {
            speed: 1,
            creep: 1,
            bands: heapless::Vec::new(),
            usual: RAMP,
            fault: RAMP,
            parking: RAMP,
        }
    };

    /// From settings that [`crate::settings::Settings::check`] has passed.
    #[cold]
    pub fn of(settings: &LimitSettings, tick_hz: u32) -> Self {
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
            creep: turns_at_most(settings.creep_hz / hz).max(1),
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

    /// The slow speed, turns a tick.
    pub const fn creep(&self) -> crate::units::Turns {
        crate::units::Turns::from_bits(self.creep)
    }
}
