//! The files of a trace, by format.

/// Format of a trace. Each format has its own file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values: rows.
    Csv,
    /// Value Change Dump: edges.
    Vcd,
    /// Fast Signal Trace: edges and values.
    Fst,
    /// MCAP with messages in JSON: rows.
    Mcap,
}

impl Format {
    /// All formats, in the order of lists.
    pub const ALL: [Self; 4] = [Self::Csv, Self::Vcd, Self::Fst, Self::Mcap];

    /// Returns its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Vcd => "vcd",
            Self::Fst => "fst",
            Self::Mcap => "mcap",
        }
    }

    /// Returns the name of its file.
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::Csv => "trace.csv",
            Self::Vcd => "steps.vcd",
            Self::Fst => "steps.fst",
            Self::Mcap => "trace.mcap",
        }
    }

    /// Returns true if its file has edges in a window, and not rows of the whole run.
    pub const fn has_edges(self) -> bool {
        matches!(self, Self::Vcd | Self::Fst)
    }
}
