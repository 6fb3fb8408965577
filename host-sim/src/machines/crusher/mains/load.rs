//! Force of the rock on the jaw over the closing stroke.

use std::f64::consts::TAU;

use super::Linkage;

/// Shape of the force over the closing stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Rises in proportion to the shaft's angle, from 0 to its peak at the end of the stroke.
    LinearRise,
    /// Has its peak over the second half of the stroke: the rock is gripped late.
    SecondHalf,
    /// Has its peak over the whole stroke.
    Constant,
}

impl Shape {
    /// All shapes.
    pub const ALL: [Self; 3] = [Self::LinearRise, Self::SecondHalf, Self::Constant];

    /// Force over its peak, at a part of the stroke from 0 to 1.
    #[must_use]
    pub fn at(self, part: f64) -> f64 {
        match self {
            Self::LinearRise => part,
            Self::SecondHalf if part < 0.5 => 0.0,
            Self::SecondHalf | Self::Constant => 1.0,
        }
    }

    /// Part of the stroke at which the force begins.
    #[must_use]
    pub fn begins_at(self) -> f64 {
        match self {
            Self::SecondHalf => 0.5,
            Self::LinearRise | Self::Constant => 0.0,
        }
    }
}

/// Rock between the jaws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    shape: Shape,
    peak_n: f64,
    /// Angles of the shaft between which the jaw closes, rad.
    stroke_rad: [f64; 2],
}

impl Load {
    /// No rock.
    pub const NONE: Self = Self {
        shape: Shape::Constant,
        peak_n: 0.0,
        stroke_rad: [0.0, 1.0],
    };

    /// Rock that acts across the jaw of a linkage, with a peak force in N.
    #[must_use]
    pub fn new(shape: Shape, peak_n: f64, linkage: &Linkage) -> Self {
        Self {
            shape,
            peak_n,
            stroke_rad: linkage.closing_stroke_rad(),
        }
    }

    /// Peak of the force, N.
    #[must_use]
    pub fn peak_n(&self) -> f64 {
        self.peak_n
    }

    /// Force at an angle of the shaft, N.
    #[must_use]
    pub fn force_n(&self, phi_rad: f64) -> f64 {
        let [from, to] = self.stroke_rad;
        let part = (phi_rad - from).rem_euclid(TAU) / (to - from);
        if part < 1.0 {
            self.peak_n * self.shape.at(part)
        } else {
            0.0
        }
    }

    /// Torque on the shaft of a linkage, N·m; it brakes.
    #[must_use]
    pub fn torque_nm(&self, linkage: &Linkage, phi_rad: f64) -> f64 {
        let force_n = self.force_n(phi_rad);
        if force_n == 0.0 {
            return 0.0;
        }
        force_n * linkage.closing_m(phi_rad).max(0.0)
    }

    /// Angles of the shaft between which the force acts, rad; the first is within the turn.
    #[must_use]
    pub fn acts_rad(&self) -> [f64; 2] {
        let [from, to] = self.stroke_rad;
        let first = from + self.shape.begins_at() * (to - from);
        let second = to + (first.rem_euclid(TAU) - first);
        [first.rem_euclid(TAU), second]
    }
}
