//! Suspended five-bar arm: two motors on one axis, whose links move a hand in a plane along a path. The source is a paper
//! of 2000 on suspended robots.
//!
//! The equations are those of [`arm`], plus the inertia of each rotor and the friction of
//! each axis. The two axes are the joints: the angle of joint i is 2π times the turns of axis i.
//!
//! The program is a path, and the master's phase is the path's parameter. One turn of the master is the path, there and
//! back. The hand has its specified speed if a turn takes the path's own time. Each joint follows a cam table of
//! [`MAX_CAM_POINTS`](cophase_core::axes::MAX_CAM_POINTS) points, which the inverse kinematics gives. A slower master moves
//! the hand along the same path.
//!
//! A path has no amplitude. The length that the controller gets is R, the radius of a circle as
//! long as the path. So the program's amax is R ω²: the acceleration of a hand that follows this circle in a turn of the
//! master. The largest acceleration of the actual hand is in the blends.
//!
//! If the hand presses against a surface, the hybrid law replaces the position loops of the drives. It controls position
//! along the surface and force across it.
//!
//! Not modelled: elastic links and joints, and a tool that swings on its rope.

pub mod arm;
mod drawing;
mod path;
mod record;
mod table;

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::machines::five_bar::arm::{FiveBarArm, HybridLaw, Target};
use cophase_core::settings::AxisSettings;
use cophase_scene::file::Fidelity;
use nalgebra::{Matrix2, Vector2};

use crate::drives::Field;
use crate::dynamics::plant::{Memory, Plant, Record, Shafts};
use crate::dynamics::{MAX, Mode, PlaneMotion};
use crate::machines::{Machine, Shown};
use crate::mechanism::SquareLaw;
use crate::pose::Pose;

pub use path::{Motion, NoTable, Path};
use record::ArmRecord;

/// Name with its article.
const NAME: &str = "a five-bar arm";

/// Arm with its path.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Equations, without friction and motors.
    pub arm: FiveBarArm,
    /// Law of the drives if the hand presses against a surface, with its integral at 0.
    pub law: Option<HybridLaw>,
    /// Path of the hand.
    pub path: Path,
    /// Angles of the joints a quarter along the path, rad.
    pub quarter_rad: [f64; 2],
    /// Smallest |sin(q₁ − q₂)| on the path.
    pub min_sine: f64,
}

impl Arm {
    /// Component of a vector in the plane along the first line of the path.
    fn along(&self, vector: [f64; 2]) -> f64 {
        let direction = self.path.direction();
        vector[0] * direction[0] + vector[1] * direction[1]
    }

    /// Distance of the hand from the start of the path, along its first line, m.
    fn travelled_m(&self, hand_m: [f64; 2]) -> f64 {
        let start = self.path.start_m();
        self.along([0, 1].map(|i| hand_m[i] - start[i]))
    }

    /// Acceleration of the hand, m/s².
    fn hand_mps2(&self, q: [f64; 2], v: [f64; 2], a: [f64; 2]) -> [f64; 2] {
        let jacobian = self.arm.jacobian_m(q);
        let centripetal = self.arm.centripetal_mps2(q, v);
        [0, 1].map(|i| jacobian[i][0] * a[0] + jacobian[i][1] * a[1] + centripetal[i])
    }

    /// Inertia matrix with the rotors, kg·m².
    fn inertia_kgm2(&self, rotors_kgm2: &[f64], q: [f64; 2]) -> Matrix2<f64> {
        let [[a, b], [c, d]] = self.arm.inertia_kgm2(q);
        let rotors = rotors_kgm2;
        Matrix2::new(a + rotors[0], b, c, d + rotors[1])
    }
}

/// Returns the first two values of a list.
fn both(values: &[f64]) -> [f64; 2] {
    [values[0], values[1]]
}

impl Machine for Arm {
    fn name(&self) -> &'static str {
        NAME
    }

    fn axis_noun(&self) -> &'static str {
        "joint"
    }

    fn law(&self) -> SquareLaw {
        SquareLaw::of_length(self.path.radius_m())
    }

    fn shown(&self) -> Shown {
        Shown::Displacement("hand")
    }

    fn about_amax(&self, _: Option<f64>) -> Option<String> {
        Some(
            "Here amax is that of a hand on a circle as long as the path; in the blends the hand accelerates more."
                .to_owned(),
        )
    }

    fn draw(&self, _: &str, _: &[AxisSettings]) -> String {
        drawing::draw(self)
    }

    fn motion(&self, level: Fidelity) -> &'static str {
        match level {
            Fidelity::Phased => "torque moves the joints of the arm",
            _ => "only a fault moves a joint of the arm off its command",
        }
    }

    fn left_out(&self, level: Fidelity) -> String {
        match level {
            Fidelity::Phased => "elastic links and joints, and a tool that swings on its rope",
            _ => "torque, friction and contact: the joints are where commanded",
        }
        .to_owned()
    }

    fn plant(self: Arc<Self>) -> Option<Arc<dyn Plant>> {
        Some(self)
    }
}

