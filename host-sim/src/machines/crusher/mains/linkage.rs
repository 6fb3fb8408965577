//! Four-bar linkage of the crusher: eccentric, jaw and toggle plate.
//!
//! The eccentric's axis is the origin, and the toggle's fixed pivot lies on the x axis at g. Let e, l, r be the lengths of eccentric, jaw
//! and toggle, and φ, θ, ψ their angles. The loop e exp(iφ) + l exp(iθ) = g + r exp(iψ) closes. The derivatives by φ follow from it.

use std::f64::consts::TAU;

/// Lengths, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linkage {
    /// Eccentricity of the shaft.
    pub eccentric_m: f64,
    /// Jaw, from the eccentric to the toggle.
    pub jaw_m: f64,
    /// Toggle plate.
    pub toggle_m: f64,
    /// Distance of the fixed pivots.
    pub ground_m: f64,
    /// Distance of the rock's force from the eccentric, along the jaw.
    pub force_m: f64,
}

/// Angles of the linkage, rad, and their derivatives by the shaft's angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// Jaw, θ.
    pub jaw_rad: f64,
    /// Toggle, ψ.
    pub toggle_rad: f64,
    /// dθ/dφ.
    pub jaw_slope: f64,
    /// d²θ/dφ².
    pub jaw_curvature: f64,
}

impl Linkage {
    /// The assumed mechanism of the source's crusher; [the module](super) lists the calibrated values.
    pub const SOURCE: Self = Self {
        eccentric_m: 0.010,
        jaw_m: 0.800,
        toggle_m: 0.250,
        ground_m: 0.790,
        force_m: 0.650,
    };

    /// Angles at an angle of the shaft. The eccentric must be able to make a full turn.
    #[must_use]
    pub fn at(&self, phi_rad: f64) -> Angles {
        let (e, l, r) = (self.eccentric_m, self.jaw_m, self.toggle_m);
        let (sin, cos) = phi_rad.sin_cos();
        let (x, y) = (e * cos - self.ground_m, e * sin);
        let diagonal = x.hypot(y);
        let at_pivot = (diagonal * diagonal + r * r - l * l) / (2.0 * diagonal * r);
        let toggle_rad = y.atan2(x) - at_pivot.clamp(-1.0, 1.0).acos();
        let jaw_rad = (r * toggle_rad.sin() - y).atan2(r * toggle_rad.cos() - x);
        let toggle_slope = e * (phi_rad - jaw_rad).sin() / (r * (toggle_rad - jaw_rad).sin());
        let (top, bottom) = (
            -e * (phi_rad - toggle_rad).sin(),
            l * (jaw_rad - toggle_rad).sin(),
        );
        let jaw_slope = top / bottom;
        let top_slope = -e * (phi_rad - toggle_rad).cos() * (1.0 - toggle_slope);
        let bottom_slope = l * (jaw_rad - toggle_rad).cos() * (jaw_slope - toggle_slope);
        Angles {
            jaw_rad,
            toggle_rad,
            jaw_slope,
            jaw_curvature: (top_slope - jaw_slope * bottom_slope) / bottom,
        }
    }

    /// Speed of the jaw towards the rock, over the speed of the shaft: across the jaw at the point of the force, m.
    #[must_use]
    pub fn closing_m(&self, phi_rad: f64) -> f64 {
        let angles = self.at(phi_rad);
        self.eccentric_m * (phi_rad - angles.jaw_rad).cos() + self.force_m * angles.jaw_slope
    }

    /// Angles of the shaft between which the jaw closes, rad: the first within the turn, the second above it.
    #[must_use]
    pub fn closing_stroke_rad(&self) -> [f64; 2] {
        const SAMPLES: u32 = 360;
        let mut ends = [0.0; 2];
        for i in 0..SAMPLES {
            let mut low = TAU * f64::from(i) / f64::from(SAMPLES);
            let mut high = TAU * f64::from(i + 1) / f64::from(SAMPLES);
            let opens = |phi: f64| self.closing_m(phi) <= 0.0;
            let before = opens(low);
            if before == opens(high) {
                continue;
            }
            // Halvings down to the resolution of f64.
            for _ in 0..52 {
                let middle = 0.5 * (low + high);
                if opens(middle) == before {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            ends[usize::from(!before)] = high;
        }
        [ends[0], ends[0] + (ends[1] - ends[0]).rem_euclid(TAU)]
    }
}

/// Jaw as a rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jaw {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Distance of its centre of mass from the eccentric, m.
    pub centre_m: f64,
    /// Inertia about the centre of mass, kg m².
    pub inertia_kgm2: f64,
}

impl Jaw {
    /// No jaw: the equivalent inertia is that of the flywheel.
    pub const NONE: Self = Self {
        mass_kg: 0.0,
        centre_m: 0.0,
        inertia_kgm2: 0.0,
    };

    /// Jaw that gives the source's range of the equivalent inertia with the assumed linkage. It is heavier than a real one, because the
    /// assumed eccentric is smaller. Only mass times eccentricity squared matters: 600 kg at 15.7 mm are equivalent.
    pub const SOURCE: Self = Self {
        mass_kg: SOURCE_MASS_KG,
        centre_m: SOURCE_CENTRE_M,
        inertia_kgm2: SOURCE_MASS_KG * 0.8 * 0.8 / 12.0,
    };

    /// Its part of the equivalent inertia, kg m², and the derivative of that by the shaft's angle.
    #[must_use]
    pub fn inertia_kgm2(&self, linkage: &Linkage, phi_rad: f64) -> (f64, f64) {
        let Angles {
            jaw_rad,
            jaw_slope: slope,
            jaw_curvature: curvature,
            ..
        } = linkage.at(phi_rad);
        let (e, s) = (linkage.eccentric_m, self.centre_m);
        let (sin, cos) = (phi_rad - jaw_rad).sin_cos();
        let speed_squared = e * e + s * s * slope * slope + 2.0 * e * s * slope * cos;
        let speed_slope = 2.0 * s * s * slope * curvature
            + 2.0 * e * s * (curvature * cos - slope * sin * (1.0 - slope));
        (
            self.mass_kg * speed_squared + self.inertia_kgm2 * slope * slope,
            self.mass_kg * speed_slope + 2.0 * self.inertia_kgm2 * slope * curvature,
        )
    }
}

const SOURCE_MASS_KG: f64 = 1470.2;
const SOURCE_CENTRE_M: f64 = 0.4634;
