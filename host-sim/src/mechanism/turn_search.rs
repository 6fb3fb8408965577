//! Search for the largest value of a smooth curve over one turn of a crank.
//!
//! Torque curves have up to three local maxima per turn. Which one is the largest depends on the direction of gravity and
//! on the crank/rod ratio. So the search first samples the whole turn. Every sample that is not below its neighbours
//! brackets a local maximum. Golden-section search refines each bracket, and the largest result is returned. The search
//! needs no start value, so it cannot converge to the wrong maximum.
//!
//! Limitation: two maxima less than one sample (0.5 deg) apart count as one. Curves of slider-cranks with ratios up to 0.8
//! have no such maxima, because their harmonics vanish long before the 100th.

use core::f64::consts::TAU;

/// Samples per turn: every half degree.
const SAMPLES: u32 = 720;

/// Angle between two samples, rad.
const STEP: f64 = TAU / SAMPLES as f64;

/// Golden-section steps. Each keeps 0.618 of the bracket, so 1 deg shrinks to 1e-10 rad. A quadratic maximum is flat in
/// `f64` within 1e-8 rad, where further steps compare rounding noise.
const REFINEMENTS: u32 = 40;

/// Maximum of a curve over a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnPeak {
    /// Angle, rad, from 0 up to 2π. Accurate to 1e-7 rad for a maximum of ordinary curvature.
    pub alpha_rad: f64,
    /// Value in the curve's own unit. Its relative error is below 1e-13.
    pub value: f64,
}

/// Finds the largest value of `curve`, which takes an angle in rad and has period 2π.
///
/// The curve must be finite and continuous everywhere. The function panics if all samples are NaN. Of equal maxima it
/// returns the first one after angle 0.
///
/// ```
/// use host_sim::mechanism::turn_search::max_over_turn;
/// let peak = max_over_turn(|alpha| 5.0 * (alpha - 1.0).cos());
/// assert!((peak.alpha_rad - 1.0).abs() < 1e-7 && (peak.value - 5.0).abs() < 1e-12);
/// ```
pub fn max_over_turn(curve: impl Fn(f64) -> f64) -> TurnPeak {
    max_of_samples(|i| curve(angle(i)), &curve)
}

/// Angles of the samples, rad.
pub fn sample_angles() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(angle)
}

fn angle(sample: u32) -> f64 {
    f64::from(sample) * STEP
}

/// Finds the largest value of `curve`, whose values at [`sample_angles`] are those of `sample`. See [`max_over_turn`].
pub fn max_of_samples(sample: impl Fn(u32) -> f64, curve: impl Fn(f64) -> f64) -> TurnPeak {
    let at = |i: u32| sample(i % SAMPLES);
    let mut best: Option<TurnPeak> = None;
    let (mut before, mut here) = (at(SAMPLES - 1), at(0));
    for i in 0..SAMPLES {
        let after = at(i + 1);
        if here >= before && here >= after {
            let top = refine(&curve, angle(i) - STEP, angle(i) + STEP);
            // The margin keeps the first of two maxima that differ by rounding only.
            if best.is_none_or(|b| top.value > b.value + 4.0 * f64::EPSILON * b.value.abs()) {
                best = Some(top);
            }
        }
        (before, here) = (here, after);
    }
    let mut best = best.expect("the largest of the samples is not below its neighbours");
    // The remainder of an angle just below 0 rounds up to the whole turn.
    best.alpha_rad = best.alpha_rad.rem_euclid(TAU) % TAU;
    best
}

/// Golden-section search for the single maximum between `low` and `high`.
fn refine(curve: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> TurnPeak {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let mut left = high - golden * (high - low);
    let mut right = low + golden * (high - low);
    let (mut at_left, mut at_right) = (curve(left), curve(right));
    for _ in 0..REFINEMENTS {
        if at_left >= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - golden * (high - low);
            at_left = curve(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + golden * (high - low);
            at_right = curve(right);
        }
    }
    let alpha_rad = 0.5 * (low + high);
    TurnPeak {
        alpha_rad,
        value: curve(alpha_rad),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a local maximum is returned as the global one. The curve has forty equal maxima, and a slow term of
    /// 1e-6 raises exactly one of them. Maximum k is at 2πk/40. The slow term is largest at the one nearest to `favourite`,
    /// which is number 0, 11, 23 and 39 in turn.
    #[test]
    fn the_search_finds_a_maximum_higher_by_a_millionth() {
        for k in [0_u32, 11, 23, 39] {
            let favourite = TAU * f64::from(k) / 40.0;
            let peak = max_over_turn(|a| (40.0 * a).cos() + 1e-6 * (a - favourite).cos());
            let away = (peak.alpha_rad - favourite + 1.0).rem_euclid(TAU) - 1.0;
            assert!(away.abs() < 1e-7, "hill {k}: off by {away}");
            assert!((peak.value - 1.000_001).abs() < 1e-13);
        }
    }

    /// If this fails, a maximum between two samples, or at the end of the turn, is missed.
    #[test]
    fn maxima_between_samples_and_at_turn_ends_are_found() {
        for k in 0..1000 {
            let top = TAU * f64::from(k) / 1000.0;
            let peak = max_over_turn(|a| 3.0 * (a - top).cos());
            assert!((peak.value - 3.0).abs() < 1e-13);
            let away = (peak.alpha_rad - top + 1.0).rem_euclid(TAU) - 1.0;
            assert!(away.abs() < 1e-7, "top {top}: off by {away}");
            assert!((0.0..TAU).contains(&peak.alpha_rad));
        }
    }
}
