//! Cam laws: displacement of a follower over a rise or a return.
//!
//! A **law** is a displacement s(u) from 0 to 1 as u goes from 0 to 1, at rest at both ends, with its velocity ds/du and
//! acceleration d²s/du². Its **peak coefficient** is the largest acceleration: over a stroke H in a time T it is Ca H/T².
//!
//! | law | Ca | from |
//! | --- | --- | --- |
//! | cycloid | 2π = 6.2832 | a sine of one period as acceleration |
//! | skewed cycloid | 5.8883 | the cycloid sheared, see below |
//! | modified sine | 4π²/(4 + π) = 5.5280 | quarter waves of a sine, steep ones at the ends (Neklutin) |
//! | modified trapezoid | 8π/(2 + π) = 4.8881 | quarter waves of a sine around constant acceleration (Neklutin) |
//!
//! **The skewed cycloid.** The literature names a curve "modified cycloid" whose peak coefficient is 5.8883, and gives no formula.
//! The cycloid is s = (φ − sin φ)/2π over u = φ/2π: a straight line minus a sine that is drawn vertically. With the sine drawn at
//! a slant, u becomes (φ − k sin φ)/2π. Then
//!
//! ```text
//! ds/du = (1 − cos φ) / (1 − k cos φ)
//! d²s/du² = 2π (1 − k) sin φ / (1 − k cos φ)³
//! ```
//!
//! The slant with the smallest peak is k = 1 − √3/2, whose peak is 5.88825. This is the printed number to all its digits.
//! (k = 0.12 and 0.15 give 5.891 and 5.893, which do not round to it.)

use core::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};

/// A cam law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// Cycloid: smooth, the highest peak.
    Cycloid,
    /// Skewed cycloid.
    SkewedCycloid,
    /// Modified sine.
    ModifiedSine,
    /// Modified trapezoid: the lowest peak.
    ModifiedTrapezoid,
}

/// Displacement, velocity and acceleration, in any units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Displacement s.
    pub displacement: f64,
    /// Velocity s′.
    pub velocity: f64,
    /// Acceleration s″.
    pub acceleration: f64,
}

/// Slant of the skewed cycloid, 1 − √3/2: the one with the smallest peak.
const SKEW: f64 = 0.133_974_596_215_561_35;

impl Law {
    /// All four laws, in the order of the source.
    pub const ALL: [Self; 4] = [
        Self::Cycloid,
        Self::SkewedCycloid,
        Self::ModifiedSine,
        Self::ModifiedTrapezoid,
    ];

    /// Returns the largest d²s/du².
    pub fn peak_coefficient(self) -> f64 {
        match self {
            Self::Cycloid => TAU,
            Self::SkewedCycloid => {
                // Where sin φ / (1 − k cos φ)³ is largest: cos φ (1 − k cos φ) = 3k sin² φ.
                let k = SKEW;
                let cos = ((1.0 + 24.0 * k * k).sqrt() - 1.0) / (4.0 * k);
                TAU * (1.0 - k) * (1.0 - cos * cos).sqrt() / (1.0 - k * cos).powi(3)
            }
            Self::ModifiedSine => 4.0 * PI * PI / (4.0 + PI),
            Self::ModifiedTrapezoid => 8.0 * PI / (2.0 + PI),
        }
    }

    /// Returns the law at `u` from 0 to 1, with its derivatives by u.
    pub fn at(self, u: f64) -> Motion {
        match self {
            Self::Cycloid => {
                let (sin, cos) = (TAU * u).sin_cos();
                Motion {
                    displacement: u - sin / TAU,
                    velocity: 1.0 - cos,
                    acceleration: TAU * sin,
                }
            }
            Self::SkewedCycloid => skewed_cycloid(u),
            Self::ModifiedSine => modified_sine(u),
            Self::ModifiedTrapezoid if u <= 0.5 => first_half_of_modified_trapezoid(u),
            Self::ModifiedTrapezoid => {
                let mirrored = first_half_of_modified_trapezoid(1.0 - u);
                Motion {
                    displacement: 1.0 - mirrored.displacement,
                    velocity: mirrored.velocity,
                    acceleration: -mirrored.acceleration,
                }
            }
        }
    }
}

fn skewed_cycloid(u: f64) -> Motion {
    // φ − k sin φ = 2πu is Kepler's equation. The eccentricity is 0.134. Newton's method starts from φ = 2πu + k sin 2πu, which is
    // off by k² at most. It has converged to rounding after three steps: 2e-2, 3e-5, 5e-11, below ε.
    let mut phi = TAU * u + SKEW * (TAU * u).sin();
    for _ in 0..3 {
        let (sin, cos) = phi.sin_cos();
        phi -= (phi - SKEW * sin - TAU * u) / (1.0 - SKEW * cos);
    }
    let (sin, cos) = phi.sin_cos();
    let slope = 1.0 - SKEW * cos;
    Motion {
        displacement: (phi - sin) / TAU,
        velocity: (1.0 - cos) / slope,
        acceleration: TAU * (1.0 - SKEW) * sin / slope.powi(3),
    }
}

fn modified_sine(u: f64) -> Motion {
    let peak = Law::ModifiedSine.peak_coefficient();
    let scale = peak / (4.0 * PI);
    // The fast quarter waves at the ends have period 1/2, the slow half wave between them 3/2. Each is a sine of `angle`
    // with frequency 1/slowness. The constants added to u make the displacement continuous.
    let (angle, slowness, added) = if u < 0.125 {
        (4.0 * PI * u, 1.0, 0.0)
    } else if u <= 0.875 {
        (4.0 * PI * u / 3.0 + FRAC_PI_3, 3.0, 2.0 / PI)
    } else {
        (4.0 * PI * u - TAU, 1.0, 4.0 / PI)
    };
    let (sin, cos) = angle.sin_cos();
    Motion {
        displacement: scale * (added + u - slowness * slowness * sin / (4.0 * PI)),
        velocity: scale * (1.0 - slowness * cos),
        acceleration: peak * sin,
    }
}

