//! The scene that drawn ones begin with.

use cophase_scene::{Scene, load};

/// Returns a scene with the required keys only.
pub fn scene() -> Scene {
    const TEXT: &str = r#"
name = "plain"
machine = { load_kg = 1 }
limits = { speed_hz = 1, acceleration_hz_per_s = 1, jerk_hz_per_s2 = 1 }
axes = { count = 2, drive = "stepper", steps_per_turn = 200 }
program = []
"#;
    load::parse(TEXT).expect("all other keys have defaults")
}
