//! `scope.svg`: one page that shows a run as a scope would.
//!
//! Four panels share the time axis: acceleration amplitude requested, commanded and actual (the greatest of each turn), speed, phase error of each axis, tilt (of a machine without a
//! platform, the mean acceleration of its pushers or the displacement of what it moves instead). Above them a
//! *ribbon* shows the supervisor's states, and *marks* (events with a name) cross all panels.
//!
//! A run may have any length, so rows are folded as they come into an [`envelope`] of at most 1500 buckets,
//! each of which keeps its rows' smallest and largest values: no spike is lost, however short, but its place is
//! known to a bucket only. Marks and state changes, too, are kept in bounded number (see [`timeline`]).
//!
//! What is not a finite number is left out of the picture; a row without a finite time is left out entirely.

mod curve;
mod data;
mod draft;
mod envelope;
mod ink;
mod labels;
mod overlay;
mod page;
mod panel;
mod scale;
mod timeline;

pub use data::{Moved, ScopeData, ScopeFrame};
pub(crate) use draft::Panel;
pub use envelope::{Envelope, Extent};
pub use overlay::{Overlay, OverlayRow};
pub(crate) use page::{FONT, GAP, TIME_AXIS, embed};
pub(crate) use panel::BAND;
pub(crate) use scale::{plain, short};
