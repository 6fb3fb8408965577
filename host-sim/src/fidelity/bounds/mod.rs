//! By how much a rung may be off the top one, for what it leaves out.

mod asked;
mod cranks;
mod followers;
mod frame;
mod linear;
mod rods;

use cophase_core::settings::Settings;

use super::Output;
use crate::dynamics::Driven;
use crate::machine::{Machine, Rotors};
use crate::scene::file::{Fidelity, Rods};
use crate::scene::{Checked, SceneError};
use crate::with_axes;
use cranks::Cranks;
use followers::Followers;
use linear::{Drive, worst};

/// Bounds of all rungs of a scene's machine.
#[derive(Clone, Debug)]
pub enum Bounds {
    /// A platform on cranks.
    Cranks(Box<Cranks>),
    /// Cams with followers.
    Followers(Followers),
}

/// What rounding may add, in the unit of each output: symmetrical cranks, which theory has exactly in phase, are told apart
/// by it.
const ROUNDING: f64 = 1e-6;

impl Bounds {
    /// Of a scene, by all that it says.
    ///
    /// # Errors
    /// What the scene lacks for that.
    pub fn new(checked: &Checked) -> Result<Self, SceneError> {
        if checked.cam.is_some() {
            return Followers::new(checked).map(Self::Followers);
        }
        // The top rung that the scene has: with a frame, if it gives one.
        let top = checked
            .on(Fidelity::Elastic)
            .or_else(|_| checked.on(Fidelity::Phased))?;
        with_axes!(checked.scene.axes.count, N => {
            let machine = Machine::<N>::new(&top)?;
            let settings = top.settings::<N>()?;
            let driven = machine.rotors().map(Rotors::driven);
            let driven = driven.ok_or_else(|| SceneError::at("machine", "has no cranks that torque moves"))?;
            Ok(Self::Cranks(Box::new(cranks(&top, &settings, driven))))
        })
    }

    /// By how much a rung's output may be off the top rung's, in the unit of its tolerance; infinite where the rung cannot
    /// answer, or nothing bounds it.
    pub fn of(&self, rung: Fidelity, output: Output) -> f64 {
        let left_out = match self {
            Self::Cranks(cranks) => cranks.of(rung, output),
            Self::Followers(followers) => followers.of(rung, output),
        };
        let off = match output {
            // What is left out is a part of what the rung has; what is asked for, of what is right: less by as much.
            Output::Amax | Output::Torque if left_out < 100.0 => left_out / (1.0 - 0.01 * left_out),
            Output::Amax | Output::Torque => f64::INFINITY,
            _ => left_out,
        };
        off + ROUNDING
    }

    /// The same with what the steps of two rungs' methods may be apart, each being off what swings by `resolution` of it.
    pub fn with_steps(&self, rung: Fidelity, output: Output, resolution: f64) -> f64 {
        let whole = self.of(Fidelity::QuasiStatic, output);
        let steps = if whole.is_finite() && output != Output::Slips {
            2.0 * resolution * whole
        } else {
            0.0
        };
        self.of(rung, output) + steps
    }

    /// How far a platform on settled rods is from where it would be on springs at most, µm: the oscillation that was
    /// replaced by its static response. None where there is no such.
    pub fn settled_um(&self) -> Option<f64> {
        match self {
            Self::Cranks(cranks) => Some(cranks.settled_m() * 1e6).filter(|&um| um > 0.0),
            Self::Followers(_) => None,
        }
    }

    /// The numbers that they are made of, in words.
    pub fn numbers(&self) -> String {
        match self {
            Self::Cranks(cranks) => cranks.numbers(),
            Self::Followers(followers) => followers.numbers(),
        }
    }
}

fn cranks<const N: usize>(checked: &Checked, settings: &Settings<N>, driven: &Driven) -> Cranks {
    let limits = &checked.scene.limits;
    let drive = Drive {
        top_rad_s: std::f64::consts::TAU * checked.top_speed_hz(),
        acceleration_rad_s2: std::f64::consts::TAU * limits.acceleration_hz_per_s,
        tick_s: 1.0 / f64::from(settings.tick_hz),
        ratios: settings
            .axes
            .iter()
            .map(|axis| f64::from(axis.ratio.0) / f64::from(axis.ratio.1))
            .collect(),
        offsets: settings.axes.iter().map(|axis| axis.offset_turns).collect(),
    };
    let standing = (0..N).map(|i| {
        let apart = checked.apart(i);
        apart.map_or(0.0, |apart| (apart.start_deg + apart.trim_deg).to_radians())
    });
    let (least, most) = standing.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), deg| {
        (least.min(deg), most.max(deg))
    });
    Cranks::new(
        driven,
        &drive,
        worst(driven, &drive),
        most - least,
        checked
            .scene
            .machine
            .as_ref()
            .map_or((false, 0.0), |machine| {
                (machine.rods == Rods::Sprung, machine.rod_zeta)
            }),
    )
}
