//! Crank-rocker that drives a screw: the crank turns all round, the rocker swings, and a screw on the rocker's axis moves the platform.
//!
//! Lengths are over the rocker's. With the crank's pivot as the origin and the rocker's on the x axis, **p** is the crank,
//! **k** the coupler and **r** the rocker as vectors, and ⊥ turns a vector by a quarter turn ahead. The loop
//! **p** + **k** = ground + **r** closes. Its derivatives over the crank angle, each multiplied by **k** or **r**, are
//!
//! - ψ′ = **p**⊥·**k** / **r**⊥·**k**, the rocker's speed,
//! - θ′ = **p**⊥·**r** / **r**⊥·**k**, the coupler's speed,
//! - ψ″ = (ψ′² **r**·**k** − **p**·**k** − θ′² **k**·**k**) / **r**⊥·**k**.
//!
//! Crank phase 0 is the dead centre where crank and coupler are stretched out. The rocker is closest to the ground line there, and the
//! platform farthest from the cranks. So slope and curvature are ψ′ and ψ″ per unit travel, where the *unit* is the travel for one
//! radian of the rocker: the screw's lead over 2π. It takes the place of the crank radius. amax = unit · max|ψ″| · ω².
//!
//! The divisor **r**⊥·**k** is the coupler's length times the cosine of the pressure angle. It is 0 in a branch point, where the
//! linkage jams.

use core::hash::{Hash, Hasher};

use super::{Kinematics, Mechanism, SquareLaw};
use crate::functions::{isqrt, sine_cosine};
use crate::problem::{Problem, SettingsError};
use crate::units::{Amax, Turns};
use cophase_motion::settings::key::{Key, optional};

/// `machine.crank_ratio`
pub const CRANK_RATIO: Key = optional("0.4852094").from(0.1, 0.9);
/// `machine.coupler_ratio`
pub const COUPLER_RATIO: Key = optional("1.5402148").from(0.3, 2.7);
/// `machine.ground_ratio`
pub const GROUND_RATIO: Key = optional("1.927919").from(0.3, 2.7);

/// Settings of the crank-rocker: lengths over the rocker's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", derive(postcard::experimental::max_size::MaxSize))]
pub struct CrankRockerSettings {
    /// Length of the crank, in the range of [`CRANK_RATIO`].
    pub crank: f64,
    /// Length of the coupler, in the range of [`COUPLER_RATIO`].
    pub coupler: f64,
    /// Distance of the two pivots, in the range of [`GROUND_RATIO`].
    pub ground: f64,
}

/// Ratio 1.0 with 28 fraction bits. Lengths are below 8, so that their products fit in 64 bits.
const ONE: i64 = 1 << 28;

/// Greatest sine of a pressure angle: 70°. Closer to a branch point the linkage jams, and the fixed-point error grows.
const MAX_PRESSURE_SINE: f64 = 0.94;

/// Least distance of the crank's pin from the rocker's pivot, over the rocker.
const MIN_DIAGONAL: f64 = 0.25;

/// Range of the greatest curvature: [`Kinematics`] end at 2, and below 0.1 the rocker hardly moves.
const CURVATURES: (f64, f64) = (0.1, 1.95);

impl CrankRockerSettings {
    /// Settings for tests of all mechanisms, those of the middle first.
    pub(super) const SAMPLES: &[Self] = &[
        // That of its source.
        Self::new(0.48521, 1.54021, 1.92792),
        // A short crank.
        Self::new(0.15, 1.0, 1.35),
        // At 70° of pressure.
        Self::new(0.42, 1.5, 2.0),
    ];

    const fn new(crank: f64, coupler: f64, ground: f64) -> Self {
        Self {
            crank,
            coupler,
            ground,
        }
    }

