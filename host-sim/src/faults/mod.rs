//! What goes wrong on purpose: a layer between the loop and any simulated machine.
//!
//! A scene's `[[fault]]` and `[noise]` act here and nowhere else. Between loop and drives stands [`Disturbance`]: what is wrong with
//! each drive and its crank in one tick, for the machine to play. Between sensors and loop, [`Faults`] changes what lines,
//! encoders and inputs say, and [`Stream`] draws their noise. A machine without either is played as if this were not there.
//!
//! A *fault* here is what is put in; what the controller makes of it is its own affair.

mod disturbance;
mod layer;
mod noise;
mod plan;

pub use disturbance::Disturbance;
pub use layer::Faults;
pub use noise::{Sensor, Stream};
pub use plan::Planned;
