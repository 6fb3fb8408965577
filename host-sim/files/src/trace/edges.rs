//! Files of edges, before and within their window.

use std::io::{Seek, Write};

use super::{EdgeError, Levels, Row, RowShape, Signal, StepsFst, StepsVcd};

/// Writer of edges, by format.
pub(super) struct EdgeOutputs<W> {
    pub vcd: Option<W>,
    pub fst: Option<W>,
    /// Columns of the rows.
    pub shape: RowShape,
}

impl<W> Default for EdgeOutputs<W> {
    fn default() -> Self {
        Self {
            vcd: None,
            fst: None,
            shape: RowShape::default(),
        }
    }
}

impl<W: Write + Seek> EdgeOutputs<W> {
    /// Begins the files with every wire's level at `from_ns`.
    pub fn begin(
        self,
        axes: usize,
        from_ns: u64,
        levels: &Levels,
    ) -> Result<Vec<EdgeFile<W>>, EdgeError> {
        let mut files = Vec::new();
        if let Some(w) = self.vcd {
            let vcd = StepsVcd::new(w, axes, from_ns, levels)?;
            files.push(EdgeFile::Vcd(Box::new(vcd)));
        }
        if let Some(w) = self.fst {
            let fst = StepsFst::new(w, self.shape, from_ns, levels)?;
            files.push(EdgeFile::Fst(Box::new(fst)));
        }
        Ok(files)
    }
}

/// A file of edges while it is written.
pub(super) enum EdgeFile<W: Write + Seek> {
    Vcd(Box<StepsVcd<W>>),
    Fst(Box<StepsFst<W>>),
}

impl<W: Write + Seek> EdgeFile<W> {
    pub fn change(&mut self, time_ns: u64, signal: Signal, level: bool) -> Result<(), EdgeError> {
        match self {
            Self::Vcd(vcd) => vcd.change(time_ns, signal, level),
            Self::Fst(fst) => fst.change(time_ns, signal, level),
        }
    }

    /// Writes the numbers of a row, if the format has them.
    pub fn sample(&mut self, time_ns: u64, row: &Row) -> Result<(), EdgeError> {
        match self {
            Self::Vcd(_) => Ok(()),
            Self::Fst(fst) => fst.sample(time_ns, row),
        }
    }

    pub fn finish(self, end_ns: u64) -> Result<(), EdgeError> {
        match self {
            Self::Vcd(vcd) => vcd.finish(end_ns).map(drop),
            Self::Fst(fst) => fst.finish(end_ns).map(drop),
        }
    }
}