fn first_half_of_modified_trapezoid(u: f64) -> Motion {
    const FREQUENCY: f64 = 4.0 * PI;
    let peak = Law::ModifiedTrapezoid.peak_coefficient();
    let (s, v, a) = if u < 0.125 {
        let (sin, cos) = (FREQUENCY * u).sin_cos();
        (
            (u - sin / FREQUENCY) / FREQUENCY,
            (1.0 - cos) / FREQUENCY,
            sin,
        )
    } else if u <= 0.375 {
        let since = u - 0.125;
        (
            (0.125 - 1.0 / FREQUENCY) / FREQUENCY + since / FREQUENCY + 0.5 * since * since,
            1.0 / FREQUENCY + since,
            1.0,
        )
    } else {
        let since = u - 0.375;
        let (sin, cos) = (FREQUENCY * since + FRAC_PI_2).sin_cos();
        (
            (0.125 - 1.0 / FREQUENCY) / FREQUENCY
                + 0.25 / FREQUENCY
                + 0.031_25
                + (1.0 / FREQUENCY + 0.25) * since
                + (1.0 - sin) / (FREQUENCY * FREQUENCY),
            1.0 / FREQUENCY + 0.25 - cos / FREQUENCY,
            sin,
        )
    };
    Motion {
        displacement: peak * s,
        velocity: peak * v,
        acceleration: peak * a,
    }
}

/// A cam that turns at constant speed: it lifts a follower by a law, holds it, lets it return by the same law, and holds it down
/// for the rest of the turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cam {
    /// Law of the rise and the return.
    pub law: Law,
    /// Lift, m.
    pub stroke_m: f64,
    /// Speed of the cam, rad/s.
    pub speed_rad_s: f64,
    /// Angle at time 0, rad; at angle 0 the lift begins.
    pub start_rad: f64,
    /// Angle of the rise, rad.
    pub rise_rad: f64,
    /// Angle of the dwell at the top, rad.
    pub dwell_rad: f64,
    /// Angle of the return, rad.
    pub return_rad: f64,
}

impl Cam {
    /// Returns the cam of the wrapping machine: 84 mm up in 120 deg, a dwell of 135 deg, down in 105 deg, at 450 turns per minute.
    pub fn wrapper(law: Law) -> Self {
        Self {
            law,
            stroke_m: 0.084,
            speed_rad_s: 450.0 * TAU / 60.0,
            start_rad: 0.0,
            rise_rad: 120.0_f64.to_radians(),
            dwell_rad: 135.0_f64.to_radians(),
            return_rad: 105.0_f64.to_radians(),
        }
    }

    /// Returns the time of the rise, s.
    pub fn rise_s(&self) -> f64 {
        self.rise_rad / self.speed_rad_s
    }

    /// Returns the time of the dwell at the top, s.
    pub fn dwell_s(&self) -> f64 {
        self.dwell_rad / self.speed_rad_s
    }

    /// Returns the time of the return, s.
    pub fn return_s(&self) -> f64 {
        self.return_rad / self.speed_rad_s
    }

    /// Returns the time of a turn, s.
    pub fn cycle_s(&self) -> f64 {
        TAU / self.speed_rad_s
    }

    /// Returns the design peak accelerations Ca H/T² of rise and return, m/s².
    pub fn peaks_mps2(&self) -> (f64, f64) {
        let over = |time_s: f64| self.law.peak_coefficient() * self.stroke_m / (time_s * time_s);
        (over(self.rise_s()), over(self.return_s()))
    }

    /// Returns the largest acceleration at a speed of 1 rad/s, m; at ω it is ω² times as large.
    pub fn peak_m(&self) -> f64 {
        let min_rad = self.rise_rad.min(self.return_rad);
        self.law.peak_coefficient() * self.stroke_m / (min_rad * min_rad)
    }

    /// Returns the motion of the follower at `t_s`, in m, m/s, m/s².
    pub fn at(&self, t_s: f64) -> Motion {
        let by_angle = self.at_angle(self.start_rad + self.speed_rad_s * t_s);
        Motion {
            displacement: by_angle.displacement,
            velocity: by_angle.velocity * self.speed_rad_s,
            acceleration: by_angle.acceleration * self.speed_rad_s * self.speed_rad_s,
        }
    }

    /// Returns the motion of the follower at an angle of the cam, in m, m/rad, m/rad², which does not depend on its speed.
    pub fn at_angle(&self, angle_rad: f64) -> Motion {
        let angle_rad = angle_rad.rem_euclid(TAU);
        let down_rad = self.rise_rad + self.dwell_rad;
        if angle_rad < self.rise_rad {
            self.scaled(angle_rad / self.rise_rad, self.rise_rad, self.stroke_m)
        } else if angle_rad < down_rad {
            Motion {
                displacement: self.stroke_m,
                ..Motion::default()
            }
        } else if angle_rad < down_rad + self.return_rad {
            let u = (angle_rad - down_rad) / self.return_rad;
            let mut motion = self.scaled(u, self.return_rad, -self.stroke_m);
            motion.displacement += self.stroke_m;
            motion
        } else {
            Motion::default()
        }
    }

    fn scaled(&self, u: f64, over_rad: f64, stroke_m: f64) -> Motion {
        let by_u = self.law.at(u);
        Motion {
            displacement: stroke_m * by_u.displacement,
            velocity: stroke_m / over_rad * by_u.velocity,
            acceleration: stroke_m / (over_rad * over_rad) * by_u.acceleration,
        }
    }
}
