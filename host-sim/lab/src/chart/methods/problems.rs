//! Problems for methods: this project's machines over a short manoeuvre, and public problems.
//!
//! Each has a solution with an *uncertainty*: the largest difference between DOP853, a Verner method of order 9, and the solution
//! given here. `host-sim/lab/tests/references.rs` solves all of them again with both.

use cophase_methods::problems::{
    Andrews, Cam, Chain, DenHartog, Hires, Law, Oscillator, Screen, Shaft,
};
use cophase_methods::{Equations, Scheme};
use host_sim::drives::PullOut;
use host_sim::drives::{Field, Motor, Stepper};
use host_sim::dynamics::Chosen;
use host_sim::dynamics::Dynamics;
use host_sim::dynamics::{Body, Driven, Phased, Rigid};
use host_sim::machines::crusher::mains::{OnMains, Shape};
use host_sim::machines::five_bar::arm::{self, FiveBarArm};
use host_sim::mechanism::slider_crank::SliderCrank;
use host_sim::mechanism::{Load, Platform};
use host_sim::simulated_machine::{DriveCommand, Rotors};

use crate::chart::ChartError;

/// Problem with its solution.
pub struct Problem {
    /// Name of the problem.
    pub name: &'static str,
    /// Unit of the compared components.
    pub unit: &'static str,
    /// Machine in each part of the problem. The parts have equal durations, and the time of each begins at 0.
    pub equations: Vec<Box<dyn Equations>>,
    /// State at time 0.
    pub start: Vec<f64>,
    /// End of the problem, s.
    pub end_s: f64,
    /// First components of the state at the end of each part; the others are not compared.
    pub answer: Vec<f64>,
    /// Largest difference between the two references, and between either and the solution.
    pub uncertainty: f64,
    /// Error that is sufficient for the use of the machine.
    pub required_error: f64,
    /// Number of steps of a part: the fewest, and the number of doublings.
    pub steps: (u32, u32),
    /// Default method of a scene with such a machine.
    pub default: Option<Scheme>,
}

/// Returns all problems.
///
/// # Errors
/// The values of a machine are refused.
pub fn all() -> Result<Vec<Problem>, ChartError> {
    Ok(vec![
        rigid()?,
        phased()?,
        chain(),
        screen(),
        arm(),
        crusher(),
        oscillator(),
        stick_slip(),
        andrews(),
        hires(),
    ])
}

/// Torque of each motor, N·m, constant over its whole range, as a corner in it would reduce the order of methods.
const TORQUE_NM: f64 = 6.0;
/// Speed of the fields, rad/s: 10 rev/s.
const SPEED_RAD_S: f64 = 62.8;
/// Duration, s: a little more than a turn.
const TURN_S: f64 = 0.11;
/// Initial phase differences of the cranks of the phased platform, rad.
const APART_RAD: [f64; 4] = [0.0, 0.02, -0.01, 0.015];

/// Returns a platform of 8 kg on four steppers.
///
/// # Errors
/// Never: the numbers are constants.
pub fn body() -> Result<Body, ChartError> {
    Ok(Body {
        mechanism: SliderCrank::new(0.01, 0.04)?.into(),
        load: Load {
            mass_kg: 8.0,
            gravity_mps2: 9.806_65,
            platform: Platform::Above,
        },
        tilt_inertia_kgm2: 0.08,
        rotors_kgm2: vec![5e-4; 4],
        mount_radius_m: 0.2,
        rod_n_per_m: 2e6,
        friction_nm: vec![0.0; 4],
    })
}

/// Returns its motors.
///
/// # Errors
/// Never: the numbers are constants.
pub fn motors() -> Result<Vec<Motor>, ChartError> {
    let pull_out = PullOut::new(&[(0.0, TORQUE_NM), (600.0, TORQUE_NM)])?;
    let motor = Motor::Stepper(Stepper {
        pull_out,
        cycles_per_turn: 50.0,
        damping_nms: 0.02,
    });
    Ok(vec![motor; 4])
}

/// Returns motors that turn the cranks through a turn at constant speed.
fn led(dynamics: Box<dyn Dynamics>) -> Result<Driven, ChartError> {
    let mut driven = Driven::new(dynamics, motors()?);
    driven.energised = true;
    driven.fields.fill(Field {
        alpha_rad: 0.0,
        omega_rad_s: SPEED_RAD_S,
        torque_nm: 0.0,
    });
    Ok(driven)
}

/// Returns the default method of a scene.
///
/// # Errors
/// The machine is refused.
pub fn default_of(driven: &Driven) -> Result<Scheme, ChartError> {
    let commanded = vec![DriveCommand::default(); driven.motors().len()];
    Rotors::new(driven.clone(), commanded, 5e-4, Chosen::default())
        .map(|rotors| rotors.method().0)
        .map_err(ChartError)
}

fn rigid() -> Result<Problem, ChartError> {
    let driven = led(Box::new(Rigid::new(body()?)))?;
    Ok(Problem {
        name: "one shaft, four steppers",
        unit: "rad",
        default: Some(default_of(&driven)?),
        equations: vec![Box::new(driven)],
        start: vec![0.0, SPEED_RAD_S],
        end_s: TURN_S,
        answer: vec![6.906_729_890_485_487],
        uncertainty: 3e-14,
        required_error: 1e-5,
        steps: (16, 10),
    })
}

