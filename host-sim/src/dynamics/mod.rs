//! Equations of motion: what forces make of a machine, where the cranks are not simply where commanded
//! to be.
//!
//! Model levels of the ladder, each with more freedom than the one before:
//! - [`Rigid`]: all cranks on one shaft, one angle, with the inertia that the platform has at that angle;
//! - [`Phased`]: every crank a rotor of its own, the platform heaving and tilting as they push it; rods that are
//!   rigid, or settle where they must give;
//! - [`Elastic`]: the same with rods as stiff springs, and the platform free;
//! - either of the last two on a [`Frame`], which stands on its suspension: the *elastic* model level.
//!
//! Words: a *rotor* is all that turns with one crank: motor, coupling, crank. A *corner* is where its rod carries
//! the platform. The *plane* is the one closest to the corners' heights, which the platform lies in; what a corner
//! is away from it is its *warp*. A *field* is where a motor's stator points, in crank angle: where it would like
//! its rotor to be.
//!
//! State vectors have positions first, then their speeds, in rad, m, rad/s and m/s, then what servos have integrated,
//! in N·m. Kinematics are those of [`crate::mechanism`], exact.
//!
//! Left out on all of them: forces and motion across the line of travel, and the torque that a motor's housing hands to
//! what it is bolted to.

mod body;
mod corners;
mod driven;
mod elastic;
mod frame;
mod modes;
mod motor;
mod phased;
mod rigid;

pub use body::{Body, Crank, PlaneMotion, STICTION_RAD_S};
pub use corners::{Corners, FREEDOMS, MOST};
pub use driven::{Driven, Freedom, OnPlant};
pub use elastic::Elastic;
pub use frame::{Frame, FrameMotion, Layer};
pub use modes::Mode;
pub use motor::{Field, Induction, Motor, Servo, Stepper};
pub use phased::Phased;
pub use rigid::Rigid;

#[cfg(test)]
mod tests;
