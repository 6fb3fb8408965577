//! A platform on cranks.

mod assembly;
mod bounds;
mod dynamics;
mod geometry;
mod table;

pub use geometry::Platform;
pub use table::platform;

use std::sync::Arc;

use cophase_core::settings::{AxisSettings, Settings};
use cophase_scene::file::{self, Fidelity, Rods};
use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use cophase_scene::{Scene, SceneError};

use super::follower::{Follower, RunStart};
use super::{Bounds, Duty, Machine, NoBounds, Shown};
use crate::dynamics::{Driven, Dynamics, RotorParts};
use crate::mechanism::turn_search::max_over_turn;
use crate::mechanism::{Mechanism, Mount, SquareLaw};
use bounds::{Cranks, OnCranks};

/// Name, for messages.
const NAME: &str = "one platform";

/// Cranks under one platform, one an axis.
#[derive(Clone, Debug)]
pub struct CranksUnderPlatform {
    platform: Platform,
    /// Its table in the scene.
    given: file::Machine,
    /// Frame under the cranks, if it moves.
    frame: Option<file::Frame>,
}

impl CranksUnderPlatform {
    /// True if more cranks hold the platform than a plane has places.
    fn is_over_constrained(&self) -> bool {
        self.platform.axes() > 3
    }

    /// Effects of the rods that an integrated model level omits, in words, each followed by a comma.
    fn left_out_of_rods(&self) -> String {
        let links = self.platform.mechanism().links();
        match (self.given.rods, self.is_over_constrained()) {
            (Rods::Elastic, _) => String::new(),
            (Rods::QuasiStatic, false) => format!("{links} that give, "),
            (Rods::QuasiStatic, true) => format!("the {links}' own oscillation, "),
        }
    }

    /// How an over-constrained platform lies on rods that have no oscillation, in words.
    fn lies(&self) -> String {
        if self.given.rods == Rods::Elastic || !self.is_over_constrained() {
            return String::new();
        }
        format!(
            "; more than three cranks over-constrain the platform, so that it lies in the plane that loads the {} least",
            self.platform.mechanism().links()
        )
    }
}

