//! Writing a drawing that an option of a command names.

use std::io::Write;
use std::path::{Path, PathBuf};

use host_sim::trace::RunFiles;

/// Why a drawing was not written; nothing of it is left.
#[derive(Debug, thiserror::Error)]
#[error("{option} {}: {problem}; give a file in a folder that can be written", file.display())]
pub struct NotDrawn {
    option: &'static str,
    file: PathBuf,
    problem: String,
}

/// Writes a drawing, whole or not at all; `option` is for errors.
///
/// # Errors
/// The file cannot be written.
pub fn write_drawing(option: &'static str, file: &Path, svg: &str) -> Result<(), NotDrawn> {
    let failed = |problem: String| NotDrawn {
        option,
        file: file.to_owned(),
        problem,
    };
    let name = file.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| failed("it is no name of a file".to_owned()))?;
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let put = || -> Result<(), Box<dyn std::error::Error>> {
        let mut files = RunFiles::create(folder.unwrap_or(Path::new(".")))?;
        let mut drawing = files.file(name)?;
        drawing.write_all(svg.as_bytes())?;
        drawing.flush()?;
        files.commit()?;
        Ok(())
    };
    put().map_err(|error| failed(error.to_string()))
}
