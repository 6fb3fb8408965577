//! Preview of a scene's program: the commands of its controller, computed while the scene is typed.
//!
//! The page of `cophase scope` calls this crate as WebAssembly. It checks the scene's text as `cophase run` does, with the same
//! errors. Then it runs the same control loop with an undisturbed machine, and folds every tick into an
//! [`Envelope`](cophase_files::trace::Envelope).
//!
//! [`compute`] is the whole computation; `exports` is its interface for JavaScript. `host-sim/scope/build` compiles it.

mod answer;
#[cfg(target_arch = "wasm32")]
mod exports;
mod preview;

pub use answer::{Answer, Ended, Limits, Mistake, Scene};
pub use preview::{CHANNELS, Preview, compute};
