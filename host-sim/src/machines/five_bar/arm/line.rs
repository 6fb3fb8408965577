//! Straight line with parabolic blends: constant acceleration at both ends, constant speed between.

/// A line of the hand in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Start, m.
    pub from_m: [f64; 2],
    /// End, m.
    pub to_m: [f64; 2],
    /// Speed between the blends, m/s.
    pub speed_mps: f64,
    /// Duration of each blend, s.
    pub blend_s: f64,
}

/// A line is too short for its blends: they take at least as long as the line at its speed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a line of {length_m} m at {speed_mps} m/s is too short for blends of {blend_s} s; shorten the blends or lower the speed"
)]
pub struct TooShort {
    /// Length of the line, m.
    pub length_m: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Duration of each blend, s.
    pub blend_s: f64,
}

impl Line {
    /// Line with a given speed between the blends.
    ///
    /// # Errors
    /// The blends do not fit.
    pub fn with_speed(
        from_m: [f64; 2],
        to_m: [f64; 2],
        speed_mps: f64,
        blend_s: f64,
    ) -> Result<Self, TooShort> {
        let line = Self {
            from_m,
            to_m,
            speed_mps,
            blend_s,
        };
        let length_m = line.length_m();
        if blend_s > 0.0 && speed_mps > 0.0 && speed_mps * blend_s <= length_m {
            Ok(line)
        } else {
            Err(TooShort {
                length_m,
                speed_mps,
                blend_s,
            })
        }
    }

    /// Line with a given duration, blends included: its speed is the length over the duration less one blend.
    ///
    /// # Errors
    /// The blends do not fit.
    pub fn with_duration(
        from_m: [f64; 2],
        to_m: [f64; 2],
        duration_s: f64,
        blend_s: f64,
    ) -> Result<Self, TooShort> {
        let length_m = (to_m[0] - from_m[0]).hypot(to_m[1] - from_m[1]);
        Self::with_speed(from_m, to_m, length_m / (duration_s - blend_s), blend_s)
    }

    /// Length, m.
    pub fn length_m(&self) -> f64 {
        (self.to_m[0] - self.from_m[0]).hypot(self.to_m[1] - self.from_m[1])
    }

    /// Duration, s: the length over the speed, and one blend.
    pub fn duration_s(&self) -> f64 {
        self.length_m() / self.speed_mps + self.blend_s
    }

    /// Distance, m, speed, m/s, and acceleration, m/s², along the line at a time. The speed is 0 before the start and after the
    /// end.
    pub fn at(&self, t_s: f64) -> [f64; 3] {
        let (end_s, blend_s) = (self.duration_s(), self.blend_s);
        let acceleration = self.speed_mps / blend_s;
        let t_s = t_s.clamp(0.0, end_s);
        if t_s < blend_s {
            let speed = acceleration * t_s;
            [0.5 * speed * t_s, speed, acceleration]
        } else if t_s <= end_s - blend_s {
            let distance = self.speed_mps * (t_s - 0.5 * blend_s);
            [distance, self.speed_mps, 0.0]
        } else {
            let left_s = end_s - t_s;
            let speed = acceleration * left_s;
            [self.length_m() - 0.5 * speed * left_s, speed, -acceleration]
        }
    }

    /// Unit vector along the line.
    pub fn direction(&self) -> [f64; 2] {
        let length_m = self.length_m();
        [0, 1].map(|i| (self.to_m[i] - self.from_m[i]) / length_m)
    }
}
