//! Hybrid position and force law of the arm: position along the surface, force across it.
//!
//! Let S = I − n nᵀ, with n the normal of the surface, e the position error of the hand and F the force on the surface:
//!
//! ```text
//! τ = M J⁻¹ (S (a + K_v e′ + K_p e) − J′ q′) + h + g − Jᵀ F_b + Jᵀ n (F_d + K_fi ∫ (F_d − F) dt)
//! ```
//!
//! The law is that of Raibert and Craig (1981), in the source's form. The source's gains are lost; they are parameters here. The law
//! includes the links, the tool and the balancer's lift. It does not include the friction or the side pull of a rope, so both cause
//! errors.
//!
//! The integral stands still in a period in which it would drive the law further into a limit: where the sensor shows one end of its
//! range, or a motor's torque is limited. Otherwise it would wind up there, and the hand would be thrown when the limit ends.

use super::{FiveBarArm, GRAVITY_MPS2, Load, solve, times, transposed_times};

/// Motion that the hand is to make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Position, m.
    pub at_m: [f64; 2],
    /// Velocity, m/s.
    pub velocity_mps: [f64; 2],
    /// Acceleration, m/s².
    pub acceleration_mps2: [f64; 2],
}

/// Force sensor with a converter that spans the full scale in both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceSensor {
    /// Full scale in each direction, N.
    pub full_scale_n: f64,
    /// Bits of the converter, 1 to 31.
    pub bits: u32,
}

impl ForceSensor {
    /// Sensor of the source: 2 kg of weight, and a converter of 12 bits ("12 byte" in the translation).
    pub const SOURCE: Self = Self {
        full_scale_n: 2.0 * GRAVITY_MPS2,
        bits: 12,
    };

    /// One step of the converter, N.
    pub fn step_n(&self) -> f64 {
        2.0 * self.full_scale_n / f64::from(1_u32 << self.bits)
    }

    /// Largest reading, N: a step below the full scale.
    pub fn max_n(&self) -> f64 {
        self.full_scale_n - self.step_n()
    }

    /// Reading for a force, N: rounded to a step, and limited to the full scale.
    pub fn read_n(&self, force_n: f64) -> f64 {
        let step = self.step_n();
        let read = (force_n / step).round() * step;
        read.clamp(-self.full_scale_n, self.max_n())
    }

    /// True if a force is beyond the range, so that the reading says only that.
    pub fn is_saturated(&self, force_n: f64) -> bool {
        (self.read_n(force_n) - force_n).abs() > self.step_n()
    }
}

/// The law, with its integral.
#[derive(Clone, Debug, PartialEq)]
pub struct HybridLaw {
    /// Gain of the position error K_p, 1/s².
    pub position_per_s2: f64,
    /// Gain of the velocity error K_v, 1/s.
    pub velocity_per_s: f64,
    /// Gain of the integrated force error K_fi, 1/s.
    pub force_per_s: f64,
    /// Required force on the surface F_d, N.
    pub required_n: f64,
    /// Torque limit of each motor, N m.
    pub limit_nm: f64,
    /// Sensor of the force.
    pub sensor: ForceSensor,
    /// Integral of the force error, N s.
    pub integral_ns: f64,
}

impl HybridLaw {
    /// Torques for the next period of `period_s`, N m, from the arm's state at its beginning. The force control requires a
    /// surface. Without one the law controls the position in both directions.
    pub fn torque_nm(
        &mut self,
        arm: &FiveBarArm,
        state: &[f64],
        target: &Target,
        period_s: f64,
    ) -> [f64; 2] {
        let (q, v) = ([state[0], state[1]], [state[2], state[3]]);
        let (hand, hand_mps) = (arm.hand_m(q), arm.hand_mps(q, v));
        let jacobian = arm.jacobian_m(q);
        let mut requested = [0, 1].map(|i| {
            target.acceleration_mps2[i]
                + self.velocity_per_s * (target.velocity_mps[i] - hand_mps[i])
                + self.position_per_s2 * (target.at_m[i] - hand[i])
        });
        // The law includes the balancer's lift, but not a rope's side pull.
        let known = match arm.load {
            Load::Balancer(lift_n) => [0.0, lift_n],
            Load::None | Load::Rope { .. } => [0.0; 2],
        };
        let push = known.map(|force| -force);
        let contact = (arm.surface.as_ref()).map(|surface| (surface.normal, arm.contact_n(q, v)));
        if let Some((n, _)) = contact {
            let across = requested[0] * n[0] + requested[1] * n[1];
            for i in 0..2 {
                requested[i] -= across * n[i];
            }
        }
        let centripetal = arm.centripetal_mps2(q, v);
        let angular = solve(jacobian, [0, 1].map(|i| requested[i] - centripetal[i]));
        let inertial = times(arm.inertia_kgm2(q), angular);
        let (centrifugal, gravity) = (arm.centrifugal_nm(q, v), arm.gravity_nm(q));
        let free = [0, 1].map(|i| inertial[i] + centrifugal[i] + gravity[i]);
        let under = |push: [f64; 2]| {
            let pushed = transposed_times(jacobian, push);
            [0, 1].map(|i| free[i] + pushed[i])
        };
        let limited = |torque: [f64; 2]| torque.map(|nm| nm.clamp(-self.limit_nm, self.limit_nm));
        let Some((n, pressed_n)) = contact else {
            return limited(under(push));
        };
        let with_integral = |integral_ns: f64| {
            let force = self.required_n + self.force_per_s * integral_ns;
            under([0, 1].map(|i| push[i] + force * n[i]))
        };
        let step_ns = (self.required_n - self.sensor.read_n(pressed_n)) * period_s;
        let next_ns = self.integral_ns + step_ns;
        let torque = with_integral(next_ns);
        let is_limited = torque != limited(torque) || self.sensor.is_saturated(pressed_n);
        if is_limited && step_ns * next_ns > 0.0 {
            return limited(with_integral(self.integral_ns));
        }
        let torque = limited(torque);
        self.integral_ns = next_ns;
        torque
    }
}
