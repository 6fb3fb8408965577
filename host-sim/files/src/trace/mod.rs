//! Files of a run: traces and pictures.
//!
//! The input is one [`Row`] per control tick. The output is numbers ([`TraceCsv`], [`TraceMcap`], and [`RowsUdp`] for live plots), edges
//! as a logic analyser shows them ([`StepsVcd`], [`StepsFst`]), and one page as a scope shows it ([`ScopeData`]). The
//! [columns](mod@column) are defined once for all of them. [`RunFiles`] puts the files in a folder, all or none, and a [`Recorder`] makes
//! rows of a run. `docs/formats.md` explains the columns and wires to readers.
//!
//! Nothing here reads a clock or a locale: the same run gives the same bytes.

pub mod column;
mod controller_rows;
mod csv;
mod edges;
mod files;
mod format;
mod fst;
mod json;
mod layout;
mod mcap;
mod overdue;
mod recorder;
mod rounding;
mod row;
mod rows;
mod scope;
mod tick_edges;
pub mod trace_info;
mod traces;
mod turn_amplitude;
mod udp;
mod vcd;
mod window;
mod wires;

pub(crate) use column::decimals;
pub(crate) use controller_rows::ControllerRows;
pub use csv::{TraceCsv, TraceError, WRITTEN_BY};
pub use files::{RunFiles, RunFilesError};
pub use format::Format;
pub use fst::StepsFst;
pub use layout::gtkwave_layout;
pub use mcap::{McapTraceError, TraceMcap};
pub use recorder::{RecordError, Recorder};
pub use row::{AxisRow, Row, RowShape};
pub use rows::{Every, MAX_ROWS};
pub(crate) use scope::{BAND, FONT, GAP, Panel, TIME_AXIS, embed, plain, short};
pub use scope::{Envelope, Extent, Overlay, OverlayRow, ScopeData, ScopeFrame};
pub use tick_edges::{SensedEdges, TickEdges};
pub use trace_info::TraceInfo;
pub(crate) use traces::{TraceSetup, Traces};
pub use udp::{RowsUdp, SentRows};
pub use vcd::StepsVcd;
pub use window::Window;
pub use wires::{EdgeError, Levels, Signal};
