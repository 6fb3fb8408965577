//! How a follower moves, and what moves it.

/// How a follower moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pusher {
    /// Where the pusher is, m.
    pub place_m: f64,
    /// Its acceleration, m/s².
    pub accel_mps2: f64,
}

/// The greatest of what a follower did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// How far the pusher was from its law, m.
    pub off_m: f64,
    /// Acceleration of the pusher, m/s².
    pub pusher_mps2: f64,
    /// Acceleration of the mass next to the cam, m/s²; of a pusher without a cam, that of its law.
    pub cam_side_mps2: f64,
    /// How far the acceleration of the pusher was from that of its law, m/s².
    pub off_mps2: f64,
}

impl Peaks {
    /// The greater of each.
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

/// Where a cam comes from and goes to in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Turned {
    /// Turns since power-up, before the tick.
    pub from: f64,
    /// After it.
    pub to: f64,
    /// Speed at its end, as it was requested, rad/s.
    pub omega_rad_s: f64,
    /// Acceleration, rad/s².
    pub acceleration_rad_s2: f64,
}
