//! Exit status and errors of a command.

use std::io;

/// Exit status of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Done.
    Done = 0,
    /// The run ended in a fault, no board takes the settings, two runs differ, or a claim failed. Everything was written.
    Fault = 1,
    /// Bad input. Nothing was written.
    BadInput = 2,
    /// Ctrl-C ended the command: 128 + SIGINT, as shells have it.
    Interrupted = 130,
}

/// Reason why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// The input is invalid.
    #[error("{0}")]
    Input(String),
    /// The output could not be written.
    #[error("cannot write: {0}")]
    Output(#[from] io::Error),
}
