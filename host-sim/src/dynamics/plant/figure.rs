//! Figures of a plant in the report.

/// One figure of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Key in `report.json`, with the unit in its name.
    pub key: &'static str,
    /// Value. `None` if the run did not produce one.
    pub value: Option<f64>,
    /// Sentence for the summary. Empty if the sentence of another figure contains the value.
    pub sentence: String,
}

impl Figure {
    /// Key and value, for the report.
    pub fn entry(&self) -> (&'static str, Option<f64>) {
        (self.key, self.value)
    }
}
