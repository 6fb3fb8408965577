//! Time that the choice of a model level takes, estimated before it is made.

use super::check::needs_sample;
use super::choose::available;
use super::sample;
use crate::scene::{Checked, SceneError};

/// Sample runs of a scene, in runs on its top model level.
#[derive(Clone, Debug)]
pub struct SampleRuns {
    /// The sample, on that level.
    pub sample: Checked,
    /// How many runs of it take about as long as all of them.
    pub times: f64,
}

/// The sample is run on the top level, and again with half the step, which takes twice as long. The level that is taken may be another
/// one, likewise. Over random scenes it comes to 3 to 8 runs; a step that has to be halved again adds 4 and more.
const TIMES: f64 = 5.0;

/// Sample runs that [`super::check`] will make; none where no sample is run.
///
/// # Errors
/// The scene lacks what its top model level needs.
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
