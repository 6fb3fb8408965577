//! Scene table `[five_bar]`: a suspended five-bar arm and the path of its hand.

use cophase_core::settings::key::{needed, optional, or, or_value};
use cophase_core::{keys, words};
use serde::{Deserialize, Serialize};

keys! {
    /// Table of a five-bar arm.
    #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
    pub struct FiveBarTable {
        /// Lengths of links 1, 2 and 4, mm. Link 3 is as long as link 1.
        links_mm: [f64; 3] = needed("[250, 100, 250]").from(1.0, 10_000.0),
        /// Masses of links 1 to 4, kg: uniform rods.
        links_kg: [f64; 4] = needed("[1.2, 0.6, 0.6, 1.0]").from(1e-3, 1e4),
        /// Mass of the tool at the hand, kg.
        tool_kg: f64 = or(0.0).from(0.0, 1e4),
        /// Plane of the arm.
        plane: Plane = or_value("horizontal"),
        /// Assembly mode of the arm, one of two.
        mode: Assembly = or_value("left"),
        /// Points of the hand's path, mm. The path leads from point to point and back to the first.
        path_mm: Vec<[f64; 2]> = needed("[[0, 300], [200, 300]]").from(-20_000.0, 20_000.0),
        /// Speed of the hand between the blends, mm/s.
        speed_mm_per_s: f64 = needed("21.0526").from(1e-3, 1e5),
        /// Duration of the blend at each end of a line, s.
        blend_s: f64 = needed("0.5").from(1e-3, 1e3),
        /// Smallest permitted |sin(q₁ − q₂)| on the path. At 0 the arm is singular.
        margin: f64 = or(0.2).from(1e-3, 1.0),
        /// Pull of the balancer on which the tool hangs, N. 0 means no balancer.
        lift_n: f64 = or(0.0).from(0.0, 1e5),
        /// Length of the rope between balancer and tool, mm. It has an effect only in the horizontal plane.
        rope_mm: f64 = or(1000.0).from(1.0, 1e5),
        /// Point below the balancer, mm. The default is the point a quarter along the path, the middle of a path of two points.
        balancer_mm: Option<[f64; 2]> = optional("[0, 500]").from(-20_000.0, 20_000.0),
        /// Surface along the path that the hand presses against.
        contact: Option<ContactTable> = optional(""),
    }
}

words! {
    /// Plane of the arm.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Plane {
        /// Horizontal plane. The tool hangs on a rope above the plane.
        Horizontal = "horizontal",
        /// Vertical plane. Gravity acts against y, and the balancer lifts the hand.
        Vertical = "vertical",
    }
}

words! {
    /// Assembly mode of the arm.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
    pub enum Assembly {
        /// Link 1 is on the left of the line from the axis to the hand, so q₁ is larger.
        Left = "left",
        /// Link 1 is on the right of that line.
        Right = "right",
    }
}

keys! {
    /// Scene table `[five_bar.contact]`: the surface, and the hybrid position and force law.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
    pub struct ContactTable {
        /// Force on the surface, N.
        force_n: f64 = needed("5").from(0.0, 1e4),
        /// Stiffness of the surface, N/mm.
        stiffness_n_per_mm: f64 = or(20.0).from(1e-3, 1e6),
        /// Damping of the surface, N·s/m.
        damping_ns_per_m: f64 = or(100.0).from(0.0, 1e6),
        /// Gain of the position error along the surface, 1/s².
        position_per_s2: f64 = or(900.0).from(0.0, 1e6),
        /// Gain of the velocity error, 1/s.
        velocity_per_s: f64 = or(60.0).from(0.0, 1e4),
        /// Gain of the integrated force error, 1/s.
        force_per_s: f64 = or(20.0).from(0.0, 1e4),
        /// Range of the force sensor in both directions, N.
        sensor_n: f64 = or(2.0 * 9.81).from(0.1, 1e5),
    }
}
