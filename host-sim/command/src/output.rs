//! Output to a file that an option of a command names. As for all outputs, its folder is created if there is none.

use std::io::Write;
use std::path::{Path, PathBuf};

use cophase_files::trace::RunFiles;

/// Reason why a file was not written. No part of it remains, and no folder that was created for it.
#[derive(Debug, thiserror::Error)]
#[error("{option} {}: {problem}; give a file in a folder that can be written", file.display())]
pub struct NotWritten {
    option: &'static str,
    file: PathBuf,
    problem: String,
}

/// Writes a file, whole or not at all; `option` is for errors.
///
/// # Errors
/// The file cannot be written.
pub fn write_file(option: &'static str, file: &Path, bytes: &[u8]) -> Result<(), NotWritten> {
    let failed = |problem: String| NotWritten {
        option,
        file: file.to_owned(),
        problem,
    };
    let name = file.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| failed("it is no name of a file".to_owned()))?;
    let put = || -> Result<(), Box<dyn std::error::Error>> {
        let mut files = RunFiles::create(file.parent().unwrap_or(Path::new("")))?;
        let mut written = files.file(name)?;
        written.write_all(bytes)?;
        written.flush()?;
        files.commit()?;
        Ok(())
    };
    put().map_err(|error| failed(error.to_string()))
}
