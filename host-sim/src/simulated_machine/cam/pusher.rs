//! Motion of a follower, and of the cam that moves it.

/// Motion of a follower.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pusher {
    /// Position of the pusher, m.
    pub place_m: f64,
    /// Acceleration of the pusher, m/s².
    pub accel_mps2: f64,
}

/// Peak values of a follower.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Largest deviation of the pusher from its law, m.
    pub off_m: f64,
    /// Largest acceleration of the pusher, m/s².
    pub pusher_mps2: f64,
    /// Largest acceleration of the mass next to the cam, m/s²; for a pusher without a cam, that of
    /// its law.
    pub cam_side_mps2: f64,
    /// Largest deviation of the pusher's acceleration from that of its law, m/s².
    pub off_mps2: f64,
}

impl Peaks {
    /// Returns the greater of each pair of values.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            off_m: self.off_m.max(other.off_m),
            pusher_mps2: self.pusher_mps2.max(other.pusher_mps2),
            cam_side_mps2: self.cam_side_mps2.max(other.cam_side_mps2),
            off_mps2: self.off_mps2.max(other.off_mps2),
        }
    }
}

/// Motion of a cam in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Turned {
    /// Turns since power-up, before the tick.
    pub from: f64,
    /// Turns since power-up, after the tick.
    pub to: f64,
    /// Requested speed at the end of the tick, rad/s.
    pub omega_rad_s: f64,
    /// Requested acceleration, rad/s².
    pub acceleration_rad_s2: f64,
}
