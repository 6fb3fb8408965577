//! Belt, shaft and bearings of a screen, in the units of its source: kgf and mm.

use core::f64::consts::PI;

/// Length of an open belt over two pulleys, mm: 2 A + π (D₁ + D₂) / 2 + (D₂ − D₁)² / (4 A), for their distance A. The error is
/// of the order of (D₂ − D₁)⁴ / A³.
#[must_use]
pub fn belt_mm(distance_mm: f64, pulleys_mm: [f64; 2]) -> f64 {
    let [one, other] = pulleys_mm;
    2.0 * distance_mm + PI / 2.0 * (one + other) + (other - one).powi(2) / (4.0 * distance_mm)
}

/// Speed of a belt on a pulley, m/s.
#[must_use]
pub fn belt_mps(pulley_mm: f64, rpm: f64) -> f64 {
    PI * pulley_mm * 1e-3 * rpm / 60.0
}

/// Greatest bending moment under an even load, kgf mm, and its distance from where the load begins, mm: M + V² / (2 q) at V / q, for the moment M
/// and the shear force V there.
#[must_use]
pub fn max_moment(moment_kgf_mm: f64, shear_kgf: f64, load_kgf_per_mm: f64) -> (f64, f64) {
    let at_mm = shear_kgf / load_kgf_per_mm;
    (moment_kgf_mm + 0.5 * shear_kgf * at_mm, at_mm)
}

/// Bending stress, kgf/cm², of a moment in kgf mm on a section modulus in cm³.
#[must_use]
pub fn stress_kgf_per_cm2(moment_kgf_mm: f64, section_cm3: f64) -> f64 {
    0.1 * moment_kgf_mm / section_cm3
}

/// Basic rating life of a roller bearing, h: 10⁶ / (60 n) · (C / P)^(10/3) (ISO 281).
#[must_use]
pub fn bearing_life_h(rating_kgf: f64, load_kgf: f64, rpm: f64) -> f64 {
    1e6 / (60.0 * rpm) * (rating_kgf / load_kgf).powf(10.0 / 3.0)
}
