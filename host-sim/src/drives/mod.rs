//! Motors, drives and sensors of one axis, with the noise of the sensors and the disturbance of a drive.
//!
//! Nothing here knows the machine that the axes move. All that the simulation knows of a drive beside what the core knows of it is its
//! [`DriveModel`] and its [`TorqueLaw`], in a file for each (`docs/recipes/add-a-drive.md`).

mod at_crank;
mod axis;
pub mod coupling;
mod disturbance;
mod drive;
mod flag;
mod index;
mod induction;
mod model;
mod motor;
mod noise;
mod played;
mod pull_out;
mod pulse_counter;
mod servo;
mod stepper;

pub use at_crank::AtCrank;
pub use axis::{SimulatedAxis, Travel};
pub use disturbance::Disturbance;
pub use drive::AxisDrive;
pub use flag::{Extra, Flag};
pub use index::{IndexSensor, Line, Passages, Passed};
pub use induction::Induction;
pub use model::{DriveKey, DriveModel, check_keys, keys_of_torque};
pub use motor::{Field, TorqueLaw};
pub use noise::{Sensor, Stream};
pub use played::Played;
pub use pull_out::PullOut;
pub use servo::Servo;
pub use stepper::Stepper;

model::drives! {
    Stepper => stepper,
    Servo => servo,
    PulseServo => servo,
    Induction => induction,
}

motor::motors! { Stepper, Servo, Induction }
