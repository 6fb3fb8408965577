//! `scope.svg`: one page that shows a run like an oscilloscope.
//!
//! Four panels share the time axis: requested, commanded and actual acceleration amplitude (the greatest of each turn), speed, phase
//! error of each axis, and tilt. A machine without a platform has the mean acceleration of its pushers, or the displacement of its
//! moving part, in place of the tilt. Above the panels, a *ribbon* shows the supervisor's states, and *marks* (named events) cross all
//! panels.
//!
//! A run may have any length. So rows are folded as they come into an [`envelope`] of at most 1500 buckets, each of which keeps its
//! rows' smallest and largest values. No spike is lost, however short, but its time is known only to the width of a bucket. The number
//! of marks and state changes is bounded, too (see [`timeline`]).
//!
//! Values that are not finite are left out of the picture, and so are rows without a finite time.

mod curve;
mod data;
mod draft;
mod envelope;
mod labels;
mod overlay;
mod page;
mod panel;
mod scale;
mod style;
mod timeline;

pub use data::{ScopeData, ScopeFrame};
pub(crate) use draft::Panel;
pub use envelope::{Envelope, Extent};
pub use overlay::{Overlay, OverlayRow};
pub(crate) use page::{FONT, GAP, TIME_AXIS, embed};
pub(crate) use panel::BAND;
pub(crate) use scale::{plain, short};
