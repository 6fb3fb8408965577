//! Traces of a run. All are made from the same rows and edges.

use std::io::{Seek, Write};

use super::TraceInfo;
use super::edges::EdgeOutputs;
use super::mcap::TraceMcap;
use super::rows::{Every, RowWriter, Rows};
use super::window::{StepWindow, Window};
use super::{Format, RecordError, Row, RowShape, RowsUdp, ScopeData, TickEdges, TraceCsv};

/// Form of the traces.
#[derive(Clone, Copy, Debug)]
pub struct TraceSetup<'a> {
    /// Columns of the rows.
    pub shape: RowShape,
    /// Rows that `trace.csv` gets.
    pub every: Every,
    /// Time that `steps.vcd` shows.
    pub window: Window,
    /// Columns whose values are not available, named without the number of the axis.
    pub unknown: &'a [&'a str],
}

/// Writer of the files, which also collects the data for `scope.svg`.
pub struct Traces<'a, W: Write + Seek> {
    axes: usize,
    rows: Rows<'a>,
    steps: StepWindow<W>,
    scope: ScopeData,
}

impl<'a, W: Write + Seek + 'a> Traces<'a, W> {
    /// Writes to `files`, of which each format has at most one. Sends rows to `udp`, and fills
    /// `scope`.
    ///
    /// # Errors
    /// A header cannot be written.
    pub fn new(
        setup: &TraceSetup<'_>,
        files: impl IntoIterator<Item = (Format, W)>,
        udp: Option<&'a mut RowsUdp>,
        scope: ScopeData,
    ) -> Result<Self, RecordError> {
        let shape = setup.shape;
        let mut rows: Vec<Box<dyn RowWriter + 'a>> = Vec::new();
        let mut edges = EdgeOutputs {
            shape,
            ..EdgeOutputs::default()
        };
        for (format, w) in files {
            match format {
                Format::Csv => {
                    rows.push(Box::new(TraceCsv::new(w, shape)?.without(setup.unknown)));
                }
                Format::Mcap => rows.push(Box::new(TraceMcap::new(w, shape)?)),
                Format::Vcd => edges.vcd = Some(w),
                Format::Fst => edges.fst = Some(w),
            }
        }
        if let Some(udp) = udp {
            rows.push(Box::new(udp));
        }
        Ok(Self {
            axes: shape.axes,
            rows: Rows::new(rows, setup.every),
            steps: StepWindow::new(edges, setup.window),
            scope,
        })
    }

    /// Takes the row of the next tick.
    ///
    /// # Errors
    /// The trace cannot be written.
    pub fn push_row(&mut self, row: &Row) -> Result<(), RecordError> {
        self.scope.push(row);
        self.rows.push(row)
    }

    /// Takes the edges of the next tick, and its row for formats that contain numbers.
    ///
    /// # Errors
    /// The edges cannot be written.
    pub fn push_edges(
        &mut self,
        tick: &TickEdges<'_>,
        row: Option<&Row>,
    ) -> Result<(), RecordError> {
        Ok(self.steps.tick(tick, row)?)
    }

    /// Closes the files. Returns the form of the written trace, and the content of the scope.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(self) -> Result<(TraceInfo, ScopeData), RecordError> {
        let (every, rows) = self.rows.finish()?;
        let (from_ns, to_ns) = self.steps.finish(self.axes)?;
        let written = TraceInfo {
            every,
            rows,
            window_from_s: Some(from_ns as f64 * 1e-9),
            window_to_s: Some(to_ns as f64 * 1e-9),
        };
        Ok((written, self.scope))
    }
}

impl<W: Write> RowWriter for TraceCsv<W> {
    fn write(&mut self, row: &Row) -> Result<(), RecordError> {
        Ok(self.write(row)?)
    }

    fn finish(self: Box<Self>) -> Result<(), RecordError> {
        (*self).finish()?;
        Ok(())
    }
}

impl<W: Write + Seek> RowWriter for TraceMcap<W> {
    fn write(&mut self, row: &Row) -> Result<(), RecordError> {
        Ok(self.write(row)?)
    }

    fn finish(self: Box<Self>) -> Result<(), RecordError> {
        (*self).finish()?;
        Ok(())
    }
}

/// Rows that cannot be sent are counted, and do not end a run.
impl RowWriter for &mut RowsUdp {
    fn write(&mut self, row: &Row) -> Result<(), RecordError> {
        self.send(row);
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), RecordError> {
        Ok(())
    }
}
