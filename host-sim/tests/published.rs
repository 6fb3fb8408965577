//! The computable part of the source's control section: the slope of the root of a ramp at its start.
//!
//! The rest of the published and calculated figures is in `design.rs`. `docs/reproduced.md` lists them all.

use host_sim::mechanism::Mechanism;
use host_sim::mechanism::slider_crank::SliderCrank;

/// Speed of a mechanism whose amax rises evenly from 0 to `full_mps2` in 1 s, and its slope by central differences. Steps
/// of 1e-5 of the time give an error of (1e-5)² · 5/8 of the slope.
fn ramp(mechanism: &SliderCrank, full_mps2: f64, t_s: f64) -> (f64, f64) {
    let omega_rad_s = |t_s: f64| mechanism.speed_for_amax_rad_s(full_mps2 * t_s);
    let by_s = 1e-5 * t_s;
    let slope_rad_s2 = (omega_rad_s(t_s + by_s) - omega_rad_s(t_s - by_s)) / (2.0 * by_s);
    (omega_rad_s(t_s), slope_rad_s2)
}

/// Item 10. If this fails, speed does not follow amax by ω = √(amax / (R (1 + λ))), and our statement about the start is
/// wrong: before these times the crank's angular acceleration, R α″, is more than R ω² itself.
///
/// Calculated: 8.59 ms for example 1, 63.27 ms for example 4, here to half a unit of their last place. In closed form
/// ω = w √t, so that ω′ = ω² at t = (2 w)^(−2/3).
#[test]
fn tangential_acceleration_exceeds_centripetal_at_ramp_start() {
    for (g, freq_hz, lambda, published_ms) in [(200.0, 100.0, 0.1, 8.59), (10.0, 5.0, 0.3, 63.27)] {
        let full_mps2 = g * 10.0;
        let omega_rad_s = freq_hz * core::f64::consts::TAU;
        let mechanism = SliderCrank::for_amax(full_mps2, omega_rad_s, lambda).unwrap();
        let (mut before_s, mut after_s) = (1e-6, 1.0);
        for _ in 0..60 {
            let middle_s = 0.5 * (before_s + after_s);
            let (omega, slope) = ramp(&mechanism, full_mps2, middle_s);
            if slope > omega * omega {
                before_s = middle_s;
            } else {
                after_s = middle_s;
            }
        }
        let (found_ms, closed_ms) = (1e3 * after_s, 1e3 * (2.0 * omega_rad_s).powf(-2.0 / 3.0));
        assert!(
            (found_ms - published_ms).abs() < 5e-3,
            "{found_ms} ms, published {published_ms}"
        );
        assert!((found_ms / closed_ms - 1.0).abs() < 1e-8, "{found_ms} ms");
        // A start without a limit is impossible, too: the slope grows as 1/√t.
        let (_, early) = ramp(&mechanism, full_mps2, 1e-8 * after_s);
        let (_, there) = ramp(&mechanism, full_mps2, after_s);
        assert!((early / there - 1e4).abs() < 1.0, "{early}, {there} rad/s²");
    }
}
