//! `[cam]`: cam shafts with elastic followers, instead of cranks under a platform.

use serde::{Deserialize, Serialize};

use super::lengths::some_of;

/// Cam shaft and its follower. Every axis has such a shaft.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CamShaft {
    /// Law of the follower's rise and return.
    #[serde(default)]
    pub law: LawName,
    /// Lift of the pusher, mm.
    pub rise_mm: f64,
    /// Cam angle over which it rises, degrees; it begins at phase 0.
    pub rise_deg: f64,
    /// Cam angle over which it is held, degrees.
    pub dwell_deg: f64,
    /// Cam angle over which it returns, degrees; for the rest of the turn it rests.
    pub return_deg: f64,
    /// Lead of the screws that move the pushers of axes with cam tables, mm per turn; without it, each axis turns a cam.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screw_lead_mm: Option<f64>,
    /// Masses of the follower from the shaft to the pusher, referred to the pusher, kg.
    #[serde(
        default,
        deserialize_with = "some_of",
        skip_serializing_if = "Option::is_none"
    )]
    pub masses_kg: Option<[f64; 3]>,
    /// Stiffnesses before these masses, of shaft, arm and link, N/mm.
    #[serde(
        default,
        deserialize_with = "some_of",
        skip_serializing_if = "Option::is_none"
    )]
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// Dampers in parallel to them, N·s/m; give these or `zeta`.
    #[serde(
        default,
        deserialize_with = "some_of",
        skip_serializing_if = "Option::is_none"
    )]
    pub dampers_ns_per_m: Option<[f64; 3]>,
    /// Damping factor of each link, from which its damper follows; give this or `dampers_ns_per_m`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zeta: Option<f64>,
    /// Second end of the shaft's damper.
    #[serde(default)]
    pub damper: Damper,
}

/// Name of a cam law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawName {
    /// Acceleration as a sine of one period.
    Cycloid,
    /// Cycloid, skewed for the smallest peak.
    SkewedCycloid,
    /// Quarter waves of a sine, steep ones at the ends.
    #[default]
    ModifiedSine,
    /// Quarter waves of a sine around constant acceleration.
    ModifiedTrapezoid,
}

/// Second end of the shaft's damper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Damper {
    /// At the cam: it damps the twist of the shaft.
    #[default]
    Cam,
    /// At the ground, as the source prints it: it damps the motion of the mass.
    Ground,
}