    /// Checks every number, and that they are the lengths of a crank-rocker that does not jam.
    ///
    /// # Errors
    /// A length is out of its range, the crank does not turn all round (Grashof), or the pressure angle is too large.
    #[cold]
    pub fn check(&self) -> Result<(), SettingsError> {
        CRANK_RATIO.check("machine.crank_ratio", self.crank)?;
        COUPLER_RATIO.check("machine.coupler_ratio", self.coupler)?;
        GROUND_RATIO.check("machine.ground_ratio", self.ground)?;
        let refuse = |problem| Err(SettingsError::new("machine.crank_ratio", problem));
        // Each inequality says that the pin reaches the rocker, at the greatest and at the least distance.
        let reaches = self.ground + self.crank < self.coupler + 1.0
            && (self.coupler - 1.0).abs() < self.ground - self.crank;
        if !reaches {
            return refuse(Problem::NotACrankRocker);
        }
        let sine = |diagonal: f64| {
            (diagonal * diagonal - self.coupler * self.coupler - 1.0) / (2.0 * self.coupler)
        };
        let [nearest, farthest] = [self.ground - self.crank, self.ground + self.crank];
        let pressure = sine(nearest).abs().max(sine(farthest).abs());
        if pressure > MAX_PRESSURE_SINE || nearest < MIN_DIAGONAL {
            return refuse(Problem::Jams);
        }
        let curvature = Geometry::new(self).max(|motion| motion.curvature);
        let (min, max) = CURVATURES;
        if !(min..=max).contains(&curvature) {
            return refuse(Problem::RockerCurvature {
                curvature,
                min,
                max,
            });
        }
        Ok(())
    }
}

/// Coefficients of one crank-rocker at one tick rate.
#[derive(Clone, Copy, Debug)]
pub struct CrankRocker {
    law: SquareLaw,
    geometry: Geometry,
}

impl CrankRocker {
    /// Coefficients for a unit (travel for one radian of the rocker) of 0.1 mm to 0.5 m and a tick rate of 500 to 10,000 Hz.
    #[cold]
    pub fn new(settings: &CrankRockerSettings, unit_m: f64, tick_hz: u32) -> Self {
        let geometry = Geometry::new(settings);
        let curvature = geometry.max(|motion| motion.curvature);
        Self {
            law: SquareLaw::new(unit_m * curvature, tick_hz),
            geometry,
        }
    }
}

impl Mechanism for CrankRocker {
    fn speed(&self, amax: Amax) -> Turns {
        self.law.speed(amax)
    }

    fn amax(&self, speed: Turns) -> Amax {
        self.law.amax(speed)
    }

    #[inline(always)]
    fn hash_half(&self, second: bool, hasher: &mut impl Hasher) {
        let Self { law, geometry } = self;
        let Geometry {
            crank,
            coupler,
            ground,
            stretched,
        } = geometry;
        if second {
            (crank, coupler, ground).hash(hasher);
        } else {
            (law, stretched).hash(hasher);
        }
    }

    fn kinematics(&self, angle: u32) -> Kinematics {
        let motion = self.geometry.at(angle);
        let q30 = |value: i64| (value << 2) as i32;
        Kinematics {
            slope: q30(motion.slope),
            curvature: q30(motion.curvature),
        }
    }
}

/// Lengths, 28 fraction bits.
#[derive(Clone, Copy, Debug)]
struct Geometry {
    crank: i64,
    coupler: i64,
    ground: i64,
    /// Crank angle from the ground line at crank phase 0, 2³² to the turn.
    stretched: u32,
}

/// Motion of the platform per unit travel, 28 fraction bits.
#[derive(Clone, Copy, Debug)]
struct Motion {
    slope: i64,
    curvature: i64,
}

type Vector = (i64, i64);

fn product(a: i64, b: i64) -> i64 {
    (a * b) >> 28
}

fn dot(a: Vector, b: Vector) -> i64 {
    (a.0 * b.0 + a.1 * b.1) >> 28
}

/// Component of `b` across `a`: **a**⊥·**b**.
fn across(a: Vector, b: Vector) -> i64 {
    (a.0 * b.1 - a.1 * b.0) >> 28
}

