//! Bounds on a motion.

/// Greatest speed, acceleration and jerk of a shaft: rev/s, rev/s², rev/s³. For a curve, its derivatives per turn of the master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Greatest speed.
    pub speed: f64,
    /// Greatest acceleration.
    pub acceleration: f64,
    /// Greatest jerk.
    pub jerk: f64,
}

impl Bounds {
    /// Bounds of a shaft at rest.
    pub const ZERO: Self = Self {
        speed: 0.0,
        acceleration: 0.0,
        jerk: 0.0,
    };

    /// Returns the greater of each bound.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        Self {
            speed: self.speed.max(other.speed),
            acceleration: self.acceleration.max(other.acceleration),
            jerk: self.jerk.max(other.jerk),
        }
    }
}
