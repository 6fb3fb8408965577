//! Trim: a bounded, slow correction of one axis's phase.

use crate::settings::{AxisSettings, turns_at_most};
use crate::units::Turns;

/// Trim of one axis: the present addition to its phase, and its target.
#[derive(Clone, Debug)]
pub struct Trim {
    now: i64,
    target: i64,
    limit: i64,
    rate: i64,
}

impl Trim {
    #[cold]
    pub(super) fn new(settings: &AxisSettings, tick_hz: u32) -> Self {
        Self {
            now: 0,
            target: 0,
            limit: turns_at_most(settings.trim_limit_turns),
            rate: turns_at_most(settings.trim_rate_hz / f64::from(tick_hz)).max(1),
        }
    }

    /// Present trim.
    pub const fn now(&self) -> Turns {
        Turns::from_bits(self.now)
    }

    /// Whether the trim is on its way to its target.
    pub const fn is_moving(&self) -> bool {
        self.now != self.target
    }

    /// Sets the target of the trim; returns false if the limit cut it.
    pub fn set(&mut self, target: Turns) -> bool {
        self.target = target.to_bits().max(-self.limit).min(self.limit);
        self.target == target.to_bits()
    }

    /// Change of the trim in the coming tick.
    #[inline]
    pub(super) fn advance(&mut self) -> Turns {
        if !self.is_moving() {
            return Turns::ZERO;
        }
        let change = (self.target - self.now).max(-self.rate).min(self.rate);
        self.now += change;
        Turns::from_bits(change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::DriveKind;

    #[test]
    fn slews_at_its_rate_and_stays_in_its_limit() {
        let settings = AxisSettings {
            drive: DriveKind::Stepper,
            steps_per_turn: 3200,
            reversed: false,
            ratio: (1, 1),
            offset_turns: 0.0,
            index_turns: None,
            index_width_turns: 0.0,
            index_delay_s: 0.0,
            encoder: false,
            cycle_steps: 0,
            trim_limit_turns: 0.01,
            trim_rate_hz: 0.1,
            rotor_inertia_kgm2: 0.0,
        };
        let mut trim = Trim::new(&settings, 1000);
        assert!(
            !trim.set(Turns::from_num(-0.02)),
            "a limit that cuts must be reported"
        );
        let mut sum = Turns::ZERO;
        for _ in 0..500 {
            let change = trim.advance();
            assert!(change.abs() <= Turns::from_num(1e-4));
            sum += change;
        }
        assert_eq!(sum, trim.now());
        assert_eq!(trim.now(), Turns::from_bits(-trim.limit));
        assert!(trim.set(Turns::ZERO));
    }
}
