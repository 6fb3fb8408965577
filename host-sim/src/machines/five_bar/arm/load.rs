//! Forces on the hand of the arm, from its suspension and from the surface that it touches.

/// Suspension of the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// No suspension.
    None,
    /// Spring balancer above the hand, in the vertical plane: a constant lift along y, N.
    Balancer(f64),
    /// Rope above the horizontal plane. The rope pulls the hand towards the point below its upper end with F_b sin φ, φ the angle of the
    /// rope from the vertical.
    Rope {
        /// Pull of the balancer along the rope F_b, N.
        lift_n: f64,
        /// Length of the rope, m.
        length_m: f64,
        /// Point below the rope's upper end, m.
        below_m: [f64; 2],
    },
}

impl Load {
    /// Force on the hand in its plane, N.
    pub fn force_n(&self, hand_m: [f64; 2]) -> [f64; 2] {
        match *self {
            Self::None => [0.0; 2],
            Self::Balancer(lift_n) => [0.0, lift_n],
            Self::Rope {
                lift_n,
                length_m,
                below_m,
            } => [0, 1].map(|i| lift_n * (below_m[i] - hand_m[i]) / length_m),
        }
    }

    /// Constant lift along y in the plane of the arm, N.
    pub fn lift_n(&self) -> f64 {
        match *self {
            Self::Balancer(lift_n) => lift_n,
            Self::None | Self::Rope { .. } => 0.0,
        }
    }
}

/// Plane surface: a spring with a damper where the hand is beyond it, and no force elsewhere. It does not pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Unit vector into the surface.
    pub normal: [f64; 2],
    /// Distance of the surface from the axis of the joints along the normal, m.
    pub distance_m: f64,
    /// Stiffness, N/m.
    pub stiffness_n_per_m: f64,
    /// Damping, N s/m.
    pub damping_ns_per_m: f64,
}

impl Surface {
    /// Depth of a point behind the surface, m; negative in front of it.
    pub fn depth_m(&self, hand_m: [f64; 2]) -> f64 {
        self.normal[0] * hand_m[0] + self.normal[1] * hand_m[1] - self.distance_m
    }

    /// Force of the hand on the surface, N, never below 0.
    pub fn pressed_n(&self, hand_m: [f64; 2], hand_mps: [f64; 2]) -> f64 {
        let depth = self.depth_m(hand_m);
        if depth <= 0.0 {
            return 0.0;
        }
        let speed = self.normal[0] * hand_mps[0] + self.normal[1] * hand_mps[1];
        (self.stiffness_n_per_m * depth + self.damping_ns_per_m * speed).max(0.0)
    }

    /// Energy of the spring, J.
    pub fn energy_j(&self, hand_m: [f64; 2]) -> f64 {
        0.5 * self.stiffness_n_per_m * self.depth_m(hand_m).max(0.0).powi(2)
    }
}
