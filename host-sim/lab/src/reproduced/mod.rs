//! Published figures beside those of this project: the list behind `docs/reproduced.md`, which `cophase reproduced` writes.
//!
//! Each machine has a file. The published numbers are here and in the tests on purpose. A test does not take its expectation from
//! this list, and this list does not take its figures from a test.

mod cam;
mod crank_rocker;
mod five_bar;
mod jaw_crusher;
mod page;
mod platform;
mod screen;

pub use page::write_page;

/// Figures of one machine.
#[derive(Clone, Debug)]
pub struct Section {
    /// Machine.
    pub title: &'static str,
    /// Source, with remarks.
    pub source: &'static str,
    /// Command that runs the tests.
    pub command: &'static str,
    /// Figures, in the order of the source's items.
    pub figures: Vec<Figure>,
}

/// Figure, or several of one kind.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Item, by the numbers of the list that the tests cite.
    pub item: u32,
    /// Quantity, with its unit.
    pub what: &'static str,
    /// Values that the source prints, or that were calculated from it independently of this project.
    pub published: Vec<f64>,
    /// Values of this project.
    pub ours: Vec<f64>,
    /// Permitted difference.
    pub tolerance: Tolerance,
    /// Test that asserts it: file and name.
    pub test: (&'static str, &'static str),
    /// Remark: a calibration, or the reason why it is not reproduced.
    pub note: &'static str,
}

/// Permitted difference of a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// Absolute tolerance, in the figure's unit.
    Absolute(f64),
    /// Tolerance relative to the figure.
    Relative(f64),
    /// None: the figure is not reproduced, and the note has the reason.
    NotReproduced,
}

impl Figure {
    /// Creates a figure that is reproduced without a remark.
    fn new<const N: usize>(
        item: u32,
        what: &'static str,
        published: [f64; N],
        ours: [f64; N],
        tolerance: Tolerance,
        test: (&'static str, &'static str),
    ) -> Self {
        Self {
            item,
            what,
            published: published.to_vec(),
            ours: ours.to_vec(),
            tolerance,
            test,
            note: "",
        }
    }

    /// Returns the same figure with a remark.
    fn noted(mut self, note: &'static str) -> Self {
        self.note = note;
        self
    }

    /// Largest difference between ours and the published values.
    pub fn difference(&self) -> f64 {
        let pairs = self.published.iter().zip(&self.ours);
        pairs
            .map(|(published, ours)| (ours - published).abs())
            .fold(0.0, f64::max)
    }

    /// True if every value is within the tolerance.
    pub fn is_within(&self) -> bool {
        let mut pairs = self.published.iter().zip(&self.ours);
        pairs.all(|(published, ours)| {
            let off = (ours - published).abs();
            match self.tolerance {
                Tolerance::Absolute(max) => off <= max,
                Tolerance::Relative(max) => off <= max * published.abs(),
                Tolerance::NotReproduced => true,
            }
        })
    }
}

/// Reason why a figure could not be computed.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct ReproducedError(String);

impl ReproducedError {
    fn from_error(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}

/// All sections.
///
/// # Errors
/// A design or a problem is refused.
pub fn sections() -> Result<Vec<Section>, ReproducedError> {
    Ok(vec![
        platform::section()?,
        crank_rocker::section()?,
        cam::section()?,
        screen::section()?,
        five_bar::section()?,
        jaw_crusher::section()?,
    ])
}
