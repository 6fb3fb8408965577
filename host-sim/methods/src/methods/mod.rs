//! The methods, one file each. [`Scheme`](crate::Scheme) makes them.

pub mod exact;
pub mod explicit_euler;
pub mod implicit_midpoint;
pub mod rk4;
pub mod sdirk4;
pub mod symplectic_euler;
pub mod velocity_verlet;

pub use exact::Exact;
pub use explicit_euler::ExplicitEuler;
pub use implicit_midpoint::ImplicitMidpoint;
pub use rk4::Rk4;
pub use sdirk4::Sdirk4;
pub use symplectic_euler::SymplecticEuler;
pub use velocity_verlet::VelocityVerlet;
