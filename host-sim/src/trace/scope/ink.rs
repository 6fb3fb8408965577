//! Colours, texts and places on the page.

use super::scale::TimeAxis;
pub use crate::ink::{INK, MUTED, VERMILION, text, text_anchored};

/// The page's width, px.
pub const WIDTH: f64 = 1200.0;
/// Margins beside the panels, px.
pub const LEFT: f64 = 78.0;
/// See there.
pub const RIGHT: f64 = 182.0;
const PLOT_WIDTH: f64 = WIDTH - LEFT - RIGHT;

/// Where a time is on the page, px from the left.
pub fn at(time: TimeAxis, t_s: f64) -> f64 {
    LEFT + PLOT_WIDTH * time.fraction(t_s)
}

/// About how wide a text is, px; the viewer's font is not known here.
pub fn width(text: &str, size: u32) -> f64 {
    0.58 * f64::from(size) * text.chars().count() as f64
}

/// Whether a text of the ribbon's size goes into so many pixels.
pub fn fits(text: &str, room: f64) -> bool {
    width(text, 12) + 6.0 <= room
}
