//! Figures of a machine of its own kind, for the report.

/// One figure of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Key in `report.json`; it carries the unit.
    pub key: &'static str,
    /// Value; none if the run did not come to it.
    pub value: Option<f64>,
    /// Sentence for the summary; empty if that of another figure has the value.
    pub sentence: String,
}

impl Figure {
    /// Key and value, for the report.
    pub(crate) fn entry(&self) -> (&'static str, Option<f64>) {
        (self.key, self.value)
    }
}
