//! `[cam]`: cam shafts with elastic followers, instead of cranks under a platform.

use cophase_methods::problems::{Cam, Law, Shaft};
use serde::{Deserialize, Serialize};

use super::lengths::some_three;

/// A cam shaft and its follower; every axis has one of them.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CamShaft {
    /// How the follower rises and returns.
    #[serde(default)]
    pub law: LawName,
    /// How far the pusher rises, mm.
    pub rise_mm: f64,
    /// Cam angle over which it rises, degrees; it begins at phase 0.
    pub rise_deg: f64,
    /// Cam angle over which it is held, degrees.
    pub dwell_deg: f64,
    /// Cam angle over which it returns, degrees; for the rest of the turn it rests.
    pub return_deg: f64,
    /// Lead of the screws on which axes that follow cam tables carry the pushers, mm a turn; without it, each axis turns a cam.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screw_lead_mm: Option<f64>,
    /// Masses of the follower from the shaft to the pusher, carried to the pusher, kg.
    #[serde(
        default,
        deserialize_with = "some_three",
        skip_serializing_if = "Option::is_none"
    )]
    pub masses_kg: Option<[f64; 3]>,
    /// Stiffnesses before these masses: shaft, arm, link; N/mm.
    #[serde(
        default,
        deserialize_with = "some_three",
        skip_serializing_if = "Option::is_none"
    )]
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// Dampers beside them, N·s/m; give these or `zeta`.
    #[serde(
        default,
        deserialize_with = "some_three",
        skip_serializing_if = "Option::is_none"
    )]
    pub dampers_ns_per_m: Option<[f64; 3]>,
    /// Damping factor of each link, from which its damper follows; give this or `dampers_ns_per_m`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zeta: Option<f64>,
    /// Where the damper of the shaft ends.
    #[serde(default)]
    pub damper: Damper,
}

impl CamShaft {
    /// The cam, at rest at the beginning of its rise.
    pub fn cam(&self) -> Cam {
        Cam {
            law: self.law.into(),
            stroke_m: self.rise_mm / 1e3,
            speed_rad_s: 0.0,
            start_rad: 0.0,
            rise_rad: self.rise_deg.to_radians(),
            dwell_rad: self.dwell_deg.to_radians(),
            return_rad: self.return_deg.to_radians(),
        }
    }
}

/// A cam law by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawName {
    /// A sine of one period.
    Cycloid,
    /// The cycloid sheared for the smallest peak.
    SkewedCycloid,
    /// Quarter waves of a sine, steep ones at the ends.
    #[default]
    ModifiedSine,
    /// Quarter waves of a sine around constant acceleration.
    ModifiedTrapezoid,
}

impl From<LawName> for Law {
    fn from(name: LawName) -> Self {
        match name {
            LawName::Cycloid => Self::Cycloid,
            LawName::SkewedCycloid => Self::SkewedCycloid,
            LawName::ModifiedSine => Self::ModifiedSine,
            LawName::ModifiedTrapezoid => Self::ModifiedTrapezoid,
        }
    }
}

/// Where the damper of the shaft ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Damper {
    /// At the cam: it brakes what the shaft gives.
    #[default]
    Cam,
    /// At the ground, as the source prints it: it brakes the motion itself.
    Ground,
}

impl From<Damper> for Shaft {
    fn from(damper: Damper) -> Self {
        match damper {
            Damper::Cam => Self::DampedToCam,
            Damper::Ground => Self::DampedToGround,
        }
    }
}
