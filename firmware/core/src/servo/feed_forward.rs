//! Inverse dynamics of the platform, in integer arithmetic.
//!
//! Let s(α) and h(α) be the mechanism's slope and curvature over the crank phase α, per unit crank radius R
//! ([`crate::mechanism`]). A platform of mass m then accelerates with R (h ω² + s α″). From all cranks together it needs
//! the torque m R s (R (h ω² + s α″) ± g). The sign is plus for a platform below the cranks, as in the patent's formula
//! for M, and minus for one above. The feed-forward of an axis is an N-th of that plus the torque for the motor's own
//! rotor, J i α″, where i is the motor's turns per crank turn. Behind the gear a motor gives an i-th of the torque at its crank.
//!
//! The error is below 2e-5 of the greatest torque (tested), from 30-bit factors and the sine's 3e-7.

use core::hash::{Hash, Hasher};

use crate::functions::multiply_q30;
use crate::mechanism::{AnyMechanism, Kinematics, Mechanism};
use crate::problem::{Problem, SettingsError};
use crate::settings::{MachineSettings, Transmission};
use crate::units::{FRACTION_BITS, ONE_TURN, Phase, Torque, Turns};

/// Coefficients of one machine at one tick rate, for one motor of `N`.
#[derive(Clone, Copy, Debug)]
pub struct FeedForward {
    mechanism: AnyMechanism,
    /// Right shift of speeds, so that they fit 30 bits at the limit.
    speed_shift: u32,
    /// Right shift of accelerations, likewise.
    acceleration_shift: u32,
    /// Torque (2⁻¹⁶ N·m) of h ω² at a scaled speed of 1.
    centripetal: i32,
    /// Torque of s α″ at a scaled acceleration of 1.
    tangential: i32,
    /// Torque of gravity at s = 1, with its sign.
    gravity: i32,
    /// Torque of the rotor's own inertia at a scaled acceleration of 1.
    rotor: i32,
}

/// Greatest torque of a setpoint, N·m, which leaves room for the sum of its parts.
const MAX_NM: f64 = 30_000.0;

impl FeedForward {
    /// Coefficients for one of `motors` motors, whose rotor has `rotor_inertia_kgm2`, behind a `gear`. `speed` and `acceleration` are the
    /// greatest of the crank that occur, in turns a tick and a tick².
    ///
    /// # Errors
    /// The torques of the machine do not fit in a setpoint.
    #[cold]
    pub fn new(
        machine: &MachineSettings,
        motors: usize,
        rotor_inertia_kgm2: f64,
        gear: Transmission,
        tick_hz: u32,
        speed: Turns,
        acceleration: Turns,
    ) -> Result<Self, SettingsError> {
        let one_q30 = f64::from(1 << 30);
        let one_turn = ONE_TURN as f64;
        let speed_shift = shift_to_30_bits(speed);
        let acceleration_shift = shift_to_30_bits(acceleration);
        // Speed and acceleration of a scaled value of 2^30, in rad/s and rad/s².
        let hz = f64::from(tick_hz);
        let radians = core::f64::consts::TAU / one_turn;
        let full_speed = one_q30 * f64::from(1_u32 << speed_shift) * radians * hz;
        let full_acceleration =
            one_q30 * f64::from(1_u32 << acceleration_shift) * radians * hz * hz;
        // Shafts without a platform have no load that the controller knows.
        let (radius_m, load_kg, gravity_mps2) = match machine {
            MachineSettings::Shafts(_) => (0.0, 0.0, 0.0),
            MachineSettings::Platform(platform) => (
                platform.crank_radius_m,
                platform.load_kg,
                platform.gravity_mps2 * platform.platform.gravity_sign(),
            ),
        };
        let share_kg = load_kg / motors as f64 / gear.ratio();
        let centripetal = share_kg * radius_m * radius_m * full_speed * full_speed;
        let tangential = share_kg * radius_m * radius_m * full_acceleration;
        let rotor = rotor_inertia_kgm2 * gear.ratio() * full_acceleration;
        let gravity = share_kg * radius_m * gravity_mps2;
        // |h s| stays below 2, |s| below 1.2, over the range of λ.
        if 2.0 * centripetal + 1.5 * tangential + rotor + 1.2 * gravity.abs() > MAX_NM {
            return Err(SettingsError::new(
                "limits.speed_hz",
                Problem::TorqueTooLarge,
            ));
        }
        let fixed = |nm: f64| libm::round(nm * 65_536.0) as i32;
        Ok(Self {
            mechanism: machine.mechanism(tick_hz),
            speed_shift,
            acceleration_shift,
            centripetal: fixed(centripetal),
            tangential: fixed(tangential),
            gravity: fixed(gravity),
            rotor: fixed(rotor),
        })
    }

