//! Injected faults: a layer between the loop and any simulated machine.
//!
//! The `[[fault]]` and `[noise]` entries of a scene act here and nowhere else. Between loop and drives, a [disturbance](crate::drives::Disturbance) changes
//! the response of each drive and its crank in one tick, and the machine plays it. Between sensors and loop, [`Faults`] changes the
//! values of lines, encoders and inputs, and a [stream](crate::drives::Stream) draws their noise. A machine without faults and noise is played as if this
//! layer did not exist.
//!
//! A *fault* here is the one that is injected. The controller's diagnosis of it is separate.

mod layer;
mod plan;

pub use layer::Faults;
pub use plan::Planned;
