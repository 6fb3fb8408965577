//! Random valid scenes over all documented keys and ranges, including the ends of the ranges.
//!
//! [`scene`] draws one from a seed alone: the same seed gives the same text on every host. Each file here draws a table or two of
//! the scene (`docs/scenes.md`). A scene is made as a [`Scene`](cophase_scene::file::Scene) and then written out. A key that is added to the file format
//! therefore does not compile here until it is drawn.
//!
//! Most numbers are drawn evenly over the logarithm of their range, and some exactly at one of its ends. Keys that depend on each
//! other are mostly drawn so that they fit: steps that the pulses allow, levels that the speed limit reaches, motors that can
//! move their load. Some scenes are refused all the same. The test counts them.
//!
//! Times are not drawn over their whole ranges, because a scene of 10⁶ s would run for days: a program lasts some seconds.

mod axes;
mod basis;
mod cam;
mod control;
mod events;
mod faults;
mod fidelity;
mod machine;
mod motors;
mod plain;
mod program;
mod random_scene;
mod source;
mod steady;
mod tables;

use cophase_scene::{SceneError, load};
use host_sim::checked::Checked;

pub use basis::Kinds;
pub use random_scene::{RandomScene, TABLE_FILE};
pub use source::Source;
pub use steady::steady;

/// Draws a scene of any kind.
pub fn scene(seed: u64) -> RandomScene {
    draw(seed, Kinds::ALL)
}

/// Draws a scene of these kinds.
///
/// # Panics
/// Never: every scene can be written as TOML.
pub fn draw(seed: u64, kinds: Kinds) -> RandomScene {
    let (scene, table) = tables::scene_and_table(&mut Source::new(seed), kinds, seed);
    RandomScene {
        text: toml::to_string(&scene).expect("a scene can be written as TOML"),
        table,
    }
}

/// Draws a scene of these kinds and checks it, as the command does with a file. Scenes with a table in a file of its own are not
/// drawn with [`Kinds::has_questions`].
///
/// # Errors
/// The scene is refused.
pub fn checked(seed: u64, kinds: Kinds) -> Result<Checked, SceneError> {
    Checked::new(load::parse(&draw(seed, kinds).text)?)
}
