//! The methods, one file for each. [`Scheme`](crate::Scheme) prepares them.

pub mod exact;
pub mod explicit_euler;
pub mod implicit_midpoint;
pub mod rk4;
pub mod sdirk4;
pub mod symplectic_euler;
pub mod velocity_verlet;

pub(crate) use exact::Exact;
pub(crate) use explicit_euler::ExplicitEuler;
pub(crate) use implicit_midpoint::ImplicitMidpoint;
pub(crate) use rk4::Rk4;
pub(crate) use sdirk4::Sdirk4;
pub(crate) use symplectic_euler::SymplecticEuler;
pub(crate) use velocity_verlet::VelocityVerlet;
