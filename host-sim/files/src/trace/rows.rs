//! Selection of the control ticks that become rows.

use super::Row;
use super::recorder::RecordError;

/// Most rows that a trace gets unless more are requested.
pub const MAX_ROWS: usize = 20_000;

/// Selection of the ticks that become rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Every {
    /// Every n-th.
    Ticks(u64),
    /// As many ticks as give at most [`MAX_ROWS`] rows.
    Fitting,
}

impl Every {
    /// Returns the smallest number of ticks between rows with which a run of `ticks` has at most [`MAX_ROWS`]. It is for rows
    /// that are written before the end of the run.
    pub const fn for_run(ticks: u64) -> Self {
        let every = ticks.div_ceil(MAX_ROWS as u64);
        Self::Ticks(if every == 0 { 1 } else { every })
    }
}

/// Writer of rows.
pub(super) trait RowWriter {
    /// Writes a row.
    fn write(&mut self, row: &Row) -> Result<(), RecordError>;

    /// Writes the end of the file after the last row.
    fn finish(self: Box<Self>) -> Result<(), RecordError>;
}

/// Rows of a trace, thinned while they are gathered.
pub(super) struct Rows<'a> {
    writers: Vec<Box<dyn RowWriter + 'a>>,
    /// Rows are kept until the end, because the thinning may have to double.
    kept: Option<Vec<(u64, Row)>>,
    every: u64,
    tick: u64,
    written: usize,
}

impl<'a> Rows<'a> {
    pub fn new(writers: Vec<Box<dyn RowWriter + 'a>>, every: Every) -> Self {
        let (every, kept) = match every {
            Every::Ticks(every) => (every.max(1), None),
            Every::Fitting => (1, Some(Vec::new())),
        };
        Self {
            writers,
            kept,
            every,
            tick: 0,
            written: 0,
        }
    }

    pub fn push(&mut self, row: &Row) -> Result<(), RecordError> {
        self.tick += 1;
        if !self.tick.is_multiple_of(self.every) {
            return Ok(());
        }
        let Some(kept) = &mut self.kept else {
            return self.write(row);
        };
        if kept.len() == MAX_ROWS {
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

    pub fn finish(mut self) -> Result<(u64, usize), RecordError> {
        for (_, row) in self.kept.take().unwrap_or_default() {
            self.write(&row)?;
        }
        for writer in self.writers {
            writer.finish()?;
        }
        Ok((self.every, self.written))
    }

    fn write(&mut self, row: &Row) -> Result<(), RecordError> {
        self.written += 1;
        self.writers
            .iter_mut()
            .try_for_each(|writer| writer.write(row))
    }
}
