//! Five-bar arm in a plane: two motors on one axis turn two links, and a parallelogram joins these at the hand.
//!
//! Let q₁ and q₂ be the angles of the two links from the x axis, and l₁ and l₄ their lengths. The hand is at
//! (l₁ cos q₁ + l₄ cos q₂, l₁ sin q₁ + l₄ sin q₂). The determinant of its Jacobian is −l₁ l₄ sin(q₁ − q₂). So the arm is singular where
//! both links lie on one line, at the edge of its reach.

/// Lengths of the two links that lead to the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiveBar {
    /// Length of the link at joint 1, m.
    pub l1_m: f64,
    /// Length of the link at joint 2, m.
    pub l4_m: f64,
}

/// Angles of the two joints, rad, each in (−π, π].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints {
    /// Joint 1.
    pub q1_rad: f64,
    /// Joint 2.
    pub q2_rad: f64,
}

/// Reason why the hand cannot be at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unreachable {
    /// Point at this distance from the axis, m, which exceeds the sum of both links.
    Beyond(f64),
    /// Point at this distance from the axis, m, which is below the difference of both links.
    Within(f64),
    /// Point on the axis, with equal links. Every angle is a solution.
    OnAxis,
}

/// Tolerance for a point at the edge of the reach, relative to the links' lengths. It covers rounding.
const ROUNDING: f64 = 1e-12;

impl FiveBar {
    /// Position of the hand, m.
    #[must_use]
    pub fn hand_m(&self, joints: Joints) -> [f64; 2] {
        let (sin_1, cos_1) = joints.q1_rad.sin_cos();
        let (sin_2, cos_2) = joints.q2_rad.sin_cos();
        [
            self.l1_m * cos_1 + self.l4_m * cos_2,
            self.l1_m * sin_1 + self.l4_m * sin_2,
        ]
    }

    /// Jacobian of the hand's position by the joint angles, m/rad, with one row for x and one for y.
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

    /// Joint angles for a position of the hand, one solution per assembly mode. The first has link 1 on the left of the
    /// line from the axis to the hand. At the edge of the reach both are equal. The error of the hand's position is below
    /// 1e-9 of the links' lengths.
    ///
    /// # Errors
    /// The hand cannot be there.
    pub fn joints(&self, x_m: f64, y_m: f64) -> Result<[Joints; 2], Unreachable> {
        let (l1, l4) = (self.l1_m, self.l4_m);
        let reach = x_m.hypot(y_m);
        let max = l1 + l4;
        if reach > max * (1.0 + ROUNDING) {
            return Err(Unreachable::Beyond(reach));
        }
        if reach < (l1 - l4).abs() - max * ROUNDING {
            return Err(Unreachable::Within(reach));
        }
        if reach <= max * ROUNDING {
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

/// Returns the equivalent angle in (−π, π].
fn within_turn(angle: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    PI - (PI - angle).rem_euclid(TAU)
}
