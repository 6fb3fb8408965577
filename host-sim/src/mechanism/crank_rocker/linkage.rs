//! Geometry of a four-bar linkage with a crank that turns fully and a rocker that swings.
//!
//! Lengths are relative to the rocker's. The crank's pivot is the origin. The rocker's pivot lies on the x axis at the
//! length of the ground. The coupler's end stays above that line. Let φ be the crank angle, ψ the rocker angle and θ the
//! coupler angle, all from the x axis. The loop a e^(iφ) + c e^(iθ) = g + e^(iψ) closes, where a is the crank, c the
//! coupler and g the ground. Its derivatives are:
//!
//! - ψ′ = a sin(φ − θ) / sin(ψ − θ),
//! - θ′ = −a sin(φ − ψ) / (c sin(θ − ψ)).

use core::f64::consts::PI;

/// Lengths of crank, coupler and ground, relative to the rocker's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linkage {
    /// Crank.
    pub crank: f64,
    /// Coupler, which joins crank and rocker.
    pub coupler: f64,
    /// Ground: distance between the two pivots.
    pub ground: f64,
}

/// Motion of the rocker at a crank angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rocker {
    /// Angle ψ from the ground line, rad.
    pub angle_rad: f64,
    /// Derivative ψ′ of the rocker angle by the crank angle.
    pub slope: f64,
    /// Second derivative ψ″ of the rocker angle by the crank angle.
    pub curvature: f64,
}

impl Linkage {
    /// Sum of the two middle links minus the sum of the shortest and the longest one, relative to the rocker. The crank
    /// turns fully if this is above 0 and the crank is the shortest link (Grashof).
    #[must_use]
    pub fn grashof_margin(&self) -> f64 {
        let links = [self.crank, self.coupler, self.ground, 1.0];
        let shortest = links.into_iter().fold(f64::INFINITY, f64::min);
        let longest = links.into_iter().fold(f64::NEG_INFINITY, f64::max);
        links.iter().sum::<f64>() - 2.0 * (shortest + longest)
    }

    /// True if the crank turns fully and the rocker swings.
    #[must_use]
    pub fn is_crank_rocker(&self) -> bool {
        let others = [self.coupler, self.ground, 1.0];
        self.crank > 0.0
            && others.iter().all(|&link| link > self.crank)
            && self.grashof_margin() > 0.0
    }

    /// Distance from the crank's pin to the rocker's pivot.
    fn diagonal(&self, crank_rad: f64) -> f64 {
        let (sin, cos) = crank_rad.sin_cos();
        (self.ground - self.crank * cos).hypot(self.crank * sin)
    }

    /// Motion of the rocker at a crank angle. The linkage must be a crank-rocker ([`Self::is_crank_rocker`]).
    #[must_use]
    pub fn at(&self, crank_rad: f64) -> Rocker {
        let (sin, cos) = crank_rad.sin_cos();
        let diagonal = self.diagonal(crank_rad);
        let below = (self.crank * sin).atan2(self.ground - self.crank * cos);
        let at_pivot = (diagonal * diagonal + 1.0 - self.coupler * self.coupler) / (2.0 * diagonal);
        let angle = PI - below - at_pivot.clamp(-1.0, 1.0).acos();
        // The coupler points from the crank's pin to the rocker's end.
        let coupler =
            (angle.sin() - self.crank * sin).atan2(self.ground + angle.cos() - self.crank * cos);
        let (top, bottom) = (
            self.crank * (crank_rad - coupler).sin(),
            (angle - coupler).sin(),
        );
        let slope = top / bottom;
        let coupler_slope =
            -self.crank * (crank_rad - angle).sin() / (self.coupler * (coupler - angle).sin());
        let top_slope = self.crank * (crank_rad - coupler).cos() * (1.0 - coupler_slope);
        let bottom_slope = (angle - coupler).cos() * (slope - coupler_slope);
        Rocker {
            angle_rad: angle,
            slope,
            curvature: (top_slope - slope * bottom_slope) / bottom,
        }
    }

    /// Pressure angle at the rocker's end, rad: the angle between coupler and rocker, minus a right angle. The coupler's
    /// force acts on the rocker with the cosine of it.
    #[must_use]
    pub fn pressure_rad(&self, crank_rad: f64) -> f64 {
        self.pressure_at(self.diagonal(crank_rad))
    }

    /// Pressure angle, rad, for a distance between the crank's pin and the rocker's pivot. It increases with that distance.
    fn pressure_at(&self, diagonal: f64) -> f64 {
        let sine = (diagonal * diagonal - self.coupler * self.coupler - 1.0) / (2.0 * self.coupler);
        sine.clamp(-1.0, 1.0).asin()
    }

    /// Smallest and largest pressure angle of a turn, rad.
    #[must_use]
    pub fn pressure_range_rad(&self) -> (f64, f64) {
        (
            self.pressure_at(self.ground - self.crank),
            self.pressure_at(self.ground + self.crank),
        )
    }

    /// Crank angles of the dead centres, rad from the ground line. The first has crank and coupler stretched out, the second folded.
    #[must_use]
    pub fn dead_centres_rad(&self) -> [f64; 2] {
        let at_pivot = |reach: f64| {
            let cosine =
                (reach * reach + self.ground * self.ground - 1.0) / (2.0 * self.ground * reach);
            cosine.clamp(-1.0, 1.0).acos()
        };
        [
            at_pivot(self.coupler + self.crank),
            PI + at_pivot(self.coupler - self.crank),
        ]
    }

    /// Swing angle of the rocker, rad.
    #[must_use]
    pub fn swing_rad(&self) -> f64 {
        let [stretched, folded] = self
            .dead_centres_rad()
            .map(|crank| self.at(crank).angle_rad);
        (folded - stretched).abs()
    }

    /// Ratio of the rocker's forward stroke time (crank from stretched out to folded) to its return time.
    #[must_use]
    pub fn time_ratio(&self) -> f64 {
        let [stretched, folded] = self.dead_centres_rad();
        (folded - stretched) / (2.0 * PI - (folded - stretched))
    }
}
