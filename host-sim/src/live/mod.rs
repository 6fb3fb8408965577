//! A simulated controller that a host operates over the link, as it operates a board.
//!
//! The control loop and the machine of a scene run in virtual time on a thread of their own, in step with the wall clock. A
//! [`SimulatedDevice`] is the link's view of them: [`cophase_link::server::Hub`] serves it, as the firmware's hub serves a
//! board. The faults and inputs of the scene are played. Its commands are not, because the host gives them.

mod device;
mod paced;
mod wall_clock;

pub use device::SimulatedDevice;
pub use wall_clock::WallClock;
