//! What a run leaves behind for people to look at.
//!
//! One [`Row`] a control tick goes in; out come [`TraceCsv`] (numbers), [`StepsVcd`] (edges, as a logic
//! analyser sees them) and [`ScopeData`] (one page, as a scope shows it). [`RunFiles`] puts them in a folder,
//! all or none. What the columns and wires mean for a reader is in `docs/formats.md`.
//!
//! Nothing here reads a clock or a locale: the same run gives the same bytes.

mod csv;
mod files;
mod row;
mod scope;
mod vcd;

pub use csv::{TraceCsv, TraceError};
pub use files::{RunFiles, RunFilesError};
pub use row::{AxisRow, Row};
pub use scope::{ScopeData, ScopeFrame};
pub use vcd::{Levels, Signal, StepsVcd, VcdError};
