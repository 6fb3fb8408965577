//! The platform on its N cranks: height, tilt and acceleration, computed by geometry.
//!
//! Crank i stands at angle 2π i/N on a circle of radius ρ and lifts its corner by x(αᵢ). The platform is the plane closest to the corners
//! ([`Corners`]); with two or three it passes through them. A small difference of phases causes tilt. The part that no plane can follow is
//! warp. It is given in degrees of crank angle, because this difference bends rods and platform.

use cophase_core::settings::PlatformSettings;
use cophase_scene::units::spread;

use crate::axes::per_axis;
use crate::dynamics::{Corners, MAX};
use crate::machines::follower::Follower;
use crate::mechanism::{AnyMechanism, Configured, Load, LoadAtAngle, Mechanism};
use crate::pose::Pose;

/// Platform with its mechanism and its load.
#[derive(Clone, Debug)]
pub struct Platform {
    mechanism: AnyMechanism,
    load: Load,
    corners: Corners,
    mount_radius_m: f64,
    /// Largest |dx/dα|, m.
    max_lever_m: f64,
}

/// Upper bound of the rounding error of a tilt, mrad.
const ROUNDING_MRAD: f64 = 1e-6;

impl Platform {
    /// Creates the platform of these settings on `axes` cranks.
    pub fn new(settings: &PlatformSettings, axes: usize) -> Self {
        let mechanism = AnyMechanism::from_settings(&settings.mechanism, settings.crank_radius_m);
        Self {
            max_lever_m: mechanism.crank_radius_m() * mechanism.max_s(),
            mechanism,
            load: Load {
                mass_kg: settings.load_kg,
                gravity_mps2: settings.gravity_mps2,
                platform: settings.platform,
            },
            corners: Corners::new(axes, settings.mount_radius_m),
            mount_radius_m: settings.mount_radius_m,
        }
    }

    /// Number of cranks.
    pub fn axes(&self) -> usize {
        self.corners.count()
    }

    /// Mechanism that lifts the platform.
    pub fn mechanism(&self) -> &AnyMechanism {
        &self.mechanism
    }

    /// Load on it.
    pub fn load(&self) -> &Load {
        &self.load
    }

    /// Radius of the circle on which the cranks stand, m.
    pub fn mount_radius_m(&self) -> f64 {
        self.mount_radius_m
    }

    /// Returns +1 if a crank at phase 0 holds the platform up, −1 if it lowers it.
    fn upwards(&self) -> f64 {
        -self.load.platform.gravity_sign()
    }

    /// Upper bound of [`Self::tilt_mrad`] from the slope dx/dα at the angle of one crank. Relative to this crank, a corner rises by the
    /// slope times the lead e of its own crank, with a remainder of at most ½ R max|h| e².
    fn max_tilt_here_mrad(&self, turns: &[f64]) -> f64 {
        let first = turns[0];
        let lever_m = self.mechanism.x_dot_mps(first * std::f64::consts::TAU, 1.0);
        let (mut x, mut y, mut farthest) = (0.0, 0.0, 0.0);
        for (i, turns) in turns.iter().enumerate() {
            let ahead = (turns - first) * std::f64::consts::TAU;
            let [_, share_x, share_y] = self.corners.share(i);
            x += share_x * ahead;
            y += share_y * ahead;
            if ahead.abs() > farthest {
                farthest = ahead.abs();
            }
        }
        // Two remainders differ by at most twice the largest one.
        let bent_m = self.mechanism.crank_radius_m() * self.mechanism.max_h() * farthest * farthest;
        let slope = lever_m.abs() * (x * x + y * y).sqrt() + bent_m / self.mount_radius_m;
        slope * 1e3 + ROUNDING_MRAD
    }

    /// Upper bound of [`Self::tilt_mrad`] without a sine. The slope of the plane closest to the corners is at most the difference of the
    /// corners' heights over the mount radius, because the weights of all corners in a slope sum to 0.
    fn max_tilt_mrad(&self, turns: &[f64]) -> f64 {
        let apart_m = spread(turns) * std::f64::consts::TAU * self.max_lever_m;
        apart_m / self.mount_radius_m * 1e3 + ROUNDING_MRAD
    }
}

