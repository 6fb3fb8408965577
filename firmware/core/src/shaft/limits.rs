//! The master shaft's limits, as the tick uses them.

use super::Band;
use super::gain::Gain;
use crate::settings::{LimitSettings, MAX_BANDS, turns_at_most};

/// Limits in units of 2⁻⁴⁸ turn and one tick, rounded so that keeping to them keeps to the settings.
#[derive(Clone, Debug)]
pub struct ShaftLimits {
    /// Turns a tick.
    pub(crate) speed: i64,
    /// Turns a tick².
    pub(crate) acceleration: i64,
    /// Turns a tick³.
    pub(crate) jerk: i64,
    /// The slow speed, turns a tick.
    pub(crate) creep: i64,
    /// Forbidden bands, lowest first, apart from each other, between creep and greatest speed.
    pub(crate) bands: heapless::Vec<Band, MAX_BANDS>,
    /// What the speed gains while an acceleration is let go.
    pub(super) gain: Gain,
    /// What it still gains from the limit.
    pub(super) gain_from_limit: u64,
}

impl ShaftLimits {
    /// From settings that [`crate::settings::Settings::check`] has passed.
    pub fn new(settings: &LimitSettings, tick_hz: u32) -> Self {
        let hz = f64::from(tick_hz);
        let acceleration =
            turns_at_most(settings.reachable_acceleration_hz_per_s() / (hz * hz)).max(1);
        let jerk = turns_at_most(settings.jerk_hz_per_s2 / (hz * hz * hz)).max(1);
        let speed = turns_at_most(settings.speed_hz / hz);
        let gain = Gain::new(
            jerk.unsigned_abs(),
            acceleration.unsigned_abs(),
            speed.unsigned_abs(),
        );
        Self {
            speed,
            acceleration,
            jerk,
            creep: turns_at_most(settings.creep_hz / hz).max(1),
            bands: settings
                .bands
                .iter()
                .map(|band| Band {
                    from: turns_at_most(band.from_hz / hz),
                    to: turns_at_most(band.to_hz / hz) + 1,
                })
                .collect(),
            gain_from_limit: gain.of(acceleration.unsigned_abs()),
            gain,
        }
    }

    /// The slow speed, turns a tick.
    pub const fn creep(&self) -> crate::units::Turns {
        crate::units::Turns::from_bits(self.creep)
    }
}
