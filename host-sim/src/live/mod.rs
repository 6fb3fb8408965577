//! A simulated controller that a host operates over the link, as it operates a board.
//!
//! The control loop and the machine of a scene run in virtual time on a thread of their own, in step with the wall clock. A
//! [`SimulatedDevice`] is the link's view of them: [`cophase_link::server::Hub`] serves it, as the firmware's hub serves
//! a board. The commands of the scene are not played, as the host gives them. Its faults and inputs are.

mod device;
mod paced;
mod wall_clock;

pub use device::SimulatedDevice;
pub use wall_clock::WallClock;
