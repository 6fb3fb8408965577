//! Position of the part that the shafts of a machine move.

/// Position and acceleration of the platform.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Height above the crank axis, upwards, m.
    pub z_m: f64,
    /// Acceleration, upwards, m/s².
    pub accel_mps2: f64,
    /// Tilt that lifts the side of axis 0, mrad.
    pub tilt_x_mrad: f64,
    /// Tilt that lifts the side a quarter turn further, mrad.
    pub tilt_y_mrad: f64,
    /// Pitch of a machine that pitches, mrad: it lifts the end in the direction of the shafts' places.
    pub pitch_mrad: f64,
    /// Largest deviation of a crank from the plane of all cranks, degrees of crank angle.
    pub warp_deg: f64,
}