impl Machine for CranksUnderPlatform {
    fn name(&self) -> &'static str {
        NAME
    }

    fn axis_noun(&self) -> &'static str {
        "crank"
    }

    fn law(&self) -> SquareLaw {
        self.platform.mechanism().law()
    }

    fn shown(&self) -> Shown {
        Shown::Tilt
    }

    fn about_amax(&self, accel_worst_mps2: Option<f64>) -> Option<String> {
        let accelerated = accel_worst_mps2.filter(|mps2| *mps2 > 0.0)?;
        Some(format!(
            "The platform itself accelerated by at most {:.1} g.",
            accelerated / STANDARD_GRAVITY_MPS2
        ))
    }

    fn about_method(&self, level: Fidelity) -> Option<&'static str> {
        (level == Fidelity::QuasiStatic).then_some(
            "torques follow from the motion, and slips from torques: nothing is integrated",
        )
    }

    fn causes_of_torque(&self) -> &'static str {
        "at its load, and at cranks that stand apart and bend rods (offset_deg, start_deg, machine.rod_n_per_um)"
    }

    fn draw(&self, scene: &str, axes: &[AxisSettings]) -> String {
        let load = self.platform.load();
        self.platform.mechanism().draw(&Mount {
            name: scene.to_owned(),
            reversed: axes.iter().map(|axis| axis.reversed).collect(),
            is_below: load.platform == crate::mechanism::Platform::Below,
            radius_m: self.platform.mount_radius_m(),
            load_kg: load.mass_kg,
        })
    }

    fn levels(&self) -> &'static [Fidelity] {
        &[
            Fidelity::Kinematic,
            Fidelity::QuasiStatic,
            Fidelity::Rigid,
            Fidelity::Phased,
            Fidelity::Elastic,
        ]
    }

    fn top_levels(&self) -> &'static [Fidelity] {
        &[Fidelity::Phased, Fidelity::Elastic]
    }

    fn bounds(&self, duty: &Duty<'_>) -> Box<dyn Bounds> {
        let none = NoBounds { top: duty.level };
        let Some((driven, body)) = duty
            .driven
            .and_then(|driven| Some((driven, driven.body()?)))
        else {
            return Box::new(none);
        };
        let motors = driven.motors();
        // The bounds assume motors whose torque is linear.
        if !motors.iter().all(|motor| motor.is_linear()) {
            return Box::new(none);
        }
        let on_cranks = OnCranks {
            body,
            motors,
            frame: driven.frame(),
            mode: driven.fastest_mode(),
        };
        let rods = (self.given.rods, self.given.rod_zeta);
        Box::new(Cranks::new(&on_cranks, duty, rods))
    }

    fn check_data(&self, scene: &Scene, level: Fidelity) -> Result<(), SceneError> {
        if level == Fidelity::QuasiStatic && scene.axes.pull_out.is_empty() {
            return Err(SceneError::for_key(
                "axes.pull_out",
                "missing; fidelity = \"quasi-static\" compares torques, so give the motors' pull-out torque \
                 as [[speed_hz, torque_nm], …], or let fidelity be \"kinematic\"",
            ));
        }
        Ok(())
    }

    fn motion(&self, level: Fidelity) -> &'static str {
        match level {
            Fidelity::Auto | Fidelity::Kinematic => "only a fault moves a crank off its command",
            Fidelity::QuasiStatic => {
                "only a fault, or a load beyond its motor's torque, moves a crank off its command"
            }
            Fidelity::Rigid => "torque moves all cranks as one shaft",
            Fidelity::Phased => "torque moves each crank on its own",
            Fidelity::Elastic => {
                "torque moves each crank on its own, and the frame moves on springs"
            }
        }
    }

    fn left_out(&self, level: Fidelity) -> String {
        let (of_rods, lies) = (self.left_out_of_rods(), self.lies());
        match level {
            Fidelity::Auto | Fidelity::Kinematic => {
                "torque, inertia and elasticity: no crank ever lags".to_owned()
            }
            Fidelity::QuasiStatic => {
                "inertia's effect on the cranks' motion, elasticity, and how a slip loads the other motors".to_owned()
            }
            Fidelity::Rigid => {
                "each crank's own lag, tilt from torque, elasticity, microsteps: the cranks are one shaft".to_owned()
            }
            Fidelity::Phased => format!("{of_rods}microsteps, suspension and foundation{lies}"),
            Fidelity::Elastic => {
                format!("{of_rods}microsteps, and forces on the frame across the line of travel{lies}")
            }
        }
    }

    fn dynamics(
        self: Arc<Self>,
        level: Fidelity,
        rotors: RotorParts,
    ) -> Result<Box<dyn Dynamics>, SceneError> {
        self.on_level(level, rotors)
    }

    fn follower(self: Arc<Self>, _: &RunStart<'_>) -> Result<Box<dyn Follower>, SceneError> {
        Ok(Box::new(self.platform.clone()))
    }

    fn check_driven(
        &self,
        level: Fidelity,
        driven: &Driven,
        settings: &Settings,
        apart: Option<&str>,
    ) -> Result<(), SceneError> {
        match apart {
            Some(apart) if level == Fidelity::Rigid => Err(SceneError::for_key(
                "fidelity",
                format!(
                    "\"rigid\" has all cranks at one angle on one shaft, and {apart} has them at others; let it be \"phased\""
                ),
            )),
            _ => assembly::check(driven, settings, apart),
        }
    }

    fn mount_radius_m(&self) -> f64 {
        self.platform.mount_radius_m()
    }

    fn carried_kgm2(&self) -> Option<f64> {
        let mechanism = self.platform.mechanism();
        let s = max_over_turn(|alpha| mechanism.s(alpha).abs()).value;
        let lever_m = mechanism.crank_radius_m() * s;
        let load_kg = self.platform.load().mass_kg;
        Some(load_kg / self.platform.axes() as f64 * lever_m * lever_m)
    }
}
