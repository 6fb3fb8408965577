//! Effect of crank errors on a platform, and the largest effect of each kind of error. Limits and bounds are computed from it.

use std::f64::consts::TAU;

use cophase_scene::file::Scene;
use cophase_scene::units::spread;
use host_sim::dynamics::Corners;
use host_sim::machines::platform::platform;
use host_sim::mechanism::{AnyMechanism, Configured, Load, Mechanism};

/// Number of crank angles among which the worst is searched. Steps of half a degree find a smooth maximum to 4e-5 of its value.
const ANGLES: u32 = 720;

/// Factor that exceeds the rounding error of a bound.
const ROUNDING: f64 = 1.0 + 1e-6;

/// The platform of a scene with cranks.
#[derive(Clone, Debug)]
pub struct Geometry {
    mechanism: AnyMechanism,
    load: Load,
    corners: Corners,
    count: usize,
    /// Ratio of tilt to slope of the crank errors at the worst crank angle, mrad per turn/m.
    mrad_per_turn: f64,
    tilt_limit_mrad: f64,
    warp_limit_deg: f64,
    /// Largest difference between errors that is within the limits whatever the errors are, turns.
    within_turns: f64,
}

impl Geometry {
    /// Geometry of a scene. None for a scene with cams, whose pushers do not tilt, or with a machine that its check refuses.
    pub fn new(scene: &Scene) -> Option<Self> {
        let machine = platform(scene.machine.as_ref()?).ok()?;
        let mechanism = AnyMechanism::from_settings(&machine.mechanism, machine.crank_radius_m);
        let longest_travel_m = angles()
            .map(|alpha| mechanism.x_dot_mps(alpha, 1.0).abs())
            .fold(0.0, f64::max);
        let mrad_per_turn = 1e3 * longest_travel_m * TAU;
        let limits = &scene.drift;
        // The slope of the closest plane is at most the largest difference between errors over the mount radius. With up to six errors,
        // none is further from that plane than √6/2 of this difference.
        let by_tilt = limits.tilt_limit_mrad * machine.mount_radius_m / mrad_per_turn;
        let by_warp = limits.warp_limit_deg / 360.0 / 1.25;
        Some(Self {
            within_turns: 0.99 * by_tilt.min(by_warp),
            load: Load {
                mass_kg: machine.load_kg,
                gravity_mps2: machine.gravity_mps2,
                platform: machine.platform,
            },
            corners: Corners::new(scene.axes.count, machine.mount_radius_m),
            count: scene.axes.count,
            mrad_per_turn,
            tilt_limit_mrad: scene.drift.tilt_limit_mrad,
            warp_limit_deg: scene.drift.warp_limit_deg,
            mechanism,
        })
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &AnyMechanism {
        &self.mechanism
    }

    /// Returns tilt at the worst crank angle, mrad, and warp, degrees, for errors of the cranks, turns.
    pub fn modes(&self, errors: &[f64]) -> (f64, f64) {
        let plane = self.corners.plane(errors);
        let tilt_mrad = plane[1].hypot(plane[2]) * self.mrad_per_turn;
        let off = |(i, error): (usize, &f64)| (error - self.corners.height(&plane, i)).abs();
        let warp_turns = match self.count {
            ..=3 => 0.0,
            _ => errors.iter().enumerate().map(off).fold(0.0, f64::max),
        };
        (tilt_mrad, warp_turns * 360.0)
    }

    /// Returns tilt, mrad, and warp, degrees, for one crank that is off while all others are in phase.
    pub fn of_one(&self, error_turns: f64) -> (f64, f64) {
        let mut errors = vec![0.0; self.count];
        errors[0] = error_turns;
        self.modes(&errors)
    }

    /// Returns true if errors exceed the limits as the controller applies them: on tilt at the worst crank angle, and on warp.
    pub fn is_beyond_limit(&self, errors: &[f64]) -> bool {
        if spread(errors) <= self.within_turns {
            return false;
        }
        let (tilt_mrad, warp_deg) = self.modes(errors);
        tilt_mrad > self.tilt_limit_mrad || warp_deg > self.warp_limit_deg
    }

    /// Largest error of one crank against all others at which the platform is within its limits, turns.
    pub fn single_limit_turns(&self) -> f64 {
        let (tilt_mrad, warp_deg) = self.of_one(1.0);
        let by_tilt = self.tilt_limit_mrad / tilt_mrad;
        if warp_deg > 0.0 {
            by_tilt.min(self.warp_limit_deg / warp_deg)
        } else {
            by_tilt
        }
    }

    /// Greatest tilt that an error of one crank of up to `error_turns` causes while all others are in phase, mrad. It is computed with true
    /// geometry at the worst angle. Half a turn is the largest possible error of a crank.
    pub fn worst_tilt_mrad(&self, error_turns: f64) -> f64 {
        let max = error_turns.abs().min(0.5);
        // The largest error does not always tilt most. Steps of 3° up to it find the maximum to 0.1 %.
        let steps = (max * 120.0).ceil().max(1.0);
        let in_phase: Vec<f64> = angles().map(|alpha| self.mechanism.x_m(alpha)).collect();
        let mut heights = vec![0.0; self.count];
        let lever_m = self.mechanism.crank_radius_m() * self.mechanism.max_s();
        for step in (1..=steps as u32).rev() {
            let error = max * f64::from(step) / steps * TAU;
            // The remaining errors are smaller, and lift the corner by less than the maximum that was found.
            if lever_m * error * ROUNDING < heights[0] {
                break;
            }
            for (alpha, in_phase_m) in angles().zip(&in_phase) {
                for sign in [-1.0, 1.0] {
                    let off_m = self.mechanism.x_m(alpha + sign * error) - in_phase_m;
                    heights[0] = off_m.abs().max(heights[0]);
                }
            }
        }
        // The tilt is proportional to the height.
        let [_, x, y] = self.corners.plane(&heights);
        x.hypot(y) * 1e3
    }

    /// Greatest tilt for any positions of the cranks, mrad. Each crank is at the top or at the bottom then, because the plane through their
    /// heights is linear in each.
    pub fn any_tilt_mrad(&self) -> f64 {
        let heights = angles().map(|alpha| self.mechanism.x_m(alpha));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let of = |set: u32| {
            let at = |i: usize| if set >> i & 1 == 1 { high } else { low };
            let heights: Vec<f64> = (0..self.count).map(at).collect();
            let [_, x, y] = self.corners.plane(&heights);
            x.hypot(y)
        };
        (0..1 << self.count).map(of).fold(0.0, f64::max) * 1e3
    }

    /// Greatest travel of the platform per angle of the crank, m/rad.
    pub fn longest_travel_m(&self) -> f64 {
        self.mrad_per_turn / 1e3 / TAU
    }

    /// Greatest inertia of the platform and its load at one crank, kg·m²: m (dx/dα)² / N.
    pub fn max_inertia_kgm2(&self) -> f64 {
        let longest_travel_m = self.longest_travel_m();
        self.load.mass_kg * longest_travel_m * longest_travel_m / self.count as f64
    }

    /// Largest torque of all cranks together, at rest or at a speed, with an acceleration, at any angle, N·m.
    pub fn max_torque_nm(&self, omega_rad_s: f64, acceleration_rad_s2: f64) -> f64 {
        let at = |omega, acceleration| {
            angles()
                .map(move |alpha| {
                    let torque = self
                        .mechanism
                        .torque_nm(&self.load, alpha, omega, acceleration);
                    torque.abs()
                })
                .fold(0.0, f64::max)
        };
        at(0.0, acceleration_rad_s2).max(at(omega_rad_s, acceleration_rad_s2))
    }
}

fn angles() -> impl Iterator<Item = f64> {
    (0..ANGLES).map(|i| f64::from(i) * TAU / f64::from(ANGLES))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::library;

    /// If this fails, the bound is too low for a crank at its limit, or so high that it excludes nothing. Chords are shorter than tangents
    /// by less than e²/2 times the largest curvature 1 + λ, over the largest slope, which is above 1.
    #[test]
    fn geometric_and_linear_tilt_agree_for_small_errors() {
        for name in ["default", "patent-4"] {
            let scene = library::find(name).unwrap().scene();
            let geometry = Geometry::new(&scene).unwrap();
            let error = geometry.single_limit_turns();
            let mut errors = vec![0.0; scene.axes.count];
            errors[0] = error;
            let (linear, _) = geometry.modes(&errors);
            let worst = geometry.worst_tilt_mrad(error);
            assert!(worst <= linear, "{name}: {worst} over {linear}");
            let chord = 1.0 - error * TAU * 1.3 / 2.0;
            assert!(worst >= linear * chord, "{name}: {worst} under {linear}");
        }
    }

    /// If this fails, a crank that stands still exceeds its bound, because the bound is below the tilt of half a turn.
    #[test]
    fn half_a_turn_tilts_by_the_stroke() {
        let scene = library::find("patent-4").unwrap().scene();
        let geometry = Geometry::new(&scene).unwrap();
        // One of three corners is off by 2 R, which makes 2/3 of it over the mount radius.
        let stroke = 2.0 * 76.432_414e-3 * 2.0 / 3.0 / 0.4 * 1e3;
        let worst = geometry.worst_tilt_mrad(0.5);
        assert!((worst / stroke - 1.0).abs() < 1e-3, "{worst}");
    }
}
