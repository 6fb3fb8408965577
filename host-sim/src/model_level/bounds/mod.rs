//! Bounds on the error of a model level relative to the top level, by the effects that it neglects.

mod cranks;
mod followers;
mod frame;
mod linear;
mod required_torque;
mod rods;

use cophase_core::settings::DriveKind;
use cophase_methods::Scheme;
use cophase_methods::accuracy::LONGEST_H_OMEGA;
use cophase_methods::problems::Chain;
use cophase_scene::SceneError;
use cophase_scene::file::{self, Fidelity, Rods};

use super::bounds::cranks::Cranks;
use super::bounds::followers::Followers;
use super::bounds::linear::{Drive, worst};
use crate::checked::Checked;
use crate::checked::Output;
use crate::dynamics::{Body, Frame, Mode, Motor};
use crate::operating_range::OperatingRange;
use crate::simulated_machine::{Rotors, SimulatedMachine};

/// Bounds of all model levels of a scene's machine.
#[derive(Clone, Debug)]
pub struct Bounds {
    of: Of,
    imposed: Option<f64>,
}

#[derive(Clone, Debug)]
enum Of {
    /// Platform on cranks.
    Cranks(Box<Cranks>),
    /// Cams with followers.
    Followers(Followers),
    /// Machine without bounds on its lower model levels.
    None { top: Fidelity },
}

/// A platform on cranks that torque moves.
#[derive(Clone, Copy, Debug)]
struct OnCranks<'a> {
    body: &'a Body,
    /// Motors, one per axis.
    motors: &'a [Motor],
    /// Frame, if it moves.
    frame: Option<&'a Frame>,
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
        if checked.machine.follower().is_some() {
            let top = checked.on(Fidelity::Elastic)?;
            return Ok(Self {
                of: Of::Followers(Followers::new(&top)?),
                imposed: imposed(&top, follower_mode(&top))?,
            });
        }
        if !checked.has_platform() {
            let top = checked.machine.levels().last().copied();
            return Self::none(&checked.on(top.unwrap_or_default())?);
        }
        // The top level for which the scene has data: with a frame, if it has one.
        let top = checked
            .on(Fidelity::Elastic)
            .or_else(|_| checked.on(Fidelity::Phased))?;
        let scene = &checked.scene;
        if (0..scene.axes.count).any(|i| scene.drive(i) == file::Drive::Induction) {
            // The bounds assume linear motors, and the torque of these is not linear.
            return Self::none(&top);
        }
        let machine = SimulatedMachine::new(&top)?;
        let driven = machine.rotors().map(Rotors::driven);
        let driven =
            driven.ok_or_else(|| SceneError::at("machine", "has no cranks that torque moves"))?;
        let platform = OnCranks {
            body: driven
                .body()
                .ok_or_else(|| SceneError::at("machine", "has no platform"))?,
            motors: driven.motors(),
            frame: driven.frame(),
        };
        Ok(Self {
            imposed: imposed(&top, driven.fastest_mode())?,
            of: Of::Cranks(Box::new(cranks(&top, &platform)?)),
        })
    }

    /// Returns the bounds of a machine that has bounds on its top model level only.
    fn none(top: &Checked) -> Result<Self, SceneError> {
        // This call reports the data that the scene lacks for the level.
        SimulatedMachine::new(top)?;
        Ok(Self {
            of: Of::None { top: top.fidelity },
            imposed: None,
        })
    }

    /// Returns the bound on the difference between an output of a model level and that of the top level, in the unit of its tolerance;
    /// `None` if the level does not compute the output, or if there is no bound.
    pub fn of(&self, model_level: Fidelity, output: Output) -> Option<f64> {
        let left_out = match &self.of {
            Of::Cranks(cranks) => cranks.of(model_level, output),
            Of::Followers(followers) => followers.of(model_level, output),
            Of::None { top } if model_level == *top => 0.0,
            Of::None { .. } => f64::INFINITY,
        };
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

    /// Returns the largest distance of a platform on quasi-static rods from its position on elastic ones, µm: the oscillation that its
    /// static response replaces. `None` for machines without quasi-static rods.
    pub fn quasi_static_um(&self) -> Option<f64> {
        match &self.of {
            Of::Cranks(cranks) => {
                Some(cranks.quasi_static_m() * 1e6).filter(|um| um.is_finite() && *um > 0.0)
            }
            Of::Followers(_) | Of::None { .. } => None,
        }
    }

    /// Returns a sentence with the numbers from which the bounds follow.
    pub fn numbers(&self) -> String {
        match &self.of {
            Of::Cranks(cranks) => cranks.numbers(),
            Of::Followers(followers) => followers.numbers(),
            Of::None { .. } => "there are no bounds for this machine".to_owned(),
        }
    }
}

/// Returns the relative error of a mode by the method and step that a scene sets.
fn imposed(top: &Checked, mode: Mode) -> Result<Option<f64>, SceneError> {
    if top.chosen().is_open() {
        return Ok(None);
    }
    let method = SimulatedMachine::new(top)?.method();
    let tick_s = 1.0 / f64::from(top.scene.control.tick_hz);
    Ok(method.map(|(scheme, steps)| {
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
    }))
}

/// Returns the slowest mode of a follower, which dominates its peaks.
fn follower_mode(top: &Checked) -> Mode {
    let chain = top.machine.follower().and_then(|follower| {
        let (links, shaft) = follower.links?;
        Some(Chain::of(follower.cam, shaft, &links))
    });
    chain.map_or_else(Mode::default, |chain| Mode {
        omega_rad_s: chain.modes()[0].omega_rad_s,
        zeta: chain.modes()[0].zeta,
    })
}

fn cranks(checked: &Checked, platform: &OnCranks<'_>) -> Result<Cranks, SceneError> {
    let settings = &checked.settings;
    let drive = Drive {
        top_rad_s: std::f64::consts::TAU * checked.top_speed_hz(),
        // The stop of a fault is the steepest of all ramps.
        acceleration_rad_s2: std::f64::consts::TAU * settings.limits.stop_acceleration_hz_per_s,
        jerk_rad_s3: std::f64::consts::TAU * settings.limits.jerk_hz_per_s2,
        tick_s: 1.0 / f64::from(settings.tick_hz),
        ratios: settings
            .axes
            .iter()
            .map(|axis| axis.follower.most_ratio(&settings.cams))
            .collect(),
        offsets: settings.axes.iter().map(|axis| axis.offset_turns).collect(),
        has_feed_forward: settings
            .axes
            .iter()
            .map(|axis| axis.drive == DriveKind::Servo)
            .collect(),
    };
    let standing = (0..settings.axes.len()).map(|i| {
        let overrides = checked.overrides(i);
        overrides.map_or(0.0, |overrides| {
            (overrides.start_deg + overrides.trim_deg).to_radians()
        })
    });
    let (least, most) = standing.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), deg| {
        (least.min(deg), most.max(deg))
    });
    let range = OperatingRange::new(checked)?;
    let load = range.and_then(|range| range.greatest_load());
    Ok(Cranks::new(
        platform,
        &drive,
        worst(platform, &drive),
        load.map_or(0.0, |load| load.ratio),
        most - least,
        matches!(checked.cranks_apart(), Some("ratio" | "offset_deg")),
        checked
            .scene
            .machine
            .as_ref()
            .map_or((false, 0.0), |machine| {
                (machine.rods == Rods::Elastic, machine.rod_zeta)
            }),
    ))
}
