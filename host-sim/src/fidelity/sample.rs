//! A shorter scene that shows what the whole one would.
//!
//! Lags and torques come of speeds and of changing them; holding a speed for longer shows the same turns again. So holds are
//! cut, repeated blocks are played once, and ramps stay as they are. A scene in which something happens at a time stays
//! whole, as that would come at another moment of its program. So does a short scene.

use crate::scene::file::{Fidelity, Segment};
use crate::scene::{Checked, Scene, SceneError};

/// What is left of a hold, s: time for what a change of speed sets swinging to die away, and for some turns.
pub const HOLD_S: f64 = 0.3;

/// Programs up to this length, s, stay whole: what the whole scene shows needs no bound to be believed.
pub const WHOLE_S: f64 = 10.0;

/// How long a scene's program takes, s.
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

/// The sample of a scene on one of its model levels, with the scene's own step.
///
/// # Errors
/// The scene lacks what the model level needs.
pub fn on(checked: &Checked, model_level: Fidelity) -> Result<Checked, SceneError> {
    let mut scene = of(&checked.scene);
    scene.fidelity = model_level;
    let mut sample = Checked::new(scene)?;
    sample.resolution = checked.resolution;
    sample.halvings = checked.halvings;
    Ok(sample)
}

/// The sample of a scene.
pub fn of(scene: &Scene) -> Scene {
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
    use crate::scene::library;

    /// Were it wrong, a sample would take as long as its scene, or leave out its fastest turns.
    #[test]
    fn holds_are_cut_and_levels_kept() {
        let scene = library::SCENES[0].scene();
        let sample = of(&scene);
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

    /// Were it wrong, a stop that comes while the level is held would come after the program.
    #[test]
    fn what_is_timed_stays_whole() {
        let mut scene = library::SCENES[0].scene();
        scene.late.push(crate::scene::file::LateAt {
            at_s: 3.0,
            by_us: 700.0,
        });
        assert_eq!(of(&scene), scene);
    }
}
