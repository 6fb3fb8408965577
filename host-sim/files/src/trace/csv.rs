//! `trace.csv`: one line per row, every [`Column`] with its unit in its name.
//!
//! A number is written in the shortest form that reads back as the column's rounded value: tick 1 of a 2 kHz loop is
//! `0.0005`, not `0.000500000`. It always has a decimal point, so that a reader that infers the type of a column from its first rows does not
//! find whole numbers. A value that is not finite is written `NaN`, `inf` or `-inf`, which Rust, pandas and numpy read back.

use std::io::{self, BufWriter, Write};

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
    /// The file refused.
    #[error("trace not written: {0}")]
    Write(#[from] io::Error),
    /// The last bytes could not be flushed.
    #[error("trace not flushed: {0}")]
    Flush(io::Error),
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
    file: BufWriter<W>,
    axes: usize,
    columns: Vec<Column>,
    /// One line, kept to reuse its memory.
    line: Vec<u8>,
    /// Fields after those of the columns, and the end of the line.
    end: String,
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
        let names = columns.iter().map(Column::name);
        let names: Vec<_> = names.chain(WRITTEN_BY.map(str::to_owned)).collect();
        let mut file = BufWriter::new(w);
        writeln!(file, "{}", names.join(","))?;
        Ok(Self {
            file,
            unknown: vec![false; columns.len()],
            axes: shape.axes,
            columns,
            line: Vec::new(),
            end: format!("{},{}\n", version::RELEASE, version::commit()),
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
        let line = &mut self.line;
        line.clear();
        for (column, is_unknown) in self.columns.iter().zip(&self.unknown) {
            match column.value(row) {
                _ if *is_unknown => {}
                Value::Number(number) => decimal(line, number, column.decimals())?,
                Value::Count(count) => write!(line, "{count}")?,
                Value::Word(word) => line.extend_from_slice(word.as_bytes()),
            }
            line.push(b',');
        }
        line.extend_from_slice(self.end.as_bytes());
        self.file.write_all(line)?;
        Ok(())
    }

    /// Flushes and returns the writer.
    ///
    /// # Errors
    /// The writer refuses the last bytes. If the trace were dropped instead, this error would be lost.
    pub fn finish(self) -> Result<W, TraceError> {
        let whole = self
            .file
            .into_inner()
            .map_err(io::IntoInnerError::into_error);
        let mut w = whole.map_err(TraceError::Flush)?;
        w.flush().map_err(TraceError::Flush)?;
        Ok(w)
    }
}

/// Writes a number that is rounded to this count of decimals, with a decimal point.
fn decimal(line: &mut Vec<u8>, number: f64, decimals: u32) -> io::Result<()> {
    // No two decimals of 15 digits are the same double, so these digits without the last zeros are the shortest.
    const MAX: f64 = 1e15;
    let scaled = number.abs() * 10_u64.pow(decimals) as f64;
    if decimals == 0 || !(0.0..MAX).contains(&scaled) {
        return shortest(line, number);
    }
    let mut left = (scaled + 0.5) as u64;
    // Written from the last digit on.
    let mut digits = [0; 24];
    let mut from = digits.len();
    let mut put = |digit: u8| {
        from -= 1;
        digits[from] = digit;
    };
    let mut is_end = true;
    for place in 1..=decimals {
        let digit = (left % 10) as u8;
        left /= 10;
        is_end &= digit == 0 && place < decimals;
        if !is_end {
            put(b'0' + digit);
        }
    }
    put(b'.');
    loop {
        put(b'0' + (left % 10) as u8);
        left /= 10;
        if left == 0 {
            break;
        }
    }
    if number < 0.0 {
        put(b'-');
    }
    line.extend_from_slice(&digits[from..]);
    Ok(())
}

/// Writes a number in the shortest form that reads back as it, with a decimal point if it is finite.
fn shortest(line: &mut Vec<u8>, number: f64) -> io::Result<()> {
    let from = line.len();
    write!(line, "{number}")?;
    if number.is_finite() && !line[from..].contains(&b'.') {
        line.extend_from_slice(b".0");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::rounding::rounded;
    use proptest::prelude::*;

    proptest! {
        /// If this fails, a number in a trace reads back as another one, or has digits that it does not need.
        #[test]
        fn numbers_have_their_shortest_form(value in -1e8_f64..1e8, magnitude in 0_i32..20, decimals in 0_u32..=9) {
            let number = rounded(value / 10_f64.powi(magnitude), decimals);
            let (mut short, mut expected) = (Vec::new(), Vec::new());
            decimal(&mut short, number, decimals).unwrap();
            shortest(&mut expected, number).unwrap();
            prop_assert_eq!(short, expected);
        }
    }
}
