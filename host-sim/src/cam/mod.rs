//! Cams with followers: the data of a scene in the terms of their equations, and their drawing.

mod drawing;
mod table;

pub use drawing::draw;
pub use table::{Points, law_at, off_law, off_law_of};

use cophase_methods::problems::{Cam, Law, Links, Shaft};
use cophase_scene::file::{CamShaft, Damper, LawName};

/// Checked cam shaft and its follower.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
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
