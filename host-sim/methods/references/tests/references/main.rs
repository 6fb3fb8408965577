//! Tests of the methods on problems with reference solutions from library solvers.
//!
//!     cargo test -p cophase-references -- --nocapture

mod chain;
mod exponential;
mod order;
mod published;
#[path = "../../../tests/support/mod.rs"]
mod support;