impl Follower for Platform {
    fn pose(&self, turns: &[f64], omega_rad_s: f64, acceleration_rad_s2: f64) -> Pose {
        let (mut heights, mut accelerations) = ([0.0; MAX], [0.0; MAX]);
        for (i, &crank) in turns.iter().enumerate() {
            // Cranks on one shaft all have the same angle.
            (heights[i], accelerations[i]) = if i > 0 && crank == turns[i - 1] {
                (heights[i - 1], accelerations[i - 1])
            } else {
                let alpha = crank * std::f64::consts::TAU;
                let acceleration =
                    self.mechanism
                        .x_ddot_mps2(alpha, omega_rad_s, acceleration_rad_s2);
                (self.upwards() * self.mechanism.x_m(alpha), acceleration)
            };
        }
        let [accel_mps2, _, _] = self.corners.plane(&accelerations[..turns.len()]);
        let [z_m, tilt_x, tilt_y] = self.corners.plane(&heights[..turns.len()]);
        Pose {
            z_m,
            accel_mps2: self.upwards() * accel_mps2,
            tilt_x_mrad: tilt_x * 1e3,
            tilt_y_mrad: tilt_y * 1e3,
            ..Pose::default()
        }
    }

    /// Tilt of the plane closest to the corners, mrad: the magnitude over both directions.
    fn tilt_mrad(&self, turns: &[f64]) -> Option<f64> {
        let heights = per_axis(turns.len(), |i| {
            self.mechanism.x_m(turns[i] * std::f64::consts::TAU)
        });
        let [_, x, y] = self.corners.plane(&heights);
        Some(x.hypot(y) * 1e3)
    }

    fn may_tilt_beyond(&self, mrad: f64, turns: &[f64]) -> bool {
        self.max_tilt_mrad(turns) > mrad && self.max_tilt_here_mrad(turns) > mrad
    }

    fn load_at(&self, alpha_rad: f64) -> LoadAtAngle {
        self.mechanism.load_at(&self.load, alpha_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::platform::platform;
    use cophase_scene::library;

    /// If this fails, a run may report a largest tilt that is too small, or compute sines needlessly. The bound at a crank's angle is
    /// close: for cranks a thousandth of a turn apart, at a steep angle, it is within 10 % of the tilt.
    #[test]
    fn no_platform_tilts_beyond_its_bounds() {
        for name in ["default", "lost-steps", "patent-4"] {
            let scene = library::find(name).expect("built in").scene();
            let given = scene.machine.expect("cranks under a platform");
            let settings = platform(&given).expect("a scene that is built in");
            let platform = Platform::new(&settings, scene.axes.count);
            let count = platform.corners.count();
            for (apart, angle) in (0..12_000).map(|i| (i / 1000, f64::from(i % 1000) * 1e-3)) {
                // Evenly on a logarithmic scale, from a millionth of a turn to half a turn.
                let apart = 0.5 * 10_f64.powf(-f64::from(apart) / 2.0);
                let place = |i: usize| (i * i * 7 + i) % 5;
                let turns = per_axis(count, |i| 3.0 + angle + apart * place(i) as f64 / 4.0);
                let tilt_mrad = platform.tilt_mrad(&turns).expect("a platform tilts");
                let here_mrad = platform.max_tilt_here_mrad(&turns);
                assert!(
                    tilt_mrad <= platform.max_tilt_mrad(&turns),
                    "{name}: {turns:?}"
                );
                assert!(tilt_mrad <= here_mrad, "{name}: {turns:?}");
                assert!(platform.may_tilt_beyond(tilt_mrad * (1.0 - 1e-9), &turns));
                let is_steep = (angle - 0.25).abs() < 0.05;
                if is_steep && apart < 0.001 {
                    assert!(
                        here_mrad < 1.1 * tilt_mrad + ROUNDING_MRAD,
                        "{name}: {turns:?}"
                    );
                }
            }
        }
    }
}
