//! Estimate of the time that the choice of a model level takes.

use super::check::needs_sample;
use super::choose::available;
use super::sample;
use crate::scene::{Checked, SceneError};

/// Sample runs of a scene, expressed as runs on its top model level.
#[derive(Clone, Debug)]
pub struct SampleRuns {
    /// Sample on that level.
    pub sample: Checked,
    /// Number of its runs that take about as long as all sample runs.
    pub times: f64,
}

/// Typical number of such runs. The sample is run on the top level, and again with half the step, which takes twice as long; and the
/// same on the level that is chosen. Random scenes need 3 to 8 runs; a further halving of the step adds 4 and more.
const TIMES: f64 = 5.0;

/// Returns the sample runs that [`super::check`] will make; `None` if it makes none.
///
/// # Errors
/// The scene lacks data for its top model level.
pub fn sample_runs(checked: &Checked) -> Result<Option<SampleRuns>, SceneError> {
    let Some(choice) = checked
        .choice
        .as_ref()
        .filter(|choice| !choice.judged.is_empty())
    else {
        return Ok(None);
    };
    let levels = available(checked);
    let Some(&top) = levels.last().filter(|_| needs_sample(choice, &levels)) else {
        return Ok(None);
    };
    Ok(Some(SampleRuns {
        sample: sample::on(checked, top)?,
        times: TIMES,
    }))
}
