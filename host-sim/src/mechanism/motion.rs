//! Motion of the platform over the crank angle, and the crank torque that a load on it requires: the extension point of
//! mechanisms.
//!
//! Terms:
//! - **crank angle** α, rad, 0 where the platform is farthest from the crank axes;
//! - **x**, m, the distance of the platform from the crank axes along the line of travel;
//! - **s**, the *speed coefficient*: dx/dα = −R s, with R the crank radius;
//! - **h**, the *acceleration coefficient*: d²x/dα² = −R h, so that h = ds/dα;
//! - **a** = −x″, m/s², the acceleration *towards the crank axes*, largest at α = 0.
//!
//! Torque follows from the energy balance without friction: τ ω = d/dt (kinetic + potential energy of the load). Links and
//! cranks are massless here. The direction of gravity depends on the build ([`Platform`]).

pub use cophase_core::settings::Platform;

use super::drawing::Mount;

/// Load that the cranks move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Mass on the platform, kg.
    pub mass_kg: f64,
    /// Magnitude of gravity, m/s².
    pub gravity_mps2: f64,
    /// Side of the cranks on which the platform is.
    pub platform: Platform,
}

impl Load {
    /// Force on all cranks, N, for an acceleration a of the platform, m/s², towards the crank axes.
    fn force_n(&self, a_mps2: f64) -> f64 {
        self.mass_kg * (a_mps2 + self.platform.gravity_sign() * self.gravity_mps2)
    }
}

/// A load, with the crank at one angle: what its torque depends on besides speed and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadAtAngle {
    load: Load,
    crank_radius_m: f64,
    s: f64,
    h: f64,
}

impl LoadAtAngle {
    /// No load, at any angle.
    pub const NONE: Self = Self {
        load: Load {
            mass_kg: 0.0,
            gravity_mps2: 0.0,
            platform: Platform::Above,
        },
        crank_radius_m: 0.0,
        s: 0.0,
        h: 0.0,
    };

    /// Returns the torque that all cranks together give, N·m: [`Mechanism::torque_nm`].
    #[inline]
    pub fn torque_nm(&self, omega_rad_s: f64, alpha_ddot_rad_s2: f64) -> f64 {
        let centripetal = self.h * omega_rad_s * omega_rad_s;
        let a = self.crank_radius_m * (centripetal + self.s * alpha_ddot_rad_s2);
        self.load.force_n(a) * self.crank_radius_m * self.s
    }
}

/// Motion at one crank angle, in the terms of [`Mechanism`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtAngle {
    /// Distance x of the platform from the crank axes, m.
    pub x_m: f64,
    /// Speed coefficient.
    pub s: f64,
    /// Acceleration coefficient.
    pub h: f64,
}

/// Law of the amplitude: the largest acceleration of the moved part grows with the squared speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquareLaw {
    radius_m: f64,
    sharpest: f64,
}

impl SquareLaw {
    /// Law of shafts whose amplitude is `length_m` times their squared speed.
    pub const fn of_length(length_m: f64) -> Self {
        Self {
            radius_m: length_m,
            sharpest: 1.0,
        }
    }

    /// Amplitude over squared speed, m.
    pub fn length_m(&self) -> f64 {
        self.radius_m * self.sharpest
    }

    /// Largest acceleration at a constant speed, m/s².
    pub fn amax_mps2(&self, omega_rad_s: f64) -> f64 {
        self.radius_m * omega_rad_s * omega_rad_s * self.sharpest
    }

    /// Speed at which the largest acceleration is `amax_mps2`, rad/s. NaN for a negative amax, because amax is a magnitude.
    pub fn speed_for_amax_rad_s(&self, amax_mps2: f64) -> f64 {
        (amax_mps2 / self.length_m()).sqrt()
    }
}

/// A mechanism of known size between a crank and the platform.
///
/// The platform is farthest from the crank axes at α = 0, and returns after a turn.
pub trait Mechanism: Copy {
    /// Unit of length R, m, for s and h: the crank radius, if there is one.
    fn crank_radius_m(&self) -> f64;

    /// Returns x, s and h together at each of some angles. Equations of motion need all three at every evaluation, for all cranks.
    fn at_each<const N: usize>(&self, alpha_rad: &[f64; N]) -> [AtAngle; N];

    /// Returns x, s and h together.
    #[inline]
    fn at(&self, alpha_rad: f64) -> AtAngle {
        let [at] = self.at_each(&[alpha_rad]);
        at
    }

    /// Upper bound of |s| over the turn.
    fn max_s(&self) -> f64;

