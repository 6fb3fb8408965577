//! Library solvers as references for the methods of `cophase_methods`, and the measured order of a method.
//!
//! This crate is not a default member of the workspace: the libraries take longer to compile than everything else that the methods'
//! tests need.

pub mod reference;
pub mod slope;