fn quotient(a: i64, b: i64) -> i64 {
    // A divisor of 0 is a branch point, which the settings exclude.
    (a << 28).checked_div(b).unwrap_or(0)
}

impl Geometry {
    #[cold]
    fn new(settings: &CrankRockerSettings) -> Self {
        let fixed = |value: f64| libm::round(value * ONE as f64) as i64;
        let mut geometry = Self {
            crank: fixed(settings.crank),
            coupler: fixed(settings.coupler),
            ground: fixed(settings.ground),
            stretched: 0,
        };
        geometry.stretched = geometry.stretched_out();
        geometry
    }

    /// Crank angle at which crank and coupler are stretched out.
    ///
    /// The slope ψ′ changes its sign twice in a turn. Here it rises through 0, in the first half turn. Halving that 31 times finds it.
    #[cold]
    fn stretched_out(&self) -> u32 {
        let (mut before, mut after) = (0, 1_u32 << 31);
        while after - before > 1 {
            let middle = before + (after - before) / 2;
            if self.at(middle).slope < 0 {
                before = middle;
            } else {
                after = middle;
            }
        }
        after
    }

    /// Motion at an angle from the stretched-out position, 2³² to the turn.
    #[cfg_attr(not(feature = "servo"), cold)] // as `AnyMechanism::kinematics`
    fn at(&self, angle: u32) -> Motion {
        let turn = sine_cosine(angle.wrapping_add(self.stretched));
        let (sine, cosine) = (i64::from(turn.sine) >> 2, i64::from(turn.cosine) >> 2);
        let crank = (product(self.crank, cosine), product(self.crank, sine));
        // From the crank's pin to the rocker's pivot.
        let diagonal = (self.ground - crank.0, -crank.1);
        let squared = dot(diagonal, diagonal);
        let coupler_squared = product(self.coupler, self.coupler);
        // Components of the coupler along the diagonal and across it, times the diagonal.
        let along = (coupler_squared + squared - ONE) >> 1;
        let area = (coupler_squared * squared - along * along).max(0);
        let across_it = i64::from(isqrt(area.unsigned_abs()));
        let coupler = (
            quotient((along * diagonal.0 - across_it * diagonal.1) >> 28, squared),
            quotient((along * diagonal.1 + across_it * diagonal.0) >> 28, squared),
        );
        let rocker = (coupler.0 - diagonal.0, coupler.1 - diagonal.1);
        let leverage = across(rocker, coupler);
        let speed = quotient(across(crank, coupler), leverage);
        let coupler_speed = quotient(across(crank, rocker), leverage);
        let forces = product(product(speed, speed), dot(rocker, coupler))
            - dot(crank, coupler)
            - product(product(coupler_speed, coupler_speed), coupler_squared);
        Motion {
            slope: speed,
            curvature: quotient(forces, leverage),
        }
    }

    /// Greatest magnitude of a quantity over a turn, as a ratio; the error is that of [`Mechanism::kinematics`].
    ///
    /// Samples every 0.35° bracket the maximum. A ternary search of the bracket ends where the fixed-point error hides the rest.
    #[cold]
    fn max(&self, of: fn(Motion) -> i64) -> f64 {
        const STEP: u32 = 1 << 22;
        let size = |angle: u32| of(self.at(angle)).unsigned_abs();
        let angles = (0..1024_u32).map(|i| i << 22);
        let Some(top) = angles.max_by_key(|&angle| size(angle)) else {
            return 0.0;
        };
        let (mut from, mut width) = (top.wrapping_sub(STEP), 2 * STEP);
        while width > 1 << 12 {
            let third = width / 3;
            let [left, right] = [third, 2 * third].map(|by| size(from.wrapping_add(by)));
            if left < right {
                from = from.wrapping_add(third);
            }
            width -= third;
        }
        size(from.wrapping_add(width / 2)) as f64 / ONE as f64
    }
}
