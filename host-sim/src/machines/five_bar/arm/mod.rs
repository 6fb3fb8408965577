//! Suspended five-bar arm: two coupled rotors whose hand carries a tool, hangs on a balancer and presses against a surface.
//!
//! From a paper of 2000 on suspended robots (Uddin and others), which is appended to the source of [`Screen`](cophase_methods::problems::Screen). Two motors
//! on one axis turn links 1 and 2. Links 3 and 4 close a parallelogram, so that link 3 stays parallel to link 1, and link 4 to link 2.
//! Let q₁ and q₂ be the angles of links 1 and 2 from the x axis, and b = m₃ l₂ l_c3 + m₄ l₁ l_c4:
//!
//! ```text
//! M(q) q″ + h(q, q′) + g(q) + friction = τ + Jᵀ F
//! M = [A, b cos(q₁ − q₂); b cos(q₁ − q₂), D]
//! A = I₁ + m₁ l_c1² + I₃ + m₃ l_c3² + m₄ l₁²,   D = I₂ + m₂ l_c2² + I₄ + m₄ l_c4² + m₃ l₂²
//! h = b sin(q₁ − q₂) [q₂′², −q₁′²]
//! g = g [(m₁ l_c1 + m₃ l_c3 + m₄ l₁) cos q₁, (m₂ l_c2 + m₃ l₂ + m₄ l_c4) cos q₂]
//! ```
//!
//! A tool of mass m at the hand adds m l₁² to A, m l₄² to D, m l₁ l₄ to b, and its weight. F sums the [`Load`] and the [`Surface`].
//!
//! A to D are printed in the source. Its other equations are lost. They follow from the positions of the four bodies, and a test derives
//! them again from virtual work. The tables are lost, so all lengths, masses, friction and the stiffness of the surface are assumed. Each
//! link is a uniform rod.

mod hybrid;
mod line;
mod load;

use cophase_methods::Equations;

pub use hybrid::{ForceSensor, HybridLaw, Target};
pub use line::{Line, TooShort};
pub use load::{Load, Surface};

/// Acceleration of gravity, m/s².
pub const GRAVITY_MPS2: f64 = 9.81;

/// One link: a uniform rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    /// Length, m.
    pub length_m: f64,
    /// Mass, kg.
    pub mass_kg: f64,
}

impl Rod {
    /// Distance of the centre of mass from the rod's first joint, m.
    pub fn centre_m(&self) -> f64 {
        0.5 * self.length_m
    }

    /// Moment of inertia about the centre of mass, kg m².
    pub fn inertia_kgm2(&self) -> f64 {
        self.mass_kg * self.length_m * self.length_m / 12.0
    }
}

/// The arm, with the torques of its motors held constant; state (q₁, q₂, q₁′, q₂′), rad and rad/s.
#[derive(Clone, Debug, PartialEq)]
pub struct FiveBarArm {
    /// Links 1 to 4. Link 3 is as long as link 1.
    pub rods: [Rod; 4],
    /// Mass at the hand, kg.
    pub hand_kg: f64,
    /// Acceleration of gravity against y, m/s²: 0 for an arm in the horizontal plane.
    pub gravity_mps2: f64,
    /// Coulomb friction of each joint, N m.
    pub friction_nm: [f64; 2],
    /// Speed at which friction has 76 % of its value, rad/s. It rounds the jump at rest, which a fixed step could not resolve.
    pub friction_speed_rad_s: f64,
    /// Forces of the suspension on the hand.
    pub load: Load,
    /// Surface that the hand touches, if any.
    pub surface: Option<Surface>,
    /// Torques of the motors, N m.
    pub torque_nm: [f64; 2],
}

impl FiveBarArm {
    /// Dimension of the state.
    pub const DIMENSION: usize = 4;

    /// Arm with the assumed links, without friction and without any force except gravity.
    pub fn assumed(gravity_mps2: f64) -> Self {
        let rod = |length_m, mass_kg| Rod { length_m, mass_kg };
        Self {
            rods: [
                rod(0.25, 1.2),
                rod(0.1, 0.6),
                rod(0.25, 0.6),
                rod(0.25, 1.0),
            ],
            hand_kg: 0.0,
            gravity_mps2,
            friction_nm: [0.0; 2],
            friction_speed_rad_s: 1e-3,
            load: Load::None,
            surface: None,
            torque_nm: [0.0; 2],
        }
    }

