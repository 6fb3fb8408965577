//! The Cophase control loop in virtual time against simulated machines.
//!
//! The loop itself is [`cophase_core`]'s: the same function that runs on the controller, tick for tick and
//! bit for bit. This crate adds its clock ([`virtual_time`]), its machine ([`machine`], [`sim`]), its task
//! ([`scene`]), and its output ([`trace`], [`report`]). [`design`] and [`mechanism`] are the mathematics of
//! the machines. Charts and campaigns are in `lab/`, the `cophase` command in `command/`.
#![forbid(unsafe_code)]

pub mod axes;
pub mod cam;
pub mod checked;
pub mod compare;
pub mod design;
pub mod digits;
mod drawing;
pub mod drives;
pub mod dynamics;
pub mod faults;
pub mod fidelity;
pub mod file_kind;
pub mod ink;
pub mod input_file;
pub mod live;
pub mod machine;
pub mod mechanism;
pub mod model_level;
pub mod operating_range;
pub mod plant;
pub mod pose;
pub mod record;
pub mod report;
pub mod scene;
pub mod setup;
pub mod sim;
pub mod trace;
pub mod units;
pub mod version;
pub mod virtual_time;
