//! Warnings for buyers of motors: errors of the patent's formula and of its print, and values that no stepper reaches.

use core::fmt;

use cophase_scene::digits::{degrees, four, percent};
use cophase_scene::units::STANDARD_GRAVITY_MPS2;

use super::motor::MotorChoice;
use super::steps::Design;
use host_sim::mechanism::slider_crank::{Extremum, SliderCrank};

/// Smallest relative error of two-term values that is reported. Motors come in coarser steps.
const NOTICEABLE: f64 = 0.005;

/// Speed above which a stepper has almost no torque, turns a minute. Its drive has to reverse the winding current at 50 times the
/// speed. At 3000 rpm that is 2.5 kHz, far beyond the corner frequency of any winding large enough to drive a crank.
const STEPPER_RPM: f64 = 3000.0;

/// Peak shaft power that no stepper delivers, W. The largest frames (NEMA 42) end at some hundreds of watts.
const STEPPER_W: f64 = 1000.0;

/// Ratio of the rod's force across the line of travel to that along it, from which rods count as short: half. The ratio is
/// tan β = λ / √(1 − λ²) where the rod leans most. So λ from 0.447 on is short, up to the 0.6 that the method allows.
const SIDEWAYS: f64 = 0.5;

/// Warning for readers of a [`Design`]. Prints as one or two full sentences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// λ is so large that the acceleration has a third turning point, which the source prints with the
    /// wrong sign.
    ThirdBranch {
        /// Crank/rod ratio.
        lambda: f64,
        /// The turning point by the two-term formula.
        two_term: Extremum,
        /// The exact turning point. `None` for λ from 1/4 to 0.2638, where only the approximation has it.
        exact: Option<Extremum>,
    },
    /// Rods are so short that they push the platform sideways with a large part of their force.
    ShortRods {
        /// Crank/rod ratio.
        lambda: f64,
    },
    /// The source's gravity sign is that of a platform below its cranks.
    GravitySense {
        /// Exact torque maximum with the platform below, N·m.
        below_nm: f64,
        /// Exact torque maximum with the platform above, N·m.
        above_nm: f64,
    },
    /// The two-term formula has a noticeable error.
    TwoTermError {
        /// Worst error of the acceleration, as a fraction of amax.
        acceleration: f64,
        /// Error of the torque maximum relative to the exact one: positive if the formula gives too much.
        torque: f64,
    },
    /// The cranks turn faster than steppers with useful torque.
    StepperSpeed {
        /// Crank speed, turns a minute.
        rpm: f64,
    },
    /// The cranks need more power than steppers deliver.
    StepperPower {
        /// Peak power of one motor, W, without safety factor.
        motor_w: f64,
    },
    /// Gravity is the rounded value behind the patent's printed figures.
    RoundedGravity {
        /// Relative reduction of torques with standard gravity.
        torque_drop: f64,
    },
}

impl Design {
    /// Returns the warnings about the method and its printed form for this design.
    pub fn warnings(&self, motor: &MotorChoice) -> Vec<Warning> {
        applicable(self, motor)
    }
}

/// The warnings that apply to a design, in the order of its steps.
fn applicable(design: &Design, motor: &MotorChoice) -> Vec<Warning> {
    let omega = design.speed_rad_s();
    let gravity = design.requirement.gravity_mps2;
    let mut all = Vec::new();
    if gravity == 10.0 {
        // Radius and force are both proportional to gravity, because amax is given in it.
        let torque_drop = 1.0 - (STANDARD_GRAVITY_MPS2 / gravity).powi(2);
        all.push(Warning::RoundedGravity { torque_drop });
    }
    if let Some(two_term) = design.mechanism.extrema_two_term(omega).between {
        all.push(Warning::ThirdBranch {
            lambda: design.requirement.lambda,
            two_term,
            exact: design.mechanism.extrema_exact(omega).between,
        });
    }
    let lambda = design.requirement.lambda;
    if sideways(lambda) >= SIDEWAYS {
        all.push(Warning::ShortRods { lambda });
    }
    let exact_nm = design.torque_exact_below.value;
    let acceleration = design.mechanism.two_term_error().value;
    let torque = design.torque_two_term.value / exact_nm - 1.0;
    if acceleration >= NOTICEABLE || torque.abs() >= NOTICEABLE {
        all.push(Warning::TwoTermError {
            acceleration,
            torque,
        });
    }
    all.push(Warning::GravitySense {
        below_nm: exact_nm,
        above_nm: design.torque_exact_above.value,
    });
    let rpm = design.speed_rpm() * motor.gear.ratio();
    if rpm > STEPPER_RPM {
        all.push(Warning::StepperSpeed { rpm });
    }
    let motor_w = design.per_motor(design.peak_power_w());
    if motor_w > STEPPER_W {
        all.push(Warning::StepperPower { motor_w });
    }
    all
}