    /// Hashes the coefficients.
    pub(crate) fn hash_constants(&self, hasher: &mut impl Hasher) {
        let Self {
            mechanism,
            speed_shift,
            acceleration_shift,
            centripetal,
            tangential,
            gravity,
            rotor,
        } = self;
        mechanism.hash_half(false, hasher);
        mechanism.hash_half(true, hasher);
        (speed_shift, acceleration_shift, centripetal).hash(hasher);
        (tangential, gravity, rotor).hash(hasher);
    }

    /// Torque of the motor at a phase of the crank, with the crank's speed (turns a tick) and acceleration (turns a tick²), in its own sense
    /// of rotation.
    pub fn torque(&self, phase: Phase, speed: Turns, acceleration: Turns) -> Torque {
        let angle = (phase.within_turn().to_bits() >> (FRACTION_BITS - 32)) as u32;
        let Kinematics {
            slope: s,
            curvature: h,
        } = self.mechanism.kinematics(angle);
        let speed = (speed.to_bits() >> self.speed_shift) as i32;
        let acceleration = (acceleration.to_bits() >> self.acceleration_shift) as i32;
        let speed_squared = multiply_q30(speed, speed);
        // The sum and each part are below MAX_NM, which is below 2^31.
        let force = multiply_q30(self.centripetal, multiply_q30(h, speed_squared))
            + multiply_q30(self.tangential, multiply_q30(s, acceleration))
            + self.gravity;
        Torque::from_bits(multiply_q30(force, s) + multiply_q30(self.rotor, acceleration))
    }
}

/// Right shift with which a number, and all smaller ones, fit 30 bits.
fn shift_to_30_bits(max: Turns) -> u32 {
    let bits = i64::BITS - max.to_bits().unsigned_abs().leading_zeros();
    bits.saturating_sub(30)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{MechanismSettings, SliderCrankSettings};
    use crate::settings::{Platform, PlatformSettings};

    /// The formulas of this module's documentation in f64, at every degree, several speeds and accelerations.
    #[test]
    fn torque_agrees_with_f64() {
        let tick_hz = 2000_u32;
        let hz = f64::from(tick_hz);
        for (lambda, radius_m, load_kg, top_hz) in [
            (0.1, 0.0046055, 50.0, 100.0),
            (0.3, 0.0779, 10.0, 5.0),
            (0.6, 0.0396, 10.0, 20.0),
        ] {
            for platform in [Platform::Below, Platform::Above] {
                let machine = PlatformSettings {
                    crank_radius_m: radius_m,
                    mechanism: MechanismSettings::SliderCrank(SliderCrankSettings { lambda }),
                    load_kg,
                    platform,
                    gravity_mps2: 9.80665,
                    mount_radius_m: 0.3,
                    allow_commanded_tilt: false,
                };
                let top = Turns::from_num(top_hz / hz);
                let top_acceleration = Turns::from_num(100.0 / hz / hz);
                let forward = FeedForward::new(
                    &MachineSettings::Platform(machine),
                    4,
                    1e-3,
                    Transmission::DIRECT,
                    tick_hz,
                    top,
                    top_acceleration,
                )
                .unwrap();
                let mut worst = (0.0_f64, 0.0_f64);
                for degree in 0..360 {
                    for (speed_hz, acceleration) in
                        [(top_hz, 0.0), (top_hz / 3.0, 100.0), (0.0, -50.0)]
                    {
                        let alpha = f64::from(degree).to_radians();
                        let (sin, cos) = alpha.sin_cos();
                        let root = (1.0 - lambda * lambda * sin * sin).sqrt();
                        let s = sin + lambda * sin * cos / root;
                        let h = cos
                            + lambda * ((2.0 * alpha).cos() + lambda * lambda * sin.powi(4))
                                / root.powi(3);
                        let omega = core::f64::consts::TAU * speed_hz;
                        let angular = core::f64::consts::TAU * acceleration;
                        let g = if platform == Platform::Below {
                            9.80665
                        } else {
                            -9.80665
                        };
                        let expected = load_kg / 4.0
                            * radius_m
                            * s
                            * (radius_m * (h * omega * omega + s * angular) + g)
                            + 1e-3 * angular;
                        let actual: f64 = forward
                            .torque(
                                Phase::from_turns(Turns::from_num(f64::from(degree) / 360.0)),
                                Turns::from_num(speed_hz / hz),
                                Turns::from_num(acceleration / hz / hz),
                            )
                            .to_num();
                        worst = (
                            worst.0.max((actual - expected).abs()),
                            worst.1.max(expected.abs()),
                        );
                    }
                }
                assert!(
                    worst.0 < 2e-5 * worst.1 + 3.0 / 65_536.0,
                    "{worst:?} at λ = {lambda}"
                );
            }
        }
    }
}
