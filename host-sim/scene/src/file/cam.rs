//! `[cam]`: cam shafts with elastic followers, instead of cranks under a platform.

use cophase_core::settings::key::{needed, optional, or_value};
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

keys! {
    /// Cam shaft and its follower. Every axis has such a shaft.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct CamShaft {
        /// Law of the follower's rise and return.
        law: LawName = or_value("modified-sine"),
        /// Lift of the pusher, mm.
        rise_mm: f64 = needed("84").from(0.1, 1000.0),
        /// Cam angle over which it rises, degrees; it begins at phase 0.
        rise_deg: f64 = needed("120").from(5.0, 355.0),
        /// Cam angle over which it is held, degrees.
        dwell_deg: f64 = needed("135").from(0.0, 350.0),
        /// Cam angle over which it returns, degrees; for the rest of the turn it rests.
        return_deg: f64 = needed("105").from(5.0, 355.0),
        /// Lead of the screws that move the pushers of axes with cam tables, mm per turn; without it, each axis turns a cam.
        screw_lead_mm: Option<f64> = optional("20").from(0.1, 1000.0),
        /// Masses of the follower from the shaft to the pusher, referred to the pusher, kg.
        masses_kg: Option<[f64; 3]> = optional("[0.525, 0.102, 1.01]").from(1e-4, 1000.0),
        /// Stiffnesses before these masses, of shaft, arm and link, N/mm.
        stiffness_n_per_mm: Option<[f64; 3]> = optional("[7680, 7500, 102000]").from(0.1, 1e7),
        /// Dampers in parallel to them, N·s/m; give these or `zeta`.
        dampers_ns_per_m: Option<[f64; 3]> = optional("[10, 10, 10]").from(0.0, 1e7),
        /// Damping factor of each link, from which its damper follows; give this or `dampers_ns_per_m`.
        zeta: Option<f64> = optional("0.1").from(0.0, 2.0),
        /// Second end of the shaft's damper.
        damper: Damper = or_value("cam"),
    }
}

words! {
    /// Name of a cam law.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum LawName {
        /// Acceleration as a sine of one period.
        Cycloid = "cycloid",
        /// Cycloid, skewed for the smallest peak.
        SkewedCycloid = "skewed-cycloid",
        /// Quarter waves of a sine, steep ones at the ends.
        ModifiedSine = "modified-sine",
        /// Quarter waves of a sine around constant acceleration.
        ModifiedTrapezoid = "modified-trapezoid",
    }
}

words! {
    /// Second end of the shaft's damper.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Damper {
        /// At the cam: it damps the twist of the shaft.
        Cam = "cam",
        /// At the ground, as the source prints it: it damps the motion of the mass.
        Ground = "ground",
    }
}