    /// Largest |h| of the turn, exact: amax = R ω² times this.
    fn max_h(&self) -> f64;

    /// Upper bound of −h″/h at the peak of |h|, 1/rad². At an angle δ from the peak the acceleration is at least
    /// amax (1 − this · δ²/2).
    fn peak_sharpness(&self) -> f64;

    /// Plural name of the parts between cranks and platform, whose stiffness is `machine.rod_n_per_um`.
    fn links(&self) -> &'static str;

    /// Drawing of the mechanisms with their symbols under a platform, as SVG text.
    fn draw(&self, mount: &Mount) -> String;

    /// Distance x of the platform from the crank axes, m.
    fn x_m(&self, alpha_rad: f64) -> f64 {
        self.at(alpha_rad).x_m
    }

    /// Speed coefficient s, dimensionless: dx/dα = −R s.
    fn s(&self, alpha_rad: f64) -> f64 {
        self.at(alpha_rad).s
    }

    /// Acceleration coefficient h, dimensionless: d²x/dα² = −R h.
    fn h(&self, alpha_rad: f64) -> f64 {
        self.at(alpha_rad).h
    }

    /// Coefficients s and h together, each to its last digit as alone.
    fn s_and_h(&self, alpha_rad: f64) -> (f64, f64) {
        let at = self.at(alpha_rad);
        (at.s, at.h)
    }

    /// Platform velocity dx/dt, m/s, away from the crank axes: −R s ω.
    fn x_dot_mps(&self, alpha_rad: f64, omega_rad_s: f64) -> f64 {
        -self.crank_radius_m() * self.s(alpha_rad) * omega_rad_s
    }

    /// Acceleration x″, m/s², away from the crank axes: −R (h ω² + s α″), for crank speed ω in rad/s and angular
    /// acceleration α″ in rad/s².
    fn x_ddot_mps2(&self, alpha_rad: f64, omega_rad_s: f64, alpha_ddot_rad_s2: f64) -> f64 {
        -self.a_exact_mps2(alpha_rad, omega_rad_s, alpha_ddot_rad_s2)
    }

    /// Acceleration a = −x″, m/s², towards the crank axes.
    fn a_exact_mps2(&self, alpha_rad: f64, omega_rad_s: f64, alpha_ddot_rad_s2: f64) -> f64 {
        let (s, h) = self.s_and_h(alpha_rad);
        let centripetal = h * omega_rad_s * omega_rad_s;
        self.crank_radius_m() * (centripetal + s * alpha_ddot_rad_s2)
    }

    /// Law of the largest acceleration at constant speed: amax = R ω² times the largest |h|.
    fn law(&self) -> SquareLaw {
        SquareLaw {
            radius_m: self.crank_radius_m(),
            sharpest: self.max_h(),
        }
    }

    /// Largest acceleration at constant speed, m/s².
    fn amax_mps2(&self, omega_rad_s: f64) -> f64 {
        self.law().amax_mps2(omega_rad_s)
    }

    /// Crank speed at which the largest acceleration is `amax_mps2`, rad/s. NaN for a negative amax, because amax is a magnitude.
    fn speed_for_amax_rad_s(&self, amax_mps2: f64) -> f64 {
        self.law().speed_for_amax_rad_s(amax_mps2)
    }

    /// Returns a load with the crank at one angle.
    fn load_at(&self, load: &Load, alpha_rad: f64) -> LoadAtAngle {
        let (s, h) = self.s_and_h(alpha_rad);
        LoadAtAngle {
            load: *load,
            crank_radius_m: self.crank_radius_m(),
            s,
            h,
        }
    }

    /// Total torque of all cranks, N·m. It is positive if they drive and negative if the load drives them: τ = m R s (R (h
    /// ω² + s α″) + σ g), with σ the sign of gravity.
    ///
    /// It is exact for the load alone, with crank speed ω in rad/s and angular acceleration α″ in rad/s². Its mean at
    /// constant speed is 0.
    fn torque_nm(
        &self,
        load: &Load,
        alpha_rad: f64,
        omega_rad_s: f64,
        alpha_ddot_rad_s2: f64,
    ) -> f64 {
        self.load_at(load, alpha_rad)
            .torque_nm(omega_rad_s, alpha_ddot_rad_s2)
    }

    /// Total torque of all cranks, N·m, for an acceleration a of the platform, m/s², towards the crank axes.
    fn torque_for_a_nm(&self, load: &Load, alpha_rad: f64, a_mps2: f64) -> f64 {
        load.force_n(a_mps2) * self.crank_radius_m() * self.s(alpha_rad)
    }
}
