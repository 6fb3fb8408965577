//! Methods on problems whose answers library solvers know.
//!
//!     cargo test -p cophase-references -- --nocapture

mod chain;
mod order;
mod published;
#[path = "../../../tests/support/mod.rs"]
mod support;
