//! Cams with followers: the data of a scene in the terms of their equations, and their drawing.

mod bounds;
mod chain;
mod drawing;
mod law;
mod pushers;
mod screw;
mod table;

use bounds::OfFollower;
pub use law::{Points, law_at, off_law, off_law_of};
pub use table::links;

use std::sync::Arc;

use cophase_core::settings::AxisSettings;
use cophase_methods::problems::{Cam, Law, Links, Shaft};
use cophase_scene::file::{CamShaft, Damper, Fidelity, LawName};
use cophase_scene::{Scene, SceneError};

use super::follower::{Follower, Peaks, RunStart};
use super::{Bounds, Duty, Machine, NoBounds, Shown};
use crate::mechanism::SquareLaw;
use pushers::Pushers;

/// Name with its article, for messages.
const NAME: &str = "a cam shaft";

/// A cam shaft with its follower on each axis, or a pusher on a screw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamShafts {
    /// Cam, at rest.
    pub cam: Cam,
    /// Elastic links between cam and pusher, and the second end of the first damper; `None` if the scene has none.
    pub links: Option<(Links, Shaft)>,
    /// Lead of the screws that move the pushers, m per turn, if axes follow cam tables.
    pub screw_lead_m: Option<f64>,
}

/// Returns the cam of a scene, at rest at the beginning of its rise.
pub fn cam_of(shaft: &CamShaft) -> Cam {
    Cam {
        law: law(shaft.law),
        stroke_m: shaft.rise_mm / 1e3,
        speed_rad_s: 0.0,
        start_rad: 0.0,
        rise_rad: shaft.rise_deg.to_radians(),
        dwell_rad: shaft.dwell_deg.to_radians(),
        return_rad: shaft.return_deg.to_radians(),
    }
}

/// Returns the cam law of a name.
pub const fn law(name: LawName) -> Law {
    match name {
        LawName::Cycloid => Law::Cycloid,
        LawName::SkewedCycloid => Law::SkewedCycloid,
        LawName::ModifiedSine => Law::ModifiedSine,
        LawName::ModifiedTrapezoid => Law::ModifiedTrapezoid,
    }
}

/// Returns the second end of the shaft's damper.
pub const fn damped(damper: Damper) -> Shaft {
    match damper {
        Damper::Cam => Shaft::DampedToCam,
        Damper::Ground => Shaft::DampedToGround,
    }
}

impl Machine for CamShafts {
    fn name(&self) -> &'static str {
        NAME
    }

    fn axis_noun(&self) -> &'static str {
        "cam"
    }

    fn law(&self) -> SquareLaw {
        SquareLaw::of_length(self.cam.peak_m())
    }

    fn shown(&self) -> Shown {
        Shown::Acceleration("pushers")
    }

    fn draw(&self, _: &str, _: &[AxisSettings]) -> String {
        drawing::draw(self)
    }

    fn levels(&self) -> &'static [Fidelity] {
        &[Fidelity::Kinematic, Fidelity::Elastic]
    }

    fn check_data(&self, _: &Scene, level: Fidelity) -> Result<(), SceneError> {
        if level == Fidelity::Elastic && self.links.is_none() {
            return Err(SceneError::for_key(
                "cam.masses_kg",
                "missing; fidelity = \"elastic\" needs cam.masses_kg, cam.stiffness_n_per_mm, and cam.zeta or \
                 cam.dampers_ns_per_m; or let fidelity be \"kinematic\"",
            ));
        }
        Ok(())
    }

    fn level_without_questions(&self) -> (Fidelity, &'static str) {
        match self.links {
            Some(_) => (
                Fidelity::Elastic,
                "the scene gives the followers' masses and springs, so their motion is required",
            ),
            None => (
                Fidelity::Kinematic,
                "the scene has no masses and springs between cam and pusher, so only phases and the law are required",
            ),
        }
    }

    fn bounds(&self, duty: &Duty<'_>) -> Box<dyn Bounds> {
        match self.links {
            Some(links) => Box::new(OfFollower::new(self.cam, links, duty.top_rad_s)),
            None => Box::new(NoBounds { top: duty.level }),
        }
    }

    fn motion(&self, level: Fidelity) -> &'static str {
        match level {
            Fidelity::Elastic => "springs and masses between cam and pusher",
            _ => "every pusher follows its law exactly",
        }
    }

    fn left_out(&self, level: Fidelity) -> String {
        match level {
            Fidelity::Elastic => {
                "what the followers push back with: the cams turn as commanded, and no roller lifts off"
            }
            _ => "torque, inertia and elasticity: no cam ever lags, and no pusher leaves its law",
        }
        .to_owned()
    }

    fn about_parts(&self, level: Fidelity, worst: &Peaks) -> Option<String> {
        let [pusher_mps2, off_mm, cam_side_mps2, off_mps2] = [
            worst.of("pusher_accel_worst_mps2")?,
            worst.of("off_law_worst_mm")?,
            worst.of("cam_side_accel_worst_mps2")?,
            worst.of("off_law_accel_worst_mps2")?,
        ];
        Some(match (self.screw_lead_m, level) {
            (Some(_), _) => format!(
                "The pushers accelerated by at most {pusher_mps2:.2} m/s², and those of a mechanical cam shaft by {cam_side_mps2:.2} m/s². They differ by at \
                 most {off_mm:.4} mm and {off_mps2:.3} m/s²."
            ),
            (None, Fidelity::Elastic) => format!(
                "The pushers accelerated by at most {pusher_mps2:.1} m/s² and were at most {off_mm:.3} mm off their law."
            ),
            (None, _) => format!(
                "The pushers accelerated by at most {pusher_mps2:.1} m/s², as their law has it."
            ),
        })
    }

    fn about_method(&self, level: Fidelity) -> Option<&'static str> {
        (level == Fidelity::Elastic).then_some(
            "the follower is linear, so that nothing is unstable or damped by the method; a peak is looked at every \
             0.05 rad of the slowest mode",
        )
    }

    fn moves_by_torque(&self, _: Fidelity) -> bool {
        false
    }

    fn follower(self: Arc<Self>, start: &RunStart<'_>) -> Result<Box<dyn Follower>, SceneError> {
        Ok(Box::new(Pushers::new(&self, start)?))
    }
}
