//! Control loop of Cophase, without hardware.
//!
//! `N` crank motors under one platform turn in phase while a program amax(t) sets how hard the platform is shaken. Data
//! flows one way, and the modules follow it:
//!
//! ```text
//! program ─► mechanism ─► shaft ──► axes ──► pulse, servo ──► drives
//! amax(t)     ω(amax)       ▲         ▲                          │
//!                       supervisor ◄─ monitor ◄ index pulses ◄────┘
//! ```
//!
//! [`controller`] runs one tick of that path, [`signals`] are its input and output, and [`control_loop`] waits for the
//! next tick. All numbers on the path are integers ([`units`]): the same input gives the same bits on a board and on a
//! desk. Floats are only in [`settings`] and in the modules' constructors, which check settings and convert them to
//! coefficients. Nothing allocates, and the tick path cannot fail.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod axes;
pub mod commanded;
pub mod control_loop;
pub mod controller;
pub mod mechanism;
pub mod monitor;
pub mod panel;
pub mod phase_offset;
pub mod problem;
pub mod program;
pub mod servo;
pub mod settings;
pub mod signals;
pub mod supervisor;

pub use cophase_motion::{functions, keys, pulse, shaft, units, words};
