//! Sample of a scene: a shorter scene with the same lags and torques.
//!
//! Lags and torques depend on speeds and ramps; a longer hold repeats the same turns. So holds are shortened, repeated blocks are
//! played once, and ramps are unchanged. A scene with events at stated times stays whole, as these would come at another moment of
//! its program. A short scene stays whole, too.

use cophase_scene::file::{Fidelity, Segment};
use cophase_scene::{Scene, SceneError};

use crate::checked::Checked;

/// Duration of a shortened hold, s: enough for the oscillation after a ramp to decay, and for some turns.
pub const HOLD_S: f64 = 0.3;

/// Duration of a program, s, up to which the sample is the whole scene. Such a sample is evidence without a bound.
pub const WHOLE_S: f64 = 10.0;

/// Returns the duration of a scene's program, s.
fn program_s(scene: &Scene) -> f64 {
    length_s(&scene.program)
}

fn length_s(program: &[Segment]) -> f64 {
    let lengths = program.iter().map(|segment| {
        let inner = segment.segments.as_deref().map_or(0.0, length_s);
        let times = f64::from(segment.repeat.unwrap_or(1));
        segment.ramp_s.unwrap_or(0.0) + segment.hold_s.unwrap_or(0.0) + times * inner
    });
    lengths.sum()
}

/// Returns the sample of a scene on one of its model levels, with the scene's own step.
///
/// # Errors
/// The scene lacks data for the model level.
pub fn on(checked: &Checked, model_level: Fidelity) -> Result<Checked, SceneError> {
    let mut scene = from_scene(&checked.scene);
    scene.fidelity = model_level;
    let mut sample = Checked::new(scene)?;
    sample.resolution = checked.resolution;
    sample.halvings = checked.halvings;
    Ok(sample)
}

/// Returns the sample of a scene.
pub fn from_scene(scene: &Scene) -> Scene {
    let mut sample = scene.clone();
    let is_timed = !(scene.command.is_empty()
        && scene.input.is_empty()
        && scene.late.is_empty()
        && scene.fault.is_empty());
    if !is_timed && program_s(scene) > WHOLE_S {
        shorten(&mut sample.program);
    }
    sample
}

fn shorten(program: &mut [Segment]) {
    for segment in program {
        segment.hold_s = segment.hold_s.map(|hold_s| hold_s.min(HOLD_S));
        segment.repeat = segment.repeat.map(|repeat| repeat.min(1));
        if let Some(inner) = &mut segment.segments {
            shorten(inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::library;

    /// If this fails, a sample takes as long as its scene, or lacks its fastest turns.
    #[test]
    fn holds_are_cut_and_levels_kept() {
        let scene = library::SCENES[0].scene();
        let sample = from_scene(&scene);
        let levels = |program: &[Segment]| -> Vec<Option<f64>> {
            program.iter().map(|segment| segment.amax_g).collect()
        };
        assert_eq!(levels(&scene.program), levels(&sample.program));
        let ramps = |program: &[Segment]| -> f64 {
            program.iter().filter_map(|segment| segment.ramp_s).sum()
        };
        assert_eq!(ramps(&scene.program), ramps(&sample.program));
        let longest = sample.program.iter().filter_map(|segment| segment.hold_s);
        assert!(longest.fold(0.0, f64::max) <= HOLD_S);
        let block = sample.program.iter().find_map(|segment| segment.repeat);
        assert_eq!(block, Some(1));
    }

    /// If this fails, a stop during a hold comes after the end of the sample's program.
    #[test]
    fn a_scene_with_timed_events_is_not_shortened() {
        let mut scene = library::SCENES[0].scene();
        scene.late.push(cophase_scene::file::LateAt {
            at_s: 3.0,
            by_us: 700.0,
        });
        assert_eq!(from_scene(&scene), scene);
    }
}
