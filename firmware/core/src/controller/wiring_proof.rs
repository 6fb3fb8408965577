//! Tilts that prove the wiring: about one axis, and about the other. They are computed once from the settings; [`super::homing`] commands
//! them.

use crate::monitor::DriftMonitor;
use crate::phase_offset::PhaseOffsets;
use crate::problem::{Problem, SettingsError};
use crate::settings::Settings;
use crate::units::{PerAxis, Turns};

/// Smallest distance by which any two cranks are moved apart in one of the tilts, in tolerances.
pub(super) const APART: i64 = 3;

/// Returns the tilts that prove the wiring.
///
/// # Errors
/// The trims or the platform do not allow the tilts.
#[cold]
pub(super) fn wiring_patterns(
    settings: &Settings,
    monitor: &DriftMonitor,
    offsets: &PhaseOffsets,
) -> Result<[PerAxis<Turns>; 2], SettingsError> {
    let count = settings.axes.len();
    let tolerances = (0..count).map(|axis| monitor.tolerance(axis));
    let tolerance = tolerances.max().unwrap_or_default();
    let patterns = patterns(count, tolerance);
    // Adds the largest error of a reading.
    let on_top = |level: Turns| level + if level < 0 { -tolerance } else { tolerance };
    for pattern in &patterns {
        // Where a trim has no room for it, a tilt goes the other way.
        if offsets.beyond_limit(pattern).is_some()
            || !monitor.allows(&pattern.map(on_top))
            || !settings.allows_apart(pattern)
            || !settings.allows_apart(&pattern.map(|level| -level))
        {
            let max = pattern.iter().map(|level| level.abs()).max();
            let problem = Problem::WiringPattern {
                deg: max.unwrap_or_default().to_num::<f64>() * 360.0,
            };
            return Err(SettingsError::new("correction.prove_wiring", problem));
        }
    }
    Ok(patterns)
}

/// Returns the tilts that prove the wiring. The levels of each sum to zero.
#[cold]
fn patterns(count: usize, tolerance: Turns) -> [PerAxis<Turns>; 2] {
    let place = |i: usize| {
        let theta = core::f64::consts::TAU * i as f64 / count as f64;
        // Two axes lie on a line, so there is only one tilt.
        let sine = if count == 2 { 0.0 } else { libm::sin(theta) };
        [libm::cos(theta), sine]
    };
    let apart = |i: usize, j: usize| {
        let ([a, b], [c, d]) = (place(i), place(j));
        libm::fabs(a - c).max(libm::fabs(b - d))
    };
    let pairs = (0..count).flat_map(|i| (0..i).map(move |j| apart(i, j)));
    let min = pairs.fold(f64::INFINITY, f64::min);
    let amplitude = tolerance.to_num::<f64>() * APART as f64 / min;
    core::array::from_fn(|tilt| {
        let mut levels = PerAxis::default();
        let mut rest = Turns::ZERO;
        for (i, level) in levels.iter_mut().enumerate().take(count) {
            *level = Turns::from_num(amplitude * place(i)[tilt]);
            // The last axis takes the rounding remainder.
            if i + 1 == count {
                *level = -rest;
            }
            rest += *level;
        }
        levels
    })
}
