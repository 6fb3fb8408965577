//! Motors, drives and sensors of one axis, with the noise of the sensors and the disturbance of a drive.
//!
//! Nothing here knows the machine that the axes move.

mod at_crank;
mod axis;
pub mod coupling;
mod disturbance;
mod drive;
mod flag;
mod index;
mod noise;
mod played;
mod pull_out;
mod pulse_counter;

pub use at_crank::AtCrank;
pub use axis::{SimulatedAxis, Travel};
pub use disturbance::Disturbance;
pub use drive::{AxisDrive, FollowingError};
pub use flag::{Extra, Flag};
pub use index::{IndexSensor, Line, Passages, Passed};
pub use noise::{Sensor, Stream};
pub use played::Played;
pub use pull_out::PullOut;
