//! x
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod functions;
pub mod profile;
pub mod program;
pub mod settings;
pub mod shaft;
pub mod units;
