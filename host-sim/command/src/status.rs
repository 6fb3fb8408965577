//! How a command ends.

use std::io;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Done.
    Done = 0,
    /// The run ended in a fault, no board takes the settings, two runs part, or a claim failed; everything was written.
    Fault = 1,
    /// Bad input; nothing was written.
    BadInput = 2,
}

/// Why a command could not be carried out.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// What was given cannot be worked with.
    #[error("{0}")]
    Input(String),
    /// What came out could not be written.
    #[error("cannot write: {0}")]
    Output(#[from] io::Error),
}
