//! Five-bar arm in a plane: two motors on one axis turn two links, and a parallelogram joins them at the hand.
//!
//! With q₁ and q₂ the angles of the two links from the x axis, and l₁ and l₄ their lengths, the hand is at
//! (l₁ cos q₁ + l₄ cos q₂, l₁ sin q₁ + l₄ sin q₂). The determinant of its Jacobian is −l₁ l₄ sin(q₁ − q₂): the arm is singular where the
//! links lie on one line, at the edge of its reach.

/// Lengths of the two links that reach the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiveBar {
    /// Length of the link at joint 1, m.
    pub l1_m: f64,
    /// Length of the link at joint 2, m.
    pub l4_m: f64,
}

/// Angles of the two joints, rad, each above −π and up to π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints {
    /// Joint 1.
    pub q1_rad: f64,
    /// Joint 2.
    pub q2_rad: f64,
}

/// Why the hand cannot be at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unreachable {
    /// Further from the axis than both links together, m.
    Beyond(f64),
    /// Nearer to the axis than the links differ by, m.
    Within(f64),
    /// The point is the axis and the links are equal: every angle fits.
    OnAxis,
}

/// Part of the links' lengths by which a point at the edge may be off: rounding.
const ROUNDING: f64 = 1e-12;

impl FiveBar {
    /// Place of the hand, m.
    #[must_use]
    pub fn hand_m(&self, joints: Joints) -> [f64; 2] {
        let (sin_1, cos_1) = joints.q1_rad.sin_cos();
        let (sin_2, cos_2) = joints.q2_rad.sin_cos();
        [
            self.l1_m * cos_1 + self.l4_m * cos_2,
            self.l1_m * sin_1 + self.l4_m * sin_2,
        ]
    }

    /// Jacobian of the hand's place by the joints' angles, m a rad: a row for x, and one for y.
    #[must_use]
    pub fn jacobian_m(&self, joints: Joints) -> [[f64; 2]; 2] {
        let (sin_1, cos_1) = joints.q1_rad.sin_cos();
        let (sin_2, cos_2) = joints.q2_rad.sin_cos();
        [
            [-self.l1_m * sin_1, -self.l4_m * sin_2],
            [self.l1_m * cos_1, self.l4_m * cos_2],
        ]
    }

    /// Determinant of the Jacobian, m²: 0 where the arm is singular.
    #[must_use]
    pub fn determinant_m2(&self, joints: Joints) -> f64 {
        let [[a, b], [c, d]] = self.jacobian_m(joints);
        a * d - b * c
    }

    /// Joint angles for a place of the hand: one for each assembly mode, the one with q₁ further from the x axis first. At the edge of the
    /// reach both are the same. The error of the hand's place is below 1e-9 of the links.
    ///
    /// # Errors
    /// The hand cannot be there.
    pub fn joints(&self, x_m: f64, y_m: f64) -> Result<[Joints; 2], Unreachable> {
        let (l1, l4) = (self.l1_m, self.l4_m);
        let reach = x_m.hypot(y_m);
        let most = l1 + l4;
        if reach > most * (1.0 + ROUNDING) {
            return Err(Unreachable::Beyond(reach));
        }
        if reach < (l1 - l4).abs() - most * ROUNDING {
            return Err(Unreachable::Within(reach));
        }
        if reach <= most * ROUNDING {
            return Err(Unreachable::OnAxis);
        }
        let direction = y_m.atan2(x_m);
        let angle = |near: f64, far: f64| {
            let cosine = (near * near + reach * reach - far * far) / (2.0 * near * reach);
            cosine.clamp(-1.0, 1.0).acos()
        };
        let (at_1, at_2) = (angle(l1, l4), angle(l4, l1));
        Ok([1.0, -1.0].map(|side| Joints {
            q1_rad: within_turn(direction + side * at_1),
            q2_rad: within_turn(direction - side * at_2),
        }))
    }
}

/// An angle above −π and up to π.
fn within_turn(angle: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    PI - (PI - angle).rem_euclid(TAU)
}
