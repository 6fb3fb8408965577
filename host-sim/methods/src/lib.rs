//! Fixed-step methods: they advance a machine by one step, in lockstep with a control loop.
//!
//! A control loop in virtual time reads the machine in every tick. So the step is that of the loop, and a solver cannot
//! shorten it where the machine is fast. The user only chooses the **method**, and checks that the
//! step is short enough for it.
//!
//! # Choice of a method
//!
//! | the machine | method |
//! | --- | --- |
//! | is linear with a constant matrix | [`Scheme::Exact`]: no stability limit, exact except for the curvature of its input |
//! | its fastest mode turns less than some 1 rad per step | [`Scheme::Rk4`] |
//! | the same, with little damping and forces that depend on positions alone, and must neither gain nor lose energy over hours | [`Scheme::VelocityVerlet`] |
//! | has modes that the step cannot resolve, and they must decay | [`Scheme::Sdirk4`] |
//! | has modes that the step cannot resolve, or forces that depend on speed (an inertia that changes with the angle), and must conserve energy | [`Scheme::ImplicitMidpoint`] |
//!
//! [`Scheme::ExplicitEuler`] and [`Scheme::SymplecticEuler`] are common in controllers and games. They are here for comparison.
//!
//! Call [`Scheme::check_step`] before the first step. For a mode of given frequency and damping, it reports whether the method
//! is unstable. [`Scheme::step_for`] gives the step for a given accuracy: the phase error of RK4 is (hω)⁴/120 per radian.
//!
//! # Use
//!
//! A machine implements [`Equations`]: the number of components, and their rates. More structure (positions and velocities, a
//! Jacobian, a constant matrix) allows more methods. [`Scheme::prepare`] creates a [`Method`] for the machine and the step. After
//! that, a step allocates nothing. It fails only in the ways that [`StepError`] lists, and leaves the state unchanged
//! then.
//!
//! ```
//! use cophase_methods::{Scheme, advance};
//! use cophase_methods::problems::Oscillator;
//!
//! let machine = Oscillator::free(100.0, 0.1);
//! let step_s = 1e-3;
//! Scheme::Rk4.check_step(step_s, machine.omega_rad_s, machine.zeta)?;
//! let mut method = Scheme::Rk4.prepare(&machine, step_s)?;
//! let mut y = [1e-3, 0.0];
//! advance(method.as_mut(), &machine, 0.0, 100, &mut y)?;
//! let exact = machine.exact(0.1, [1e-3, 0.0]);
//! assert!((y[0] - exact[0]).abs() < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Modules
//!
//! - [`equations`]: interface of a machine; [`method`]: interface of a method; [`scheme`]: list of the methods;
//! - [`methods`]: one file for each; [`newton`]: solution of the implicit equations;
//! - [`stability`]: limits of the step, and [`accuracy`]: errors of an oscillation, both measured on the code;
//! - [`friction`]: dry friction, by contacts that stick or slide; [`event`]: steps that end at an event; [`drift`]: conservation of energy;
//! - [`problems`]: machines whose exact solution is known.
//!
//! `docs/methods.md` has the measured figures, and the commands that reproduce them.
#![forbid(unsafe_code)]

pub mod accuracy;
pub mod drift;
pub mod equations;
mod error;
pub mod event;
mod exponential;
mod factors;
mod facts;
pub mod friction;
mod friction_step;
pub mod method;
pub mod methods;
pub mod newton;
pub mod problems;
mod rule;
pub mod scheme;
pub mod stability;

pub use equations::{Differences, Equations, Linear};
pub use error::{NotMeasured, Refused, StepError};
pub use facts::{Facts, Needs};
pub use friction::DryFriction;
pub use method::{Method, advance};
pub use scheme::Scheme;
pub use stability::Unstable;
