//! Controllers and pages for tests of the link.

pub mod controller;
pub mod served;
