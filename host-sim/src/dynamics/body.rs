//! The parts that all model levels share: the mechanism, the load it carries, and the rotors.

use super::corners::FREEDOMS;
use crate::mechanism::{AnyMechanism, Load, Mechanism};
use crate::pose::Pose;

/// Position and motion of a plane: heave in m, tilts in rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneMotion {
    /// Heave and tilts.
    pub place: [f64; FREEDOMS],
    /// First time derivatives of `place`.
    pub rate: [f64; FREEDOMS],
    /// Second time derivatives of `place`.
    pub acceleration: [f64; FREEDOMS],
}

impl PlaneMotion {
    /// Pose of a platform, which tilts.
    pub fn tilted(&self) -> Pose {
        let [z_m, x, y] = self.place;
        Pose {
            z_m,
            accel_mps2: self.acceleration[0],
            tilt_x_mrad: x * 1e3,
            tilt_y_mrad: y * 1e3,
            ..Pose::default()
        }
    }

    /// Pose of a part with one slope, its pitch.
    pub fn pitched(&self) -> Pose {
        let [z_m, pitch, _] = self.place;
        Pose {
            z_m,
            accel_mps2: self.acceleration[0],
            pitch_mrad: pitch * 1e3,
            ..Pose::default()
        }
    }
}

/// Geometry of a crank at one angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crank {
    /// Height of the corner above the crank's axis, m, upwards.
    pub height_m: f64,
    /// dh/dα, m.
    pub lever_m: f64,
    /// d²h/dα², m.
    pub lever_rate_m: f64,
}

/// Inertia and dry friction of the rotors, one an axis.
#[derive(Clone, Debug)]
pub struct RotorParts {
    /// Inertia of each rotor, kg·m².
    pub inertia_kgm2: Vec<f64>,
    /// Dry friction of each rotor, N·m.
    pub friction_nm: Vec<f64>,
}

/// The parts of a platform on cranks that all its model levels share: the mechanism, the load it carries, and the rotors.
#[derive(Clone, Debug)]
pub struct Body {
    /// Mechanism between crank and platform. All axes have the same one.
    pub mechanism: AnyMechanism,
    /// Platform and its payload, as one mass.
    pub load: Load,
    /// Inertia of the platform about either tilt axis, kg·m².
    pub tilt_inertia_kgm2: f64,
    /// Inertia of each rotor, kg·m². The length of the list is the number of axes.
    pub rotors_kgm2: Vec<f64>,
    /// Radius of the circle on which the cranks stand, m.
    pub mount_radius_m: f64,
    /// Stiffness of the link between a crank and its corner (a rod with its bearings), along the line of travel, N/m.
    pub rod_n_per_m: f64,
    /// Dry friction of each rotor, N·m.
    pub friction_nm: Vec<f64>,
}

impl Body {
    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.rotors_kgm2.len()
    }

    /// Returns +1 if a crank at angle 0 holds its corner at the top, −1 if it holds it at the bottom.
    pub fn upwards(&self) -> f64 {
        -self.load.platform.gravity_sign()
    }

    /// Geometry of a crank at an angle.
    pub fn crank(&self, alpha_rad: f64) -> Crank {
        let [crank] = self.cranks(&[alpha_rad]);
        crank
    }

    /// Geometry of cranks at their angles.
    #[inline(always)] // a call costs as much as a third of the rates of a platform
    pub fn cranks<const N: usize>(&self, alpha_rad: &[f64; N]) -> [Crank; N] {
        let up = self.upwards();
        let radius_m = up * self.mechanism.crank_radius_m();
        let at_each = self.mechanism.at_each(alpha_rad);
        at_each.map(|at| Crank {
            height_m: up * at.x_m,
            lever_m: -radius_m * at.s,
            lever_rate_m: -radius_m * at.h,
        })
    }

    /// The platform's inertia in each freedom of a plane, kg and kg·m².
    pub fn masses(&self) -> [f64; FREEDOMS] {
        let tilt = self.tilt_inertia_kgm2;
        [self.load.mass_kg, tilt, tilt]
    }

    /// Upper bound of a crank's lever, m.
    pub fn longest_lever_m(&self) -> f64 {
        let mechanism = &self.mechanism;
        mechanism.crank_radius_m() * mechanism.max_h().max(mechanism.max_s())
    }

    /// Weight of the load, N.
    pub fn weight_n(&self) -> f64 {
        self.load.mass_kg * self.load.gravity_mps2
    }
}
