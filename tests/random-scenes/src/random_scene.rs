//! A scene that was drawn: its texts.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A scene that was drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomScene {
    /// TOML text.
    pub text: String,
    /// CSV text of the cam table that the scene names as [`TABLE_FILE`], if it does.
    pub table: Option<String>,
}

/// File of a cam table, beside the scene.
pub const TABLE_FILE: &str = "table.csv";

impl RandomScene {
    /// Writes the scene into a folder, with its table, and returns the scene's path.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<PathBuf> {
        let path = folder.join("scene.toml");
        fs::write(&path, &self.text)?;
        if let Some(table) = &self.table {
            fs::write(folder.join(TABLE_FILE), table)?;
        }
        Ok(path)
    }
}