    /// Lengths of the links that reach the hand: 1 and 4, m.
    pub fn reach_m(&self) -> [f64; 2] {
        [self.rods[0].length_m, self.rods[3].length_m]
    }

    /// Position of the hand, m.
    pub fn hand_m(&self, q_rad: [f64; 2]) -> [f64; 2] {
        let [l1, l4] = self.reach_m();
        let ((sin_1, cos_1), (sin_2, cos_2)) = (q_rad[0].sin_cos(), q_rad[1].sin_cos());
        [l1 * cos_1 + l4 * cos_2, l1 * sin_1 + l4 * sin_2]
    }

    /// Jacobian of the hand's position, m: a row for x, and one for y.
    pub fn jacobian_m(&self, q_rad: [f64; 2]) -> [[f64; 2]; 2] {
        let [l1, l4] = self.reach_m();
        let ((sin_1, cos_1), (sin_2, cos_2)) = (q_rad[0].sin_cos(), q_rad[1].sin_cos());
        [[-l1 * sin_1, -l4 * sin_2], [l1 * cos_1, l4 * cos_2]]
    }

    /// Velocity of the hand, m/s.
    pub fn hand_mps(&self, q_rad: [f64; 2], v_rad_s: [f64; 2]) -> [f64; 2] {
        times(self.jacobian_m(q_rad), v_rad_s)
    }

    /// Part of the hand's acceleration that the joints' speeds alone cause, J′ q′, m/s².
    pub fn centripetal_mps2(&self, q_rad: [f64; 2], v_rad_s: [f64; 2]) -> [f64; 2] {
        let [l1, l4] = self.reach_m();
        let (w1, w2) = (v_rad_s[0] * v_rad_s[0], v_rad_s[1] * v_rad_s[1]);
        [
            -l1 * q_rad[0].cos() * w1 - l4 * q_rad[1].cos() * w2,
            -l1 * q_rad[0].sin() * w1 - l4 * q_rad[1].sin() * w2,
        ]
    }

    /// Factor b of the coupling of the joints, kg m².
    fn coupling_kgm2(&self) -> f64 {
        let [one, two, three, four] = self.rods;
        three.mass_kg * two.length_m * three.centre_m()
            + four.mass_kg * one.length_m * four.centre_m()
            + self.hand_kg * one.length_m * four.length_m
    }

    /// Inertia matrix M, kg m².
    pub fn inertia_kgm2(&self, q_rad: [f64; 2]) -> [[f64; 2]; 2] {
        let [one, two, three, four] = self.rods;
        let about = |rod: &Rod| rod.inertia_kgm2() + rod.mass_kg * rod.centre_m().powi(2);
        let a = about(&one) + about(&three) + (four.mass_kg + self.hand_kg) * one.length_m.powi(2);
        let d = about(&two)
            + about(&four)
            + three.mass_kg * two.length_m.powi(2)
            + self.hand_kg * four.length_m.powi(2);
        let b = self.coupling_kgm2() * (q_rad[0] - q_rad[1]).cos();
        [[a, b], [b, d]]
    }

    /// Centrifugal torques h, N m.
    pub fn centrifugal_nm(&self, q_rad: [f64; 2], v_rad_s: [f64; 2]) -> [f64; 2] {
        let factor = self.coupling_kgm2() * (q_rad[0] - q_rad[1]).sin();
        [
            factor * v_rad_s[1] * v_rad_s[1],
            -factor * v_rad_s[0] * v_rad_s[0],
        ]
    }

    /// Torques that hold the weight of the links when they are horizontal, N m.
    fn weight_nm(&self) -> [f64; 2] {
        let [one, two, three, four] = self.rods;
        [
            one.mass_kg * one.centre_m()
                + three.mass_kg * three.centre_m()
                + (four.mass_kg + self.hand_kg) * one.length_m,
            two.mass_kg * two.centre_m()
                + three.mass_kg * two.length_m
                + four.mass_kg * four.centre_m()
                + self.hand_kg * four.length_m,
        ]
        .map(|moment_kg_m| moment_kg_m * self.gravity_mps2)
    }

