//! Which control ticks become rows of `trace.csv`.

use std::io::Write;

use super::{Row, TraceCsv, TraceError};

/// Most rows that a trace gets unless more are requested.
pub const MOST_ROWS: usize = 20_000;

/// Which ticks become rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Every {
    /// Every n-th.
    Ticks(u64),
    /// As many as give at most [`MOST_ROWS`] rows.
    Fitting,
}

/// Rows of a trace, thinned while they are gathered.
pub(super) struct Rows<C: Write> {
    csv: TraceCsv<C>,
    /// Kept back until the end, as the thinning may have to double.
    kept: Option<Vec<(u64, Row)>>,
    every: u64,
    tick: u64,
    written: usize,
}

impl<C: Write> Rows<C> {
    pub fn new(csv: TraceCsv<C>, every: Every) -> Self {
        let (every, kept) = match every {
            Every::Ticks(every) => (every.max(1), None),
            Every::Fitting => (1, Some(Vec::new())),
        };
        Self {
            csv,
            kept,
            every,
            tick: 0,
            written: 0,
        }
    }

    pub fn push(&mut self, row: &Row) -> Result<(), TraceError> {
        self.tick += 1;
        if !self.tick.is_multiple_of(self.every) {
            return Ok(());
        }
        let Some(kept) = &mut self.kept else {
            self.written += 1;
            return self.csv.write(row);
        };
        if kept.len() == MOST_ROWS {
            // Rows are at multiples of `every`, so every second one is at a multiple of twice that.
            self.every *= 2;
            let every = self.every;
            kept.retain(|(tick, _)| tick.is_multiple_of(every));
            if !self.tick.is_multiple_of(every) {
                return Ok(());
            }
        }
        kept.push((self.tick, row.clone()));
        Ok(())
    }

    pub fn finish(mut self) -> Result<(u64, usize), TraceError> {
        for (_, row) in self.kept.take().unwrap_or_default() {
            self.written += 1;
            self.csv.write(&row)?;
        }
        self.csv.finish()?;
        Ok((self.every, self.written))
    }
}
