//! Crank-rocker: a four-bar linkage whose crank turns and whose rocker swings.

mod linkage;

pub use linkage::{Linkage, Rocker};
