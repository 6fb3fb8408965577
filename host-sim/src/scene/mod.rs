//! Scenes: a machine, its limits, its program, and what happens to it, as a TOML file.
//!
//! A scene goes through three hands: [`load`] reads it and says what is wrong with its form, [`mod@file`]
//! is its form, and [`check`] turns it into the core's settings and says what is wrong with its
//! numbers. Whatever is wrong, the message names the file, the key, what is wrong with it, and what
//! would be right.

pub mod check;
mod checked;
pub mod entry;
mod error;
pub mod file;
pub mod library;
pub mod load;
pub(crate) mod range;

pub use check::{in_range, machine, phase_limits, plant};
pub use checked::Checked;
pub use error::SceneError;
pub use file::Scene;
