//! Bounds on the error of a model level relative to the top level, by the effects that it neglects.

use std::sync::Arc;

use cophase_methods::Scheme;
use cophase_methods::accuracy::LONGEST_H_OMEGA;
use cophase_scene::SceneError;
use cophase_scene::file::Fidelity;

use crate::checked::Checked;
use crate::dynamics::Mode;
use crate::machines::{self, Duty};
use crate::operating_range::OperatingRange;
use crate::output::Output;
use crate::simulated_machine::{Rotors, SimulatedMachine};

/// Bounds of all model levels of a scene's machine.
#[derive(Clone, Debug)]
pub struct Bounds {
    of_machine: Arc<dyn machines::Bounds>,
    imposed: Option<f64>,
}

/// Allowance for rounding, in the unit of each output. Symmetrical cranks are exactly in phase in theory, and differ by rounding
/// errors.
const ROUNDING: f64 = 1e-6;

impl Bounds {
    /// Computes the bounds of a scene.
    ///
    /// # Errors
    /// The scene lacks data for them.
    pub fn new(checked: &Checked) -> Result<Self, SceneError> {
        let top = top(checked)?;
        let machine = SimulatedMachine::new(&top)?;
        let driven = machine.rotors().map(Rotors::driven);
        let of_machine = top.machine.bounds(&Duty {
            driven,
            ..duty(&top)?
        });
        let imposed = match of_machine.mode() {
            Some(mode) if !top.chosen().is_open() => imposed(&top, &machine, mode),
            _ => None,
        };
        Ok(Self {
            of_machine: of_machine.into(),
            imposed,
        })
    }

    /// Returns the bound on the difference between an output of a model level and that of the top level, in the unit of its tolerance;
    /// `None` if the level does not compute the output, or if there is no bound.
    pub fn of(&self, model_level: Fidelity, output: Output) -> Option<f64> {
        let left_out = self.of_machine.of(model_level, output);
        let off = match output {
            // The difference is relative to the level's own value, and the tolerance to the exact value, which may be smaller by as much.
            Output::Amax | Output::Torque if left_out < 100.0 => left_out / (1.0 - 0.01 * left_out),
            Output::Amax | Output::Torque => f64::INFINITY,
            _ => left_out,
        };
        off.is_finite().then_some(off + ROUNDING)
    }

    /// Returns the relative error of oscillations by a method or step that the scene sets; `None` if it sets neither.
    pub fn imposed(&self) -> Option<f64> {
        self.imposed
    }

    /// Returns the same bound plus the errors of two levels' methods, each with a relative error `resolution` of oscillations; `None`
    /// if their size is not known.
    pub fn with_steps(
        &self,
        model_level: Fidelity,
        output: Output,
        resolution: f64,
    ) -> Option<f64> {
        let left_out = self.of(model_level, output)?;
        if output == Output::Slips {
            return Some(left_out);
        }
        let whole = self.of(Fidelity::QuasiStatic, output)?;
        Some(left_out + 2.0 * resolution * whole)
    }

    /// Returns the largest distance by which the static response that a model level has in place of an oscillation is off, µm. `None` if
    /// the level replaces none.
    pub fn quasi_static_um(&self, model_level: Fidelity) -> Option<f64> {
        let um = self.of_machine.quasi_static_m(model_level)? * 1e6;
        Some(um).filter(|um| um.is_finite() && *um > 0.0)
    }

    /// Returns a sentence with the numbers from which the bounds follow.
    pub fn numbers(&self) -> String {
        self.of_machine.numbers()
    }
}

/// Returns the scene on its machine's top model level: the highest with which the machine compares the others, and for which the scene has
/// data.
fn top(checked: &Checked) -> Result<Checked, SceneError> {
    let mut tops = checked.machine.top_levels().iter().rev();
    let highest = tops.next().copied().unwrap_or(Fidelity::Auto);
    tops.fold(checked.on(highest), |top, &lower| {
        top.or_else(|_| checked.on(lower))
    })
}

/// Returns what the bounds have to know of a scene, except for its motors.
fn duty(top: &Checked) -> Result<Duty<'static>, SceneError> {
    let settings = &top.settings;
    let standing = (0..settings.axes.len()).map(|i| {
        let own = top.scene.resolved(i).own;
        (own.start_deg + own.trim_deg).to_radians()
    });
    let (min, max) = standing.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), rad| {
        (min.min(rad), max.max(rad))
    });
    let load = OperatingRange::new(top)?.and_then(|range| range.max_load());
    Ok(Duty {
        level: top.fidelity,
        driven: None,
        top_rad_s: std::f64::consts::TAU * top.top_speed_hz(),
        // The stop of a fault is the steepest of all ramps.
        acceleration_rad_s2: std::f64::consts::TAU * settings.limits.stop_acceleration_hz_per_s,
        jerk_rad_s3: std::f64::consts::TAU * settings.limits.jerk_hz_per_s2,
        tick_s: 1.0 / f64::from(settings.tick_hz),
        ratios: settings
            .axes
            .iter()
            .map(|axis| axis.follower.max_ratio(&settings.cams))
            .collect(),
        offsets: settings.axes.iter().map(|axis| axis.offset_turns).collect(),
        has_feed_forward: settings
            .axes
            .iter()
            .map(|axis| !axis.drive.takes_pulses())
            .collect(),
        standing_apart_rad: max - min,
        leads_apart: matches!(top.cranks_apart(), Some("ratio" | "offset_deg")),
        steady_load: load.map_or(0.0, |load| load.ratio),
    })
}

/// Returns the relative error of a mode by the method and step that a scene sets.
fn imposed(top: &Checked, machine: &SimulatedMachine, mode: Mode) -> Option<f64> {
    let tick_s = 1.0 / f64::from(top.scene.control.tick_hz);
    machine.method().map(|(scheme, steps)| {
        let h_omega = mode.omega_rad_s * tick_s / f64::from(steps);
        // A mode that the step does not resolve is wrong altogether. Exact discretisation must resolve the excitation only.
        if h_omega > LONGEST_H_OMEGA && scheme != Scheme::Exact {
            return 1.0;
        }
        let zeta = mode.zeta.min(0.99);
        let forgotten =
            scheme.error_a_radian(h_omega.min(LONGEST_H_OMEGA), zeta) / (2.0 * zeta.max(0.005));
        // Methods of order 1 have positions and speeds that are half a step apart.
        let ripple = if scheme.facts().order == 1 {
            0.5 * h_omega
        } else {
            0.0
        };
        forgotten.max(ripple).min(1.0)
    })
}
