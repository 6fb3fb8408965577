//! Reasons why a question could not be answered.

use std::path::{Path, PathBuf};

/// A question that makes no sense.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "each variant's message says what it means")]
pub enum Error {
    #[error("{}: {error}", path.display())]
    File {
        path: PathBuf,
        error: std::io::Error,
    },
    #[error("{}: {problem}", path.display())]
    Content { path: PathBuf, problem: String },
    #[error("standard output: {0}")]
    Output(#[from] std::io::Error),
    #[error(
        "no function's name matches the root `{0}`; if it was inlined into its caller, name that instead{1}"
    )]
    NoRoot(String, String),
    #[error("no root was given, so that nothing would be checked; give --root NAME")]
    NothingToCheck,
}

impl Error {
    /// Makes the error for a problem inside a file.
    pub fn content(path: &Path, problem: impl ToString) -> Self {
        Self::Content {
            path: path.to_owned(),
            problem: problem.to_string(),
        }
    }
}

/// Reads a file; `-` is the standard input.
///
/// # Errors
/// A file that cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>, Error> {
    use std::io::Read;
    let mut bytes = Vec::new();
    let read = if path == Path::new("-") {
        std::io::stdin().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    read.map_err(|error| Error::File {
        path: path.to_owned(),
        error,
    })
}

/// Reads a file of text.
///
/// # Errors
/// A file that cannot be read, or that is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, Error> {
    String::from_utf8(read(path)?).map_err(|_| Error::content(path, "is not UTF-8 text"))
}
