//! The method of a machine that is integrated, and how many steps it makes in a tick.

use cophase_methods::{Scheme, Unstable};

use crate::dynamics::Mode;

/// By how much what swings may be off, of itself, where nothing says how well it is to be known. RK4 at a damping ratio of 0.05
/// then makes four steps a radian.
pub const RESOLUTION: f64 = 3e-4;

/// Less damping than this is not counted on: what swings longer than a hundred radians is seen by its phase no more.
const LEAST_ZETA: f64 = 0.005;

/// Steps a tick beyond which a scene would take longer than anyone waits.
pub const MOST_STEPS: u32 = 1000;

/// Method and step that a scene sets; those that it leaves open are chosen here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// Which one.
    pub scheme: Option<Scheme>,
    /// How many steps it makes in a tick.
    pub steps_per_tick: Option<u32>,
    /// By how much what swings may be off, of itself.
    pub resolution: f64,
    /// How often all of that is halved: steps that were found to be too long, or of which that is to be found out.
    pub halvings: u32,
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

/// How far a mode may turn in a step, rad, for its swing to be off by no more than `resolution` of itself, and half of what is
/// stable not to be passed. An error made in a radian is forgotten within 1/2ζ of them.
fn step_rad(scheme: Scheme, zeta: f64, resolution: f64) -> f64 {
    let stable = scheme
        .stability_limit(zeta)
        .map_or(f64::INFINITY, |limit| 0.5 * limit);
    let below_critical = zeta.min(0.99);
    let error_a_radian = resolution * 2.0 * zeta.max(LEAST_ZETA);
    scheme.step_for(below_critical, error_a_radian).min(stable)
}

impl Chosen {
    /// True if the scene leaves both to be chosen.
    pub fn is_open(&self) -> bool {
        self.scheme.is_none() && self.steps_per_tick.is_none()
    }

    /// Steps a tick: those that the scene asks for, or else those that `needed` gives, halved as often as is wanted.
    pub(super) fn steps(
        &self,
        needed: impl FnOnce() -> Result<u32, String>,
    ) -> Result<u32, String> {
        let steps = self.steps_per_tick.map_or_else(needed, Ok)?;
        Ok(steps << self.halvings)
    }
}

/// Steps a tick by which the fastest mode is followed.
pub(super) fn steps_for(
    scheme: Scheme,
    mode: Mode,
    tick_s: f64,
    resolution: f64,
) -> Result<u32, String> {
    let steps = (mode.omega_rad_s * tick_s / step_rad(scheme, mode.zeta, resolution))
        .ceil()
        .max(1.0);
    if steps <= f64::from(MOST_STEPS) {
        return Ok(steps as u32);
    }
    Err(format!(
        "{scheme} would take {} steps a tick for the fastest mode, {:.3e} rad/s at a damping ratio of {:.3}; at \
         most {MOST_STEPS} are made: give rotors more inertia, softer rods and motors, or another method.name",
        in_words(steps),
        mode.omega_rad_s,
        mode.zeta
    ))
}

/// A number of steps that is too large. With very much damping no step is short enough, and it has no end.
pub(super) fn in_words(steps: f64) -> String {
    if steps < 1e6 {
        format!("{steps:.0}")
    } else {
        "over a million".to_owned()
    }
}

/// The error's text, with the value that would be stable in the scene's own key.
pub(super) fn in_steps_per_tick(unstable: &Unstable, tick_s: f64) -> String {
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

    /// Were it wrong, a refusal would ask for fewer than infinitely many steps.
    #[test]
    fn steps_without_end_are_said_in_words() {
        let mode = Mode {
            omega_rad_s: 283.7,
            zeta: 1_418_589.0,
        };
        let refused = steps_for(Scheme::Rk4, mode, 1e-3, RESOLUTION).unwrap_err();
        assert!(refused.contains("over a million steps a tick"), "{refused}");
    }
}
