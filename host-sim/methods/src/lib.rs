//! Fixed-step methods: they advance a machine by one step, in lockstep with a control loop.
//!
//! A control loop in virtual time asks a machine, tick after tick, "and now?". The step is therefore the loop's, not the
//! solver's: it cannot shrink where the machine is fast. What is left to choose is the **method**, and whether the step is
//! short enough for it.
//!
//! # Which one
//!
//! | the machine | take |
//! | --- | --- |
//! | is linear with a constant matrix | [`Scheme::Exact`]: no stability limit, exact but for the curvature of its input |
//! | its fastest mode turns less than some 1 rad a step | [`Scheme::Rk4`] |
//! | the same, undamped or nearly, forces that depend on places alone, and must neither gain nor lose energy over hours | [`Scheme::VelocityVerlet`] |
//! | has modes the step cannot resolve, and they must die away | [`Scheme::Sdirk4`] |
//! | has modes the step cannot resolve, or forces that depend on speed (an inertia that changes with the angle), and energy must be kept | [`Scheme::ImplicitMidpoint`] |
//!
//! [`Scheme::ExplicitEuler`] and [`Scheme::SymplecticEuler`] are what controllers and games are full of, here to be measured
//! against.
//!
//! Ask [`Scheme::check_step`] before the first step. It knows, for a mode of given frequency and damping, where the method
//! blows up. Where it becomes inaccurate [`Scheme::step_for`] knows: RK4 is off by (hω)⁴/120 a radian of phase.
//!
//! # How
//!
//! A machine implements [`Equations`]: how many components, and their rates. What else it can offer (positions and
//! velocities, a Jacobian, a constant matrix) opens more methods to it. [`Scheme::prepare`] makes a [`Method`] for the machine
//! and the step; after that a step allocates nothing and fails only in ways that [`StepError`] lists, leaving the state as
//! it was.
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
//! # Where things are
//!
//! - [`equations`]: what a machine offers; [`method`]: what a method is; [`scheme`]: the list of them;
//! - [`methods`]: one file each; [`newton`]: how the implicit ones solve their equation;
//! - [`stability`]: limits, and [`accuracy`]: errors of an oscillation, both measured on the code; [`event`]: steps that end where something happens; [`drift`]:
//!   whether energy is kept;
//! - [`problems`]: machines whose answers are known.
//!
//! `docs/methods.md` has what was measured, and the commands that show it.
#![forbid(unsafe_code)]

pub mod accuracy;
pub mod drift;
pub mod equations;
mod error;
pub mod event;
mod factors;
mod facts;
pub mod method;
pub mod methods;
pub mod newton;
pub mod problems;
pub mod scheme;
pub mod stability;

pub use equations::{Differences, Equations, Linear};
pub use error::{Refused, StepError};
pub use facts::{Facts, Needs};
pub use method::{Method, advance};
pub use scheme::Scheme;
pub use stability::{NotMeasured, Unstable};