impl Plant for Arm {
    fn pose(&self, turns: &[f64], omega_rad_s: f64, _: f64) -> Pose {
        let hand_m = self.arm.hand_m(both(turns).map(|turns| turns * TAU));
        let faster = omega_rad_s * self.path.duration_s() / TAU;
        let (_, acceleration) = self.path.nearest(hand_m);
        Pose {
            z_m: self.travelled_m(hand_m),
            accel_mps2: self.along(acceleration) * faster * faster,
            ..Pose::default()
        }
    }

    fn positions(&self) -> usize {
        2
    }

    fn rest(&self, _: &mut [f64]) {}

    fn accelerations(&self, shafts: &Shafts<'_>, q: &[f64], v: &[f64], a: &mut [f64]) {
        let (q, v) = (both(q), both(v));
        let jacobian = self.arm.jacobian_m(q);
        let force = self.arm.hand_force_n(q, v);
        let (centrifugal, gravity) = (self.arm.centrifugal_nm(q, v), self.arm.gravity_nm(q));
        let net = [0, 1].map(|i| {
            let outside = jacobian[0][i] * force[0] + jacobian[1][i] * force[1];
            shafts.torques_nm[i] + outside - centrifugal[i] - gravity[i]
        });
        let inertia = self.inertia_kgm2(shafts.rotors_kgm2, q);
        let free = match (shafts.held[0], shafts.held[1]) {
            (false, false) => {
                // The matrix is positive definite, because each rod has a mass.
                let solved = inertia.lu().solve(&Vector2::from(net));
                solved.unwrap_or_else(Vector2::zeros).into()
            }
            (true, false) => [0.0, net[1] / inertia[(1, 1)]],
            (false, true) => [net[0] / inertia[(0, 0)], 0.0],
            (true, true) => [0.0; 2],
        };
        a[..2].copy_from_slice(&free);
    }

    fn drive_law(
        &self,
        fields: &[Field],
        q: &[f64],
        v: &[f64],
        memory: &mut Memory,
        tick_s: f64,
    ) -> Option<[f64; MAX]> {
        let mut law = self.law.clone()?;
        let [integral_ns, before_1, before_2, is_known] = *memory;
        let omega = [fields[0].omega_rad_s, fields[1].omega_rad_s];
        let before = if is_known == 0.0 {
            omega
        } else {
            [before_1, before_2]
        };
        let commanded = [fields[0].alpha_rad, fields[1].alpha_rad];
        let acceleration = [0, 1].map(|i| (omega[i] - before[i]) / tick_s);
        let target = Target {
            at_m: self.arm.hand_m(commanded),
            velocity_mps: self.arm.hand_mps(commanded, omega),
            acceleration_mps2: self.hand_mps2(commanded, omega, acceleration),
        };
        law.integral_ns = integral_ns;
        let [one, two] = law.torque_nm(&self.arm, &[q[0], q[1], v[0], v[1]], &target, tick_s);
        *memory = [law.integral_ns, omega[0], omega[1], 1.0];
        let mut torques = [0.0; MAX];
        torques[..2].copy_from_slice(&[one, two]);
        Some(torques)
    }

    fn moved(&self, q: &[f64], v: &[f64], a: &[f64]) -> PlaneMotion {
        let (q, v, a) = (both(q), both(v), both(a));
        PlaneMotion {
            place: [self.travelled_m(self.arm.hand_m(q)), 0.0, 0.0],
            rate: [self.along(self.arm.hand_mps(q, v)), 0.0, 0.0],
            acceleration: [self.along(self.hand_mps2(q, v, a)), 0.0, 0.0],
        }
    }

    fn energy_j(&self, rotors_kgm2: &[f64], q: &[f64], v: &[f64]) -> f64 {
        let rotors = rotors_kgm2;
        let turning = rotors[0] * v[0] * v[0] + rotors[1] * v[1] * v[1];
        self.arm.energy_j(&[q[0], q[1], v[0], v[1]]) + 0.5 * turning
    }

    fn fastest_mode(&self) -> Mode {
        let Some(surface) = &self.arm.surface else {
            return Mode::default();
        };
        // The smallest effective mass at the hand exceeds the tool's mass plus half of link 4's.
        let mass_kg = self.arm.hand_kg + 0.5 * self.arm.rods[3].mass_kg;
        let omega_rad_s = (surface.stiffness_n_per_m / mass_kg).sqrt();
        Mode {
            omega_rad_s,
            zeta: 0.5 * surface.damping_ns_per_m / (mass_kg * omega_rad_s),
        }
    }

    fn record(&self) -> Box<dyn Record> {
        Box::new(ArmRecord::new(self))
    }
}

#[cfg(test)]
mod tests;
