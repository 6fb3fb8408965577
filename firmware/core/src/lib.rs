//! The control loop of Cophase, without hardware.
//!
//! `N` crank motors under one platform turn in phase while a program amax(t) says how hard to shake
//! it. Data goes one way, and the modules follow it:
//!
//! ```text
//! program ─► mechanism ─► shaft ──► axes ──► pulse, servo ──► drives
//! amax(t)     ω(amax)       ▲         ▲                          │
//!                       supervisor ◄─ drift ◄─ index pulses ◄────┘
//! ```
//!
//! [`controller`] is one tick of that path, [`signals`] what goes in and out of it, and [`control_loop`] waits
//! for the next. Everything on the
//! way is whole numbers ([`units`]): the same input gives the same bits on a board and on a desk.
//! Floats are in [`settings`] and in the modules' constructors, which check what a user set and turn it
//! into coefficients. Nothing allocates, and the tick path cannot fail.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod axes;
pub mod control_loop;
pub mod controller;
pub mod drift;
pub mod mechanism;
pub mod panel;
pub mod program;
pub mod servo;
pub mod settings;
pub mod signals;
pub mod supervisor;

pub use cophase_motion::{functions, pulse, shaft, units};
