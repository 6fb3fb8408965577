//! `steps.fst`: the edges of `steps.vcd`, and the numbers of each control tick in the same window.
//!
//! Times are those of `steps.vcd`. Before the window's start every wire is unknown (`x`), every number `NaN`.

use std::io::{Seek, SeekFrom, Write};

use fst_writer::{
    FstBodyWriter, FstFileType, FstHeaderWriter, FstInfo, FstScopeType, FstSignalId, FstSignalType,
    FstVarDirection, FstVarType,
};

use super::column::{Column, Value};
use super::wires::{EdgeError, Levels, Signal, Wires};
use super::{Row, RowShape};

/// Offset of the start time in the format's header, bytes: one byte for the kind of block and eight for its
/// length precede it.
const START_TIME_AT: u64 = 9;

/// Changes are kept in memory and compressed in blocks of this many bytes.
const BLOCK: usize = 1 << 22;

/// Writes changes of wires, and values of columns, of scope `cophase`.
pub struct StepsFst<W: Write + Seek> {
    file: FstBodyWriter<W>,
    start_ns: u64,
    wires: Wires,
    ids: Vec<FstSignalId>,
    columns: Vec<(FstSignalId, Column)>,
}

impl<W: Write + Seek> StepsFst<W> {
    /// Writes the header and every wire's level at `start_ns` (since power-up), the window's start.
    ///
    /// # Errors
    /// When `w` refuses.
    pub fn new(
        w: W,
        shape: impl Into<RowShape>,
        start_ns: u64,
        initial: &Levels,
    ) -> Result<Self, EdgeError> {
        let shape = shape.into();
        let wires = Wires::new(shape.axes, start_ns, initial);
        let info = FstInfo {
            start_time: 0,
            timescale_exponent: -9,
            version: "cophase".to_owned(),
            date: String::new(), // the same run gives the same bytes
            file_type: FstFileType::Verilog,
        };
        let mut header = FstHeaderWriter::new(w, &info)?;
        header.scope("cophase", "", FstScopeType::Module)?;
        let mut add = |name: String, width, kind| {
            header.var(name, width, kind, FstVarDirection::Implicit, None)
        };
        let ids = wires
            .names()
            .map(|name| add(name, FstSignalType::bit_vec(1), FstVarType::Wire))
            .collect::<Result<Vec<_>, _>>()?;
        let columns = Column::of_run(shape)
            .filter(|column| column.is_numeric())
            .map(|column| {
                let id = add(column.name(), FstSignalType::real(), FstVarType::Real)?;
                Ok((id, column))
            })
            .collect::<Result<Vec<_>, EdgeError>>()?;
        header.up_scope()?;
        let mut file = header.finish()?;
        file.time_change(start_ns)?;
        for (&id, level) in ids.iter().zip(wires.levels()) {
            file.signal_change(id, level.map_or(b"x", bit))?;
        }
        Ok(Self {
            file,
            start_ns,
            wires,
            ids,
            columns,
        })
    }

    /// Sets `signal` to `level` from `time_ns` on. A level that the signal already has is not written.
    ///
    /// # Errors
    /// A time before the last one, or a wire that the file does not have.
    pub fn change(&mut self, time_ns: u64, signal: Signal, level: bool) -> Result<(), EdgeError> {
        if let Some(wire) = self.wires.change(time_ns, signal, level)? {
            self.advance(time_ns)?;
            self.file.signal_change(self.ids[wire], bit(level))?;
        }
        Ok(())
    }

    /// Sets the numbers of `row`, which hold from `time_ns` on.
    ///
    /// # Errors
    /// A time before the last one, or an error of the writer.
    ///
    /// # Panics
    /// If the row has fewer axes than the file.
    pub fn sample(&mut self, time_ns: u64, row: &Row) -> Result<(), EdgeError> {
        self.advance(time_ns)?;
        for (id, column) in &self.columns {
            let number = match column.value(row) {
                Value::Number(number) => number,
                Value::Count(count) => count as f64,
                Value::Word(_) => continue,
            };
            self.file.signal_change(*id, &number.to_le_bytes())?;
        }
        Ok(())
    }

    /// Writes the window's end, flushes, and returns the writer.
    ///
    /// # Errors
    /// An end before the last change, or an error of the writer.
    pub fn finish(mut self, end_time_ns: u64) -> Result<W, EdgeError> {
        self.advance(end_time_ns)?;
        let mut w = self.file.finish()?;
        // The crate writes 0 there, and a viewer would then show all time since power-up.
        w.seek(SeekFrom::Start(START_TIME_AT))?;
        w.write_all(&self.start_ns.to_be_bytes())?;
        w.flush()?;
        Ok(w)
    }

    fn advance(&mut self, time_ns: u64) -> Result<(), EdgeError> {
        if self.wires.advance(time_ns)? {
            // A block can end only before a new time.
            if self.file.size() > BLOCK {
                self.file.flush()?;
            }
            self.file.time_change(time_ns)?;
        }
        Ok(())
    }
}

const fn bit(level: bool) -> &'static [u8] {
    if level { b"1" } else { b"0" }
}
