//! Scene table `[five_bar]`: a suspended five-bar arm and the path of its hand.

use serde::{Deserialize, Serialize};

use super::lengths;

/// Table of a five-bar arm.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct FiveBarTable {
    /// Lengths of links 1, 2 and 4, mm. Link 3 is as long as link 1.
    #[serde(deserialize_with = "lengths::all")]
    pub links_mm: [f64; 3],
    /// Masses of links 1 to 4, kg: uniform rods.
    #[serde(deserialize_with = "lengths::all")]
    pub links_kg: [f64; 4],
    /// Mass of the tool at the hand, kg.
    #[serde(default)]
    pub tool_kg: f64,
    /// Plane of the arm.
    #[serde(default)]
    pub plane: Plane,
    /// Assembly mode of the arm, one of two.
    #[serde(default)]
    pub mode: Assembly,
    /// Points of the hand's path, mm. The path leads from point to point and back to the first.
    #[serde(deserialize_with = "lengths::each")]
    pub path_mm: Vec<[f64; 2]>,
    /// Speed of the hand between the blends, mm/s.
    pub speed_mm_per_s: f64,
    /// Duration of the blend at each end of a line, s.
    pub blend_s: f64,
    /// Smallest permitted |sin(q₁ − q₂)| on the path. At 0 the arm is singular.
    #[serde(default = "default_margin")]
    pub margin: f64,
    /// Pull of the balancer on which the tool hangs, N. 0 means no balancer.
    #[serde(default)]
    pub lift_n: f64,
    /// Length of the rope between balancer and tool, mm. It has an effect only in the horizontal plane.
    #[serde(default = "default_rope_mm")]
    pub rope_mm: f64,
    /// Point below the balancer, mm. The default is the point a quarter along the path, the middle of a path of two points.
    #[serde(
        default,
        deserialize_with = "lengths::some_of",
        skip_serializing_if = "Option::is_none"
    )]
    pub balancer_mm: Option<[f64; 2]>,
    /// Surface along the path that the hand presses against.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactTable>,
}

/// Plane of the arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plane {
    /// Horizontal plane. The tool hangs on a rope above the plane.
    #[default]
    Horizontal,
    /// Vertical plane. Gravity acts against y, and the balancer lifts the hand.
    Vertical,
}

/// Assembly mode of the arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Assembly {
    /// Link 1 is on the left of the line from the axis to the hand, so q₁ is larger.
    #[default]
    Left,
    /// Link 1 is on the right of that line.
    Right,
}

/// Scene table `[five_bar.contact]`: the surface, and the hybrid position and force law.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ContactTable {
    /// Force on the surface, N.
    pub force_n: f64,
    /// Stiffness of the surface, N/mm.
    #[serde(default = "default_stiffness")]
    pub stiffness_n_per_mm: f64,
    /// Damping of the surface, N·s/m.
    #[serde(default = "default_damping")]
    pub damping_ns_per_m: f64,
    /// Gain of the position error along the surface, 1/s².
    #[serde(default = "default_position")]
    pub position_per_s2: f64,
    /// Gain of the velocity error, 1/s.
    #[serde(default = "default_velocity")]
    pub velocity_per_s: f64,
    /// Gain of the integrated force error, 1/s.
    #[serde(default = "default_force")]
    pub force_per_s: f64,
    /// Range of the force sensor in both directions, N.
    #[serde(default = "default_sensor")]
    pub sensor_n: f64,
}

const fn default_margin() -> f64 {
    0.2
}
const fn default_rope_mm() -> f64 {
    1000.0
}
const fn default_stiffness() -> f64 {
    20.0
}
const fn default_damping() -> f64 {
    100.0
}
const fn default_position() -> f64 {
    900.0
}
const fn default_velocity() -> f64 {
    60.0
}
const fn default_force() -> f64 {
    20.0
}
const fn default_sensor() -> f64 {
    2.0 * 9.81 // of the source: 2 kg of weight
}