fn phased() -> Result<Problem, ChartError> {
    let driven = led(Box::new(Phased::new(body()?)))?;
    let mut start = APART_RAD.to_vec();
    start.resize(8, SPEED_RAD_S);
    Ok(Problem {
        name: "platform on four cranks out of phase",
        unit: "rad",
        default: Some(default_of(&driven)?),
        equations: vec![Box::new(driven)],
        start,
        end_s: TURN_S,
        answer: vec![
            6.907_568_375_159_584,
            6.905_438_796_482_792,
            6.906_709_201_862_057,
            6.905_357_171_209_73,
        ],
        uncertainty: 1e-13,
        required_error: 1e-5,
        steps: (32, 10),
    })
}

/// Returns the problem of the chain over nine tenths of the rise, where the cam's law has no corner.
fn chain() -> Problem {
    Problem {
        name: "elastic chain behind a cam, linear",
        unit: "m",
        default: Some(Scheme::Exact),
        equations: vec![Box::new(Chain::wrapper(
            Cam::wrapper(Law::Cycloid),
            Shaft::DampedToCam,
        ))],
        start: vec![0.0; 6],
        end_s: 0.04,
        answer: vec![
            0.083_491_950_303_325_72,
            0.083_515_374_558_918_88,
            0.083_516_938_026_240_33,
        ],
        uncertainty: 1e-14,
        required_error: 1e-6,
        steps: (32, 10),
    }
}

/// Returns the problem of the screen over the first second of its run-up.
fn screen() -> Problem {
    Problem {
        name: "screen on springs, run-up",
        unit: "m and rad",
        default: None,
        equations: vec![Box::new(Screen {
            torque_over_rated: 1.3,
        })],
        start: vec![0.0; Screen::DIMENSION],
        end_s: 1.0,
        answer: vec![
            -0.003_282_937_095_938_599,
            -0.013_841_641_382_867_692,
            12.234_123_265_721_46,
        ],
        uncertainty: 2e-14,
        required_error: 1e-5,
        steps: (32, 10),
    }
}

/// Returns the problem of the arm: a free swing on the balancer.
fn arm() -> Problem {
    let mut arm = FiveBarArm::assumed(arm::GRAVITY_MPS2);
    arm.load = arm::Load::Balancer(9.81);
    Problem {
        name: "five-bar arm on its balancer",
        unit: "rad",
        default: None,
        equations: vec![Box::new(arm)],
        start: vec![2.4, 0.6, 0.0, 0.0],
        end_s: 1.0,
        answer: vec![5.962_243_400_055_548, 7.232_914_116_399_291],
        uncertainty: 5e-14,
        required_error: 1e-5,
        steps: (32, 10),
    }
}

/// Returns the problem of the crusher through the middle of its closing stroke, where the rock's force has no corner.
fn crusher() -> Problem {
    let crusher = OnMains::SOURCE.with_rock(Shape::LinearRise, 1.5e6);
    let [from, _] = crusher.linkage.closing_stroke_rad();
    Problem {
        name: "jaw crusher in its rock",
        unit: "rad",
        default: None,
        equations: vec![Box::new(crusher)],
        start: vec![from + 0.1, 28.0],
        end_s: 0.08,
        answer: vec![8.131_504_111_714_7],
        uncertainty: 2e-14,
        required_error: 1e-5,
        steps: (4, 10),
    }
}

fn oscillator() -> Problem {
    let oscillator = Oscillator {
        omega_rad_s: 100.0,
        zeta: 0.05,
        force: 1.0,
        drive_rad_s: 30.0,
    };
    Problem {
        name: "driven oscillator, linear",
        unit: "m",
        default: None,
        start: vec![1e-3, 0.0],
        answer: oscillator.exact(1.0, [1e-3, 0.0])[..1].to_vec(),
        equations: vec![Box::new(oscillator)],
        end_s: 1.0,
        uncertainty: 2e-15,
        required_error: 1e-7,
        steps: (64, 10),
    }
}

/// Returns the problem of dry friction, over two periods of the force: the mass stops in each half of them.
fn stick_slip() -> Problem {
    let oscillator = DenHartog::STOPPING;
    Problem {
        name: "Den Hartog’s oscillator, stick and slip",
        unit: "m",
        default: None,
        start: vec![0.0; 2],
        answer: oscillator.exact(STICK_SLIP_S, [0.0; 2])[..1].to_vec(),
        equations: vec![Box::new(oscillator)],
        end_s: STICK_SLIP_S,
        uncertainty: 1e-17,
        required_error: 1e-7,
        steps: (64, 10),
    }
}

/// Duration of the problem of dry friction, s.
pub const STICK_SLIP_S: f64 = 0.4;

/// Returns Andrews' problem. Its published angles differ by 1.43e-9 from the result on which two libraries agree.
fn andrews() -> Problem {
    let mut start = Andrews::START.to_vec();
    start.resize(2 * Andrews::START.len(), 0.0);
    Problem {
        name: "Andrews’ squeezing mechanism",
        unit: "rad",
        default: None,
        equations: vec![Box::new(Andrews)],
        start,
        end_s: Andrews::END_S,
        answer: Andrews::PUBLISHED.to_vec(),
        uncertainty: 1.5e-9,
        required_error: 1e-5,
        steps: (256, 9),
    }
}

fn hires() -> Problem {
    Problem {
        name: "HIRES, stiff chemistry",
        unit: "a concentration",
        default: None,
        equations: vec![Box::new(Hires)],
        start: Hires::START.to_vec(),
        end_s: Hires::END,
        answer: Hires::PUBLISHED.to_vec(),
        uncertainty: 1e-14,
        required_error: 1e-6,
        steps: (128, 11),
    }
}
