//! Electronic gear with an exact ratio.

use core::hash::{Hash, Hasher};

use super::bounds::Bounds;
use super::cam_table::CamSettings;
use super::cams::Cams;
use super::follower::Follower;
use crate::functions::Ratio;
use crate::problem::SettingsError;
use crate::units::Turns;
use cophase_motion::settings::key::{Key, or_value};

/// `axes.ratio`
pub const RATIO: Key = or_value("[1, 1]")
    .from(1.0, 1000.0)
    .of_parts(&["numerator", "denominator"]);

/// Gear ratio of an axis, turns of the axis per turn of the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct GearSettings {
    /// Turns of the axis, in the range of [`RATIO`].
    pub numerator: u32,
    /// Turns of the master, in the range of [`RATIO`].
    pub denominator: u32,
}

impl GearSettings {
    /// Checks both numbers.
    ///
    /// # Errors
    /// The first number that is out of range.
    #[cold]
    pub fn check(&self, _: &[CamSettings]) -> Result<(), SettingsError> {
        RATIO.check("axes.ratio numerator", f64::from(self.numerator))?;
        RATIO.check("axes.ratio denominator", f64::from(self.denominator))?;
        Ok(())
    }

    /// The ratio as one number.
    pub fn ratio(&self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }

    /// Returns the error unchanged: it already names the ratio, or the steps per turn.
    pub const fn too_fast(&self, error: SettingsError, _: f64, _: f64) -> SettingsError {
        error
    }

    /// Turns of the axis per turn of the master.
    pub fn max_ratio(&self, _: &[CamSettings]) -> f64 {
        self.ratio()
    }
}

/// Gear ratio, turns of the axis per turn of the master, as a ratio of two integers. No fraction is lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gear(Ratio);

impl Gear {
    /// Gear of checked settings.
    pub const fn new(settings: &GearSettings, _: &Cams) -> Self {
        Self(Ratio::new(settings.numerator, settings.denominator))
    }
}

impl Follower for Gear {
    #[inline]
    fn advance(&mut self, master: Turns, _: &Cams) -> Turns {
        if self.is_direct() {
            return master; // The usual case needs no division.
        }
        Turns::from_bits(self.0.advance(master.to_bits()))
    }

    /// Acceleration, rounded towards zero; the remainder is dropped. The master's acceleration must be below 1 turn a tick².
    fn acceleration(&self, _: Turns, acceleration: Turns, _: &Cams) -> Turns {
        if self.is_direct() {
            return acceleration;
        }
        Turns::from_bits(self.0.product(acceleration.to_bits()))
    }

    fn hash_constants(&self, hasher: &mut impl Hasher) {
        self.0.constants().hash(hasher);
    }

    fn is_direct(&self) -> bool {
        self.0.is_one()
    }

    #[cold]
    fn start(&self) -> Turns {
        Turns::ZERO
    }

    #[cold]
    fn bounds(&self, master: &Bounds, _: &Cams) -> Bounds {
        let ratio = self.0.to_f64();
        Bounds {
            speed: master.speed * ratio,
            acceleration: master.acceleration * ratio,
            jerk: master.jerk * ratio,
        }
    }

    #[cold]
    fn allows_index(&self, _: &Cams) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axes::NO_CAMS;
    use crate::units::ONE_TURN;
    use proptest::prelude::*;

    proptest! {
        /// If this fails, an axis departs from its exact ratio after some number of ticks, by one unit or more.
        #[test]
        fn travel_of_a_gear_matches_its_exact_ratio(
            numerator in 1_u32..=1000,
            denominator in 1_u32..=1000,
            master in prop::collection::vec(-ONE_TURN..ONE_TURN, 0..200),
        ) {
            let mut gear = Gear::new(&GearSettings { numerator, denominator }, &NO_CAMS);
            let (mut sum, mut axis) = (0_i128, 0_i128);
            for turns in master {
                sum += i128::from(turns);
                axis += i128::from(gear.advance(Turns::from_bits(turns), &NO_CAMS).to_bits());
                let exact = sum * i128::from(numerator);
                prop_assert_eq!(axis, exact.div_euclid(i128::from(denominator)));
                let share = i128::from(turns) * i128::from(numerator) / i128::from(denominator);
                prop_assert_eq!(i128::from(gear.acceleration(Turns::ZERO, Turns::from_bits(turns), &NO_CAMS).to_bits()), share);
            }
        }
    }
}
