//! Equations of motion. They give the response of a machine to forces, where the cranks deviate from their commanded angles.
//!
//! Model levels, each with more freedom than the one before:
//! - [`Rigid`]: all cranks on one shaft, with one angle, and the inertia that the platform has at that angle;
//! - [`Phased`]: one rotor per crank, and a platform that heaves and tilts with them. The rods are rigid, or quasi-static
//!   where they must deform;
//! - [`Elastic`]: as before, with rods as stiff springs and a free platform;
//! - either of the last two on a [`Frame`], which stands on its suspension: the *elastic* model level.
//!
//! Terms: a *rotor* is everything that turns with one crank: motor, coupling, crank. A *corner* is the point where a rod
//! carries the platform. The *plane* is the one closest to the heights of the corners, and the platform lies in it. The
//! distance of a corner from the plane is its *warp*. A *field* is the direction of a motor's stator field as a crank
//! angle: the angle that the motor pulls its rotor to.
//!
//! State vectors contain the positions first, then their speeds, in rad, m, rad/s and m/s, then the servos' integrals, in
//! N·m. Kinematics are those of [`crate::mechanism`], without approximation.
//!
//! No level models forces and motion across the line of travel, or the reaction torque of a motor's housing on its mount.

mod body;
mod corners;
mod driven;
mod elastic;
mod equations;
mod frame;
mod modes;
mod phased;
pub mod plant;
mod rigid;
pub mod step;

pub use body::{Body, Crank, PlaneMotion, RotorParts};
pub use corners::{Corners, FREEDOMS, MAX};
pub use driven::Driven;
pub use elastic::Elastic;
pub use equations::{CloneDynamics, Dynamics};
pub use frame::{Frame, FrameMotion, Layer};
pub use modes::Mode;
pub use phased::Phased;
pub use rigid::Rigid;
pub use step::{Chosen, MAX_STEPS, RESOLUTION, scheme};

#[cfg(test)]
mod tests;
