//! What a run leaves behind for people to look at.
//!
//! One [`Row`] a control tick goes in; out come [`TraceCsv`] (numbers), [`StepsVcd`] (edges, as a logic
//! analyser sees them) and [`ScopeData`] (one page, as a scope shows it). [`RunFiles`] puts them in a folder,
//! all or none, and a [`Recorder`] makes rows of what it sees of a run. What the columns and wires mean for a reader is in `docs/formats.md`.
//!
//! Nothing here reads a clock or a locale: the same run gives the same bytes.

mod csv;
mod files;
mod recorder;
mod row;
mod rows;
mod scope;
mod vcd;
mod window;

pub use csv::{TraceCsv, TraceError};
pub use files::{RunFiles, RunFilesError};
pub use recorder::{RecordError, Recorder};
pub use row::{AxisRow, Row};
pub use rows::{Every, MOST_ROWS};
pub use scope::{Moved, ScopeData, ScopeFrame};
pub use vcd::{Levels, Signal, StepsVcd, VcdError};
pub use window::Window;
