//! Scenes: a machine, its limits, its program, and its events, as a TOML file.
//!
//! [`mod@file`] defines the structure of a scene. [`load`] reads a file and reports errors of its form. The crate `host-sim`
//! converts it into the core's settings and reports errors of its values. Each message names the file, the key, the problem, and the fix.
#![forbid(unsafe_code)]

pub mod digits;
pub mod entry;
mod error;
pub mod file;
pub mod file_kind;
pub mod input_file;
pub mod keys;
pub mod library;
pub mod load;
pub mod program;
pub mod range;
pub mod units;

pub use error::{SceneError, in_range};
pub use file::Scene;
