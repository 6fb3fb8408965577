//! The parts that all model levels share: the mechanism, the load it carries, and the rotors.

use super::corners::FREEDOMS;
use cophase_core::mechanism::ScotchYokeSettings;

use crate::mechanism::scotch_yoke::ScotchYoke;
use crate::mechanism::{AnyMechanism, Configured, Load, Mechanism, Platform};

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

/// The parts that all model levels share: the mechanism, the load it carries, and the rotors.
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

/// Speed scale over which dry friction reverses, rad/s. It is about a hundredth of a turn per second, which counts as standstill.
pub const STICTION_RAD_S: f64 = 0.06;

impl Body {
    /// Creates shafts that carry no platform, with these rotor inertias, kg·m², and no friction.
    pub fn of_shafts(rotors_kgm2: Vec<f64>) -> Self {
        Self {
            mechanism: ScotchYoke::of(&ScotchYokeSettings {}, 0.01).into(),
            load: Load {
                mass_kg: 0.0,
                gravity_mps2: 0.0,
                platform: Platform::Above,
            },
            tilt_inertia_kgm2: 0.0,
            friction_nm: vec![0.0; rotors_kgm2.len()],
            rotors_kgm2,
            mount_radius_m: 1.0,
            rod_n_per_m: 0.0,
        }
    }

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
        let up = self.upwards();
        let radius_m = up * self.mechanism.crank_radius_m();
        let at = self.mechanism.at(alpha_rad);
        Crank {
            height_m: up * at.x_m,
            lever_m: -radius_m * at.s,
            lever_rate_m: -radius_m * at.h,
        }
    }

    /// The platform's inertia in each freedom of a plane, kg and kg·m².
    pub fn masses(&self) -> [f64; FREEDOMS] {
        let tilt = self.tilt_inertia_kgm2;
        [self.load.mass_kg, tilt, tilt]
    }

    /// Upper bound of a crank's lever, m.
    pub fn longest_lever_m(&self) -> f64 {
        let mechanism = &self.mechanism;
        mechanism.crank_radius_m() * mechanism.greatest_h().max(mechanism.greatest_s())
    }

    /// Torque of rotor `i`'s friction, N·m.
    pub fn drag_nm(&self, i: usize, omega_rad_s: f64) -> f64 {
        drag_nm(self.friction_nm[i], omega_rad_s)
    }

    /// Upper bound of the rate at which friction changes a crank's speed near standstill, 1/s.
    pub fn fastest_friction_per_s(&self) -> f64 {
        let each = self.friction_nm.iter().zip(&self.rotors_kgm2);
        each.map(|(friction, rotor)| friction / (rotor * STICTION_RAD_S))
            .fold(0.0, f64::max)
    }

    /// Weight of the load, N.
    pub fn weight_n(&self) -> f64 {
        self.load.mass_kg * self.load.gravity_mps2
    }
}

/// Argument above which tanh equals 1 in double precision. The difference is 2 exp(−2 x), which a double does not resolve from 19 on.
const SURELY_1: f64 = 22.0;

/// Torque of dry friction, N·m. It reverses smoothly, so that integration methods keep their order. A rotor under a load
/// smaller than the friction therefore does not stand still. It turns slowly, by less than a turn in a hundred seconds.
pub(super) fn drag_nm(friction_nm: f64, omega_rad_s: f64) -> f64 {
    if friction_nm == 0.0 {
        return 0.0;
    }
    let speeds = omega_rad_s / STICTION_RAD_S;
    // At nearly all speeds of a machine the tanh is 1, so it need not be computed.
    if speeds.abs() > SURELY_1 {
        return -friction_nm * speeds.signum();
    }
    -friction_nm * speeds.tanh()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, friction at high speed differs from its formula, because tanh is not 1 there.
    #[test]
    fn friction_at_high_speed_equals_its_formula() {
        for speeds in [
            SURELY_1,
            SURELY_1.next_up(),
            25.0,
            1e3,
            1e300,
            f64::INFINITY,
        ] {
            for speeds in [speeds, -speeds] {
                assert_eq!(speeds.tanh(), speeds.signum());
                let torque_nm = drag_nm(0.3, speeds * STICTION_RAD_S);
                assert_eq!(torque_nm, -0.3 * speeds.signum());
            }
        }
    }
}