    /// Torques of gravity g, N m.
    pub fn gravity_nm(&self, q_rad: [f64; 2]) -> [f64; 2] {
        let weight = self.weight_nm();
        [weight[0] * q_rad[0].cos(), weight[1] * q_rad[1].cos()]
    }

    /// Lift at the hand that holds each joint without torque, N: the arm's effective weight by each joint, if the plane is vertical.
    pub fn effective_weight_n(&self) -> [f64; 2] {
        let ([l1, l4], weight) = (self.reach_m(), self.weight_nm());
        [weight[0] / l1, weight[1] / l4]
    }

    /// Torques of friction against the motion, N m.
    fn resisted_nm(&self, v_rad_s: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.friction_nm[i] * (v_rad_s[i] / self.friction_speed_rad_s).tanh())
    }

    /// Force of the hand on the surface along its normal, N; 0 without contact.
    pub fn contact_n(&self, q_rad: [f64; 2], v_rad_s: [f64; 2]) -> f64 {
        self.surface.as_ref().map_or(0.0, |surface| {
            surface.pressed_n(self.hand_m(q_rad), self.hand_mps(q_rad, v_rad_s))
        })
    }

    /// Force on the hand from outside, N: the suspension's and the surface's.
    pub fn hand_force_n(&self, q_rad: [f64; 2], v_rad_s: [f64; 2]) -> [f64; 2] {
        let mut force = self.load.force_n(self.hand_m(q_rad));
        if let Some(surface) = &self.surface {
            let pressed = self.contact_n(q_rad, v_rad_s);
            force[0] -= pressed * surface.normal[0];
            force[1] -= pressed * surface.normal[1];
        }
        force
    }

    /// Kinetic and potential energy without friction and damping, J. A load that pulls sideways has no potential here.
    pub fn energy_j(&self, state: &[f64]) -> f64 {
        let (q, v) = ([state[0], state[1]], [state[2], state[3]]);
        let momentum = times(self.inertia_kgm2(q), v);
        let weight = self.weight_nm();
        let hand = self.hand_m(q);
        let spring = self.surface.as_ref().map_or(0.0, |it| it.energy_j(hand));
        0.5 * (momentum[0] * v[0] + momentum[1] * v[1])
            + weight[0] * q[0].sin()
            + weight[1] * q[1].sin()
            - self.load.lift_n() * hand[1]
            + spring
            - self.torque_nm[0] * q[0]
            - self.torque_nm[1] * q[1]
    }
}

/// Product of a matrix and a vector.
pub(crate) fn times(matrix: [[f64; 2]; 2], vector: [f64; 2]) -> [f64; 2] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1])
}

/// Product of the transposed matrix and a vector.
pub(crate) fn transposed_times(matrix: [[f64; 2]; 2], vector: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| matrix[0][i] * vector[0] + matrix[1][i] * vector[1])
}

/// Vector whose product with the matrix is `vector`; not finite where the matrix is singular.
pub(crate) fn solve(matrix: [[f64; 2]; 2], vector: [f64; 2]) -> [f64; 2] {
    let [[a, b], [c, d]] = matrix;
    let determinant = a * d - b * c;
    [
        (d * vector[0] - b * vector[1]) / determinant,
        (a * vector[1] - c * vector[0]) / determinant,
    ]
}

impl Equations for FiveBarArm {
    fn dimension(&self) -> usize {
        Self::DIMENSION
    }

    fn rates(&self, _: f64, y: &[f64], rates: &mut [f64]) {
        let (q, v) = ([y[0], y[1]], [y[2], y[3]]);
        let centrifugal = self.centrifugal_nm(q, v);
        let gravity = self.gravity_nm(q);
        let friction = self.resisted_nm(v);
        let outside = transposed_times(self.jacobian_m(q), self.hand_force_n(q, v));
        let net = [0, 1]
            .map(|i| self.torque_nm[i] + outside[i] - centrifugal[i] - gravity[i] - friction[i]);
        // M is positive definite: A D > b² for rods of any mass above 0.
        let angular = solve(self.inertia_kgm2(q), net);
        rates.copy_from_slice(&[v[0], v[1], angular[0], angular[1]]);
    }

    fn is_second_order(&self) -> bool {
        true
    }
}
