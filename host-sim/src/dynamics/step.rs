//! The integration method of a machine, and its steps per tick.

use cophase_methods::{Scheme, Unstable};
use cophase_scene::file::MethodName;

use crate::dynamics::Mode;

/// Largest relative error of an oscillation if the scene sets none. At a damping ratio of 0.05, RK4 then makes four steps per
/// radian.
pub const RESOLUTION: f64 = 3e-4;

/// Smallest damping ratio that the choice of the step relies on. With less damping an oscillation rings for more than 1/2ζ =
/// 100 radians, after which its phase no longer has a visible effect.
const MIN_ZETA: f64 = 0.005;

/// Largest number of steps per tick: above it, a scene takes longer to run than is practical.
pub const MAX_STEPS: u32 = cophase_scene::file::Method::MAX_STEPS;

/// Method and step of a scene. Those that the scene leaves open are chosen here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// Method, if the scene sets one.
    pub scheme: Option<Scheme>,
    /// Steps per tick, if the scene sets them.
    pub steps_per_tick: Option<u32>,
    /// Largest relative error of an oscillation.
    pub resolution: f64,
    /// Number of times that the step is halved: because it was too long, or to find out if it is.
    pub halvings: u32,
}

/// Returns the method of a name; `None` if it is to be chosen.
pub const fn scheme(name: MethodName) -> Option<Scheme> {
    Some(match name {
        MethodName::Auto => return None,
        MethodName::ExplicitEuler => Scheme::ExplicitEuler,
        MethodName::SymplecticEuler => Scheme::SymplecticEuler,
        MethodName::VelocityVerlet => Scheme::VelocityVerlet,
        MethodName::Rk4 => Scheme::Rk4,
        MethodName::ImplicitMidpoint => Scheme::ImplicitMidpoint,
        MethodName::Sdirk4 => Scheme::Sdirk4,
        MethodName::Exact => Scheme::Exact,
    })
}

impl Default for Chosen {
    fn default() -> Self {
        Self {
            scheme: None,
            steps_per_tick: None,
            resolution: RESOLUTION,
            halvings: 0,
        }
    }
}

/// Returns the largest phase advance of a mode per step, rad. The relative error of the oscillation stays below `resolution`,
/// and the step below half of the stability limit. Damping makes the error of one radian decay within 1/2ζ radians.
fn step_rad(scheme: Scheme, zeta: f64, resolution: f64) -> f64 {
    let stable = scheme
        .stability_limit(zeta)
        .map_or(f64::INFINITY, |limit| 0.5 * limit);
    let below_critical = zeta.min(0.99);
    let error_a_radian = resolution * 2.0 * zeta.max(MIN_ZETA);
    scheme.step_for(below_critical, error_a_radian).min(stable)
}

impl Chosen {
    /// True if the scene sets neither method nor steps.
    pub fn is_open(&self) -> bool {
        self.scheme.is_none() && self.steps_per_tick.is_none()
    }

    /// Returns the method and its steps per tick. Where the scene leaves the method open it is RK4, or SDIRK4 if RK4 would take too many
    /// steps: that has no limit of stability, and only has to resolve the motion.
    pub fn method(&self, mode: Mode, tick_s: f64) -> Result<(Scheme, u32), String> {
        let with = |scheme| {
            let steps = self.steps(|| steps_for(scheme, mode, tick_s, self.resolution))?;
            Ok((scheme, steps))
        };
        match self.scheme {
            Some(scheme) => with(scheme),
            None => with(Scheme::Rk4).or_else(|refused| with(Scheme::Sdirk4).map_err(|_| refused)),
        }
    }

    /// Returns the steps per tick: those of the scene, or else those that `needed` returns, multiplied by 2 for each halving.
    pub fn steps(&self, needed: impl FnOnce() -> Result<u32, String>) -> Result<u32, String> {
        let steps = self.steps_per_tick.map_or_else(needed, Ok)?;
        Ok(steps << self.halvings)
    }
}

/// Returns the steps per tick that resolve the fastest mode.
pub fn steps_for(scheme: Scheme, mode: Mode, tick_s: f64, resolution: f64) -> Result<u32, String> {
    let steps = (mode.omega_rad_s * tick_s / step_rad(scheme, mode.zeta, resolution))
        .ceil()
        .max(1.0);
    if steps <= f64::from(MAX_STEPS) {
        return Ok(steps as u32);
    }
    Err(format!(
        "{scheme} would take {} steps a tick for the fastest mode, {:.3e} rad/s at a damping ratio of {:.3}; at \
         most {MAX_STEPS} are made: give rotors more inertia, softer rods and motors, or another method.name",
        in_words(steps),
        mode.omega_rad_s,
        mode.zeta
    ))
}

/// Formats a number of steps that is too large. With very large damping no step is short enough, and the number is infinite.
pub fn in_words(steps: f64) -> String {
    if steps < 1e6 {
        format!("{steps:.0}")
    } else {
        "over a million".to_owned()
    }
}

/// Returns the error's text, with the stable value as a setting of the scene.
pub fn in_steps_per_tick(unstable: &Unstable, tick_s: f64) -> String {
    match *unstable {
        Unstable::Step { limit_s, .. } if limit_s > 0.0 => {
            let steps = (tick_s / limit_s).ceil();
            format!("{unstable}; that is method.steps_per_tick = {steps:.0} or more")
        }
        _ => unstable.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the message that refuses a scene states a meaningless number of steps.
    #[test]
    fn an_excessive_step_count_is_reported_in_words() {
        let mode = Mode {
            omega_rad_s: 283.7,
            zeta: 1_418_589.0,
        };
        let refused = steps_for(Scheme::Rk4, mode, 1e-3, RESOLUTION).unwrap_err();
        assert!(refused.contains("over a million steps a tick"), "{refused}");
    }
}
