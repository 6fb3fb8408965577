//! How a trace was written.

use serde::Serialize;

/// How a trace was written.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Written {
    /// One row of `trace.csv` every so many control ticks.
    pub every: u64,
    /// Rows in `trace.csv`.
    pub rows: usize,
    /// What `steps.vcd` shows, s since power-up.
    pub window_from_s: f64,
    /// To where.
    pub window_to_s: f64,
}

impl Written {
    /// Whether `steps.vcd` shows nothing: its window lies outside the run.
    pub fn is_empty(&self) -> bool {
        self.window_from_s >= self.window_to_s
    }
}
