//! Motion of the axes by their followers: where it starts, and its bounds.

use super::{AxisSettings, Settings};
use crate::axes::{Bounds, Cams, Follower, NO_CAMS};

impl Settings {
    /// Commanded phase of an axis of these settings at power-up, turns. The settings must have been checked.
    #[cold]
    pub fn home_turns(&self, axis: &AxisSettings) -> f64 {
        let start: f64 = axis.follower.follower(&self.curves()).start().to_num();
        axis.offset_turns + start
    }

    /// Upper bounds on the speed, the acceleration and the jerk of an axis of these settings: rev/s, rev/s², rev/s³. The settings must have
    /// been checked. The motion of phase offsets is not included.
    #[cold]
    pub fn axis_bounds(&self, axis: &AxisSettings) -> Bounds {
        let curves = self.curves();
        let follower = axis.follower.follower(&curves);
        follower.bounds(&self.master_bounds(), &curves)
    }

    /// Curves of the cam tables of these settings. The settings must have been checked.
    #[cold]
    pub fn curves(&self) -> Cams {
        let mut curves = NO_CAMS;
        self.fill_curves(&mut curves);
        curves
    }

    #[cold]
    pub(crate) fn fill_curves(&self, curves: &mut Cams) {
        for (curve, cam) in curves.iter_mut().zip(&self.cams) {
            curve.fit(&cam.points_turns, cam.net_turns);
        }
    }

    /// Greatest speed, acceleration and jerk of the master, including those of a stop by a fault.
    #[cold]
    pub(crate) fn master_bounds(&self) -> Bounds {
        Bounds {
            speed: self.limits.speed_hz,
            acceleration: self.limits.reachable_stop_acceleration_hz_per_s(),
            jerk: self.limits.stop_jerk_hz_per_s2,
        }
    }
}
