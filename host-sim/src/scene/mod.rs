//! Scenes: a machine, its limits, its program, and its events, as a TOML file.
//!
//! [`mod@file`] defines the structure of a scene. [`load`] reads a file and reports errors of its form. The folder `setup`
//! converts it into the core's settings and reports errors of its values. Each message names the file, the key, the problem, and the fix.

pub mod entry;
mod error;
pub mod file;
pub mod library;
pub mod load;
pub mod program;
pub mod range;

pub use error::SceneError;
pub use file::Scene;
pub use range::in_range;
