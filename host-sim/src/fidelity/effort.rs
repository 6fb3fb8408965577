//! Runs that the choice of a model level makes.

use cophase_scene::SceneError;

use super::check::needs_sample;
use super::sample;
use crate::checked::Checked;
use crate::model_level::available;

/// Returns the longest of the sample runs that [`super::check`] will make: that on the top model level. `None` if it makes none.
///
/// # Errors
/// The scene lacks data for its top model level.
pub fn sample_run(checked: &Checked) -> Result<Option<Checked>, SceneError> {
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
    sample::on(checked, top).map(Some)
}
