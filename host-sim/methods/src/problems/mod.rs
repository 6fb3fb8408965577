//! Problems with known solutions, to compare methods.
//!
//! Each file has the equations, their parameters with the source, and the values to compare with. Published values are marked
//! so; values that were computed here are in the tests.
//!
//! | problem | tests |
//! | --- | --- |
//! | [`Oscillator`] | stability, order, energy: the solution is a formula |
//! | [`DenHartog`] | dry friction: stick and slip; each part of the motion is a formula |
//! | [`Pendulum`] | smooth and nonlinear; conservative, or damped and driven |
//! | [`Andrews`] | a closed-loop linkage at speed: seven bodies, six constraints |
//! | [`Hires`] | mildly stiff chemistry |
//! | [`VanDerPol`] | very stiff, with jumps |
//! | [`BouncingBall`] | events at ever shorter intervals |
//! | [`Chain`] | the elastic follower of a cam: a machine of this kind, linear, with a fast mode |
//! | [`Screen`] | a decision: whether a motor of limited power passes a resonance |

pub mod andrews;
pub mod bouncing_ball;
pub mod cam;
pub mod chain;
pub mod den_hartog;
pub mod hires;
pub mod oscillator;
pub mod pendulum;
pub mod screen;
pub mod van_der_pol;

pub use andrews::Andrews;
pub use bouncing_ball::BouncingBall;
pub use cam::{Cam, Law, Motion};
pub use chain::{Chain, Links, Mode, Shaft};
pub use den_hartog::DenHartog;
pub use hires::Hires;
pub use oscillator::Oscillator;
pub use pendulum::Pendulum;
pub use screen::Screen;
pub use van_der_pol::VanDerPol;
