//! Crank-rocker: a four-bar linkage whose crank turns and whose rocker swings. A screw on the rocker's axis moves the platform.
//!
//! With the rocker angle ψ and the screw's lead P, x = (P/2π) (ψ₁ − ψ). Here ψ₁ is the rocker angle at the folded dead
//! centre. Crank angle 0 is the dead centre where crank and coupler are stretched out: ψ is smallest there, and the
//! platform farthest. The travel per radian of the rocker, P/2π, replaces the crank radius, so that s = ψ′ and h = ψ″.
//!
//! Forward stroke and return have different durations. So x is not even in α, and |h| is not largest at a dead centre.
//!
//! Not modelled: friction and clearance of the screw and the pins, and the masses of the links.

mod configured;
mod drawing;
mod linkage;

pub use linkage::{Linkage, Rocker};

use super::turn_search::max_over_turn;
use super::{AtAngle, Mechanism, Mount};

/// Largest angle beside the peak at which its sharpness is evaluated, rad. A tick can be this far from the peak.
const BESIDE_RAD: f64 = 0.6;
const BESIDE: u32 = 60;

/// A crank-rocker of known size, with its screw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrankRocker {
    linkage: Linkage,
    unit_m: f64,
    stretched_rad: f64,
    folded_rocker_rad: f64,
    max_s: f64,
    max_h: f64,
    peak_sharpness: f64,
}

impl CrankRocker {
    /// Creates a mechanism from a linkage that is a crank-rocker, and from the travel per radian of the rocker, m.
    #[must_use]
    pub fn new(linkage: Linkage, unit_m: f64) -> Self {
        let [stretched_rad, folded_rad] = linkage.dead_centres_rad();
        let at = |alpha_rad: f64| linkage.at(stretched_rad + alpha_rad);
        let peak = max_over_turn(|alpha| at(alpha).curvature.abs());
        let sharpness = |beside_rad: f64| {
            let there = at(peak.alpha_rad + beside_rad).curvature.abs();
            2.0 * (1.0 - there / peak.value) / (beside_rad * beside_rad)
        };
        let beside = (1..=BESIDE).map(|i| BESIDE_RAD * f64::from(i) / f64::from(BESIDE));
        let sharpest = beside
            .flat_map(|rad| [sharpness(rad), sharpness(-rad)])
            .fold(0.0, f64::max);
        Self {
            linkage,
            unit_m,
            stretched_rad,
            folded_rocker_rad: linkage.at(folded_rad).angle_rad,
            max_s: max_over_turn(|alpha| at(alpha).slope.abs()).value,
            max_h: peak.value,
            // Margin, because the sharpness may be slightly larger between the evaluated angles.
            peak_sharpness: 1.02 * sharpest,
        }
    }

    /// Linkage.
    #[must_use]
    pub fn linkage(&self) -> &Linkage {
        &self.linkage
    }

    /// Distance between the platform's two dead centres, m.
    #[must_use]
    pub fn stroke_m(&self) -> f64 {
        self.x_m(0.0)
    }
}

impl Mechanism for CrankRocker {
    /// Travel per radian of the rocker, m: the screw's lead over 2π.
    fn crank_radius_m(&self) -> f64 {
        self.unit_m
    }

    fn at_each<const N: usize>(&self, alpha_rad: &[f64; N]) -> [AtAngle; N] {
        alpha_rad.map(|alpha_rad| {
            let rocker = self.linkage.at(self.stretched_rad + alpha_rad);
            AtAngle {
                x_m: self.unit_m * (self.folded_rocker_rad - rocker.angle_rad),
                s: rocker.slope,
                h: rocker.curvature,
            }
        })
    }

    fn max_s(&self) -> f64 {
        // The search ends within 1e-13 of the true maximum.
        self.max_s * (1.0 + 1e-12)
    }

    fn max_h(&self) -> f64 {
        self.max_h
    }

    fn peak_sharpness(&self) -> f64 {
        self.peak_sharpness
    }

    fn links(&self) -> &'static str {
        "screws"
    }

    fn draw(&self, mount: &Mount) -> String {
        drawing::under_platform(self, mount)
    }
}
