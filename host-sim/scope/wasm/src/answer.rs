//! Answer to the page: the mistakes of a text, or the results of its scene.

use cophase_scene::SceneError;
use serde::Serialize;

/// Answer to a text: mistakes, or a scene.
#[derive(Debug, Serialize)]
pub struct Answer {
    /// Mistakes in the order of their lines; empty if the scene was previewed.
    pub mistakes: Vec<Mistake>,
    /// The scene, if there is no mistake.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<Scene>,
}

/// Mistake in the text.
#[derive(Debug, PartialEq, Serialize)]
pub struct Mistake {
    /// Line, counted from 1; `None` if the mistake belongs to no single line.
    pub line: Option<usize>,
    /// Sentence of `cophase run`: key, problem and fix, without the file's name and line.
    pub text: String,
}

/// A scene that was previewed.
#[derive(Debug, Serialize)]
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// Duration of the program, s, without homing and parking.
    pub program_s: f64,
    /// Expected duration of the run, s.
    pub expected_s: f64,
    /// End of the last tick in the preview, s since power-up.
    pub previewed_s: f64,
    /// End of the run.
    pub ended: Ended,
    /// Limits of the shaft.
    pub limits: Limits,
}

/// End of a run.
#[derive(Debug, Serialize)]
pub struct Ended {
    /// Last state of the supervisor.
    pub state: &'static str,
    /// Fault that latched, if one did.
    pub fault: Option<&'static str>,
    /// True if the run continues, and was previewed only up to here.
    pub is_cut_off: bool,
}

/// Limits of the shaft.
#[derive(Debug, Serialize)]
pub struct Limits {
    /// Greatest speed, rad/s.
    pub speed_rad_s: f64,
    /// Amax at the greatest speed, m/s².
    pub amax_mps2: f64,
    /// Greatest acceleration, rad/s².
    pub acceleration_rad_s2: f64,
    /// Forbidden bands of speed, rad/s: lower and upper edge.
    pub bands_rad_s: Vec<(f64, f64)>,
}

impl Answer {
    /// Answer to a text that is refused.
    pub(crate) fn refused(mut error: SceneError) -> Self {
        let others = std::mem::take(&mut error.others);
        let errors = std::iter::once(error).chain(others);
        Self {
            mistakes: errors.map(Mistake::from_error).collect(),
            scene: None,
        }
    }

    /// Answer to a scene.
    pub(crate) const fn previewed(scene: Scene) -> Self {
        Self {
            mistakes: Vec::new(),
            scene: Some(scene),
        }
    }
}

impl Mistake {
    /// Converts an error. The text does not repeat the line, because the page marks it.
    fn from_error(error: SceneError) -> Self {
        let line = error.line;
        let unplaced = SceneError {
            origin: String::new(),
            line: None,
            ..error
        };
        let text = unplaced.to_string();
        Self {
            line,
            text: text.strip_prefix(": ").unwrap_or(&text).to_owned(),
        }
    }
}
