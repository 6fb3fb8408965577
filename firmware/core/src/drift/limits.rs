//! How far the modes may go.

use super::Modes;
use crate::functions::multiply;
use crate::settings::{DriftSettings, MachineSettings, turns};
use crate::supervisor::{Fault, FaultKind};
use crate::units::Turns;

/// Limits on the modes, in turns of crank angle.
///
/// A limit on tilt is one on the platform: an error of mode 1 with amplitude e (radians of crank) at a
/// mount radius ρ tilts it by s(α) R e/ρ. The limit is for the crank angle at which that is worst, so
/// that one measurement a turn bounds the tilt over the whole turn.
#[derive(Clone, Copy, Debug)]
pub struct DriftLimits {
    tilt_squared: u64,
    warp: Turns,
    common: Turns,
    /// Turns after which an index pulse is overdue: one, and what the common limit allows.
    pub(super) index_turns: Turns,
}

impl DriftLimits {
    /// From checked settings.
    pub fn new(settings: &DriftSettings, machine: &MachineSettings) -> Self {
        let mrad_per_turn =
            1e3 * core::f64::consts::TAU * machine.crank_radius_m * most_way(machine)
                / machine.mount_radius_m;
        let common = settings.common_limit_deg / 360.0;
        Self {
            tilt_squared: square(turns((settings.tilt_limit_mrad / mrad_per_turn).min(0.5))),
            warp: turns(settings.warp_limit_deg / 360.0),
            common: turns(common),
            index_turns: turns(1.0 + common.max(0.02)),
        }
    }

    pub(super) fn check<const N: usize>(
        &self,
        modes: &Modes,
        drift: &[Turns; N],
    ) -> Result<(), Fault> {
        if square(modes.tilt_x) + square(modes.tilt_y) > self.tilt_squared {
            let axes = drift.iter().enumerate();
            let worst = axes.max_by_key(|(_, drift)| (**drift - modes.common).abs());
            let fault = Fault::new(FaultKind::Tilt);
            return Err(worst.map_or(fault, |(axis, &drift)| fault.on_axis(axis).with_size(drift)));
        }
        if modes.warp > self.warp {
            let fault = Fault::new(FaultKind::Warp).on_axis(modes.warp_axis);
            let size = drift.get(modes.warp_axis).copied();
            return Err(fault.with_size(size.unwrap_or_default()));
        }
        if modes.common.abs() > self.common {
            return Err(Fault::new(FaultKind::CommonLag).with_size(modes.common));
        }
        Ok(())
    }
}

/// The square, in units of 2⁻³⁰ turn, of up to 2 turns: the sum of two fits.
const fn square(turns: Turns) -> u64 {
    let scaled = (turns.to_bits().unsigned_abs() >> 18) as u32;
    multiply(scaled, scaled)
}

/// Greatest way of the platform per radian of crank and metre of radius, max s(α) = max (sin α + λ sin α cos α / cos β).
fn most_way(machine: &MachineSettings) -> f64 {
    let lambda = machine.lambda;
    // s is smooth, with one maximum in the first half turn; half a degree finds it to 4e-5.
    (0..360)
        .map(|half_degree| {
            let alpha = f64::from(half_degree) * core::f64::consts::PI / 360.0;
            let (sin, cos) = (libm::sin(alpha), libm::cos(alpha));
            sin + lambda * sin * cos / libm::sqrt(1.0 - lambda * lambda * sin * sin)
        })
        .fold(0.0, f64::max)
}
