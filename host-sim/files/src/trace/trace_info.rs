//! Format of a written trace, and the command that wrote it.

use serde::Serialize;

use crate::version;

/// Format of a written trace.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TraceInfo {
    /// Control ticks per row of `trace.csv`.
    pub every: u64,
    /// Number of rows in `trace.csv`.
    pub rows: usize,
    /// Start of the window of `steps.vcd`, s since power-up; `None` if there is no such file.
    pub window_from_s: Option<f64>,
    /// End of that window, s since power-up.
    pub window_to_s: Option<f64>,
}

impl TraceInfo {
    /// Returns true if the window of `steps.vcd` lies outside the run.
    pub fn is_empty(&self) -> bool {
        self.window_from_s >= self.window_to_s
    }
}

/// Command that wrote a report.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WrittenBy {
    version: &'static str,
    commit: &'static str,
}

impl WrittenBy {
    /// Returns this process's command.
    pub fn this() -> Self {
        Self {
            version: version::RELEASE,
            commit: version::commit(),
        }
    }
}