/// Greatest ratio of a rod's force across the line of travel to that along it.
fn sideways(lambda: f64) -> f64 {
    lambda.asin().tan()
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ThirdBranch {
                lambda,
                two_term,
                exact,
            } => {
                write!(
                    f,
                    "λ = {lambda} is above {}: by the two-term formula the lowest acceleration is no \
                     longer at 180 deg but -R ω² (λ + 1/(8λ)) = {} m/s² at {} deg and its mirror \
                     image; the source prints that value with a plus sign. ",
                    SliderCrank::LAMBDA_SPLIT_TWO_TERM,
                    four(two_term.a_mps2),
                    degrees(two_term.alpha_rad),
                )?;
                match exact {
                    Some(exact) => write!(
                        f,
                        "Exactly it is {} m/s² at {} deg.",
                        four(exact.a_mps2),
                        degrees(exact.alpha_rad)
                    ),
                    None => write!(
                        f,
                        "Exactly it stays at 180 deg: the true motion has no third turning point \
                         up to λ = {:.4}.",
                        SliderCrank::LAMBDA_SPLIT_EXACT
                    ),
                }
            }
            Self::ShortRods { lambda } => write!(
                f,
                "The rods are short, {} crank radii: they lean up to {} deg, and push the platform sideways with up \
                 to {} of the force that moves it. The formulas leave out friction in its guides. Choose longer rods, \
                 a smaller λ, unless the guides take that.",
                four(1.0 / lambda),
                degrees(lambda.asin()),
                percent(sideways(lambda))
            ),
            Self::GravitySense { below_nm, above_nm } => write!(
                f,
                "The patent's F = m (g + a) holds for a platform hanging below its cranks; for one \
                 standing above them it is F = m (a - g), and the exact torque maximum is {} N·m \
                 instead of {} N·m, {} less.",
                four(above_nm),
                four(below_nm),
                percent(1.0 - above_nm / below_nm)
            ),
            Self::TwoTermError {
                acceleration,
                torque,
            } => write!(
                f,
                "The two-term formula misses the true acceleration by up to {} of amax, and its \
                 torque maximum is {} too {}.",
                percent(acceleration),
                percent(torque.abs()),
                if torque < 0.0 { "low" } else { "high" }
            ),
            Self::StepperSpeed { rpm } => write!(
                f,
                "The motors turn at {} rpm; above {STEPPER_RPM} rpm no stepper has torque left, so \
                 choose servo motors or a lower frequency.",
                four(rpm)
            ),
            Self::StepperPower { motor_w } => write!(
                f,
                "Each motor must give {} kW at its peak, before any safety factor; steppers end \
                 below {} kW, so choose servo motors, more of them, a smaller load or, as power falls with it, a \
                 higher frequency.",
                four(motor_w / 1000.0),
                STEPPER_W / 1000.0
            ),
            Self::RoundedGravity { torque_drop } => write!(
                f,
                "Gravity is 10 m/s², as in the patent's printed figures; with \
                 {STANDARD_GRAVITY_MPS2} m/s² all torques are {} lower.",
                percent(torque_drop)
            ),
        }
    }
}
