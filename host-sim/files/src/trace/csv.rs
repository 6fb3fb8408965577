//! `trace.csv`: one line per row, every [`Column`] with its unit in its name.
//!
//! A number is written in the shortest form that reads back as the column's rounded value: tick 1 of a 2 kHz loop is
//! `0.0005`, not `0.000500000`. It always has a decimal point, so that a reader that infers the type of a column from its first rows does not
//! find whole numbers. A value that is not finite is written `NaN`, `inf` or `-inf`, which Rust, pandas and numpy read back.

use std::io::{self, Write};

use thiserror::Error;

use super::column::{Column, Value};
use super::{Row, RowShape};
use crate::version;

/// Columns after those of the rows: the command that wrote the file. They are the same in every row, so that rows of several files can be
/// put together.
pub const WRITTEN_BY: [&str; 2] = ["version", "commit"];

/// Reason why a trace could not be written.
#[derive(Debug, Error)]
pub enum TraceError {
    /// A row has a different number of axes from the header.
    #[error("a row has {actual} axes where the header names {expected}")]
    Axes {
        /// Axes in the header.
        expected: usize,
        /// Axes in the row.
        actual: usize,
    },
    /// The `csv` crate or the file under it refused.
    #[error("trace not written: {0}")]
    Csv(#[from] ::csv::Error),
    /// The last bytes could not be flushed.
    #[error("trace not flushed: {0}")]
    Flush(#[from] io::Error),
}

/// Writes rows as comma-separated values.
///
/// ```
/// use cophase_files::trace::{Row, TraceCsv};
///
/// let mut trace = TraceCsv::new(Vec::new(), 0)?;
/// trace.write(&Row { t_s: 0.0005, state: "idle", ..Row::default() })?;
/// let text = String::from_utf8(trace.finish()?).unwrap();
/// assert!(text.contains("\n0.0005,idle,0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,"));
/// # Ok::<(), cophase_files::trace::TraceError>(())
/// ```
pub struct TraceCsv<W: Write> {
    lines: ::csv::Writer<W>,
    axes: usize,
    columns: Vec<Column>,
    text: Vec<u8>,
    /// Columns that are left empty.
    unknown: Vec<bool>,
}

impl<W: Write> TraceCsv<W> {
    /// Writes the header. Axes are counted from 0.
    ///
    /// The writer is buffered here; `w` need not be.
    ///
    /// # Errors
    /// When `w` refuses.
    pub fn new(w: W, shape: impl Into<RowShape>) -> Result<Self, TraceError> {
        let shape = shape.into();
        let columns: Vec<Column> = Column::of_run(shape).collect();
        let mut lines = ::csv::Writer::from_writer(w);
        let names = columns.iter().map(Column::name);
        lines.write_record(names.chain(WRITTEN_BY.map(str::to_owned)))?;
        Ok(Self {
            lines,
            unknown: vec![false; columns.len()],
            axes: shape.axes,
            columns,
            text: Vec::with_capacity(32),
        })
    }

    /// Leaves columns empty whose values are not available. The name of a column of axes has no axis number here.
    #[must_use]
    pub fn without(mut self, names: &[&str]) -> Self {
        let is_named = |column: &Column| names.contains(&column.field.name);
        self.unknown = self.columns.iter().map(is_named).collect();
        self
    }

    /// Writes one row.
    ///
    /// # Errors
    /// The row has a different number of axes from the header, and nothing of it is written. Or the writer refuses.
    pub fn write(&mut self, row: &Row) -> Result<(), TraceError> {
        if row.axes.len() != self.axes {
            return Err(TraceError::Axes {
                expected: self.axes,
                actual: row.axes.len(),
            });
        }
        for (column, is_unknown) in self.columns.iter().zip(&self.unknown) {
            self.text.clear();
            match column.value(row) {
                _ if *is_unknown => {}
                Value::Number(number) => decimal(&mut self.text, number)?,
                Value::Count(count) => write!(self.text, "{count}")?,
                Value::Word(word) => self.text.extend_from_slice(word.as_bytes()),
            }
            self.lines.write_field(&self.text)?;
        }
        // Ends the line.
        self.lines
            .write_record([version::RELEASE, version::commit()])?;
        Ok(())
    }

    /// Flushes and returns the writer.
    ///
    /// # Errors
    /// The writer refuses the last bytes. If the trace were dropped instead, this error would be lost.
    pub fn finish(self) -> Result<W, TraceError> {
        Ok(self.lines.into_inner().map_err(|e| e.into_error())?)
    }
}

/// Writes a number with a decimal point.
fn decimal(text: &mut Vec<u8>, number: f64) -> io::Result<()> {
    write!(text, "{number}")?;
    if number.is_finite() && !text.contains(&b'.') {
        text.extend_from_slice(b".0");
    }
    Ok(())
}
