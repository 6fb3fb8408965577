//! Scenes: a machine, its limits, its program, and what happens to it, as a TOML file.
//!
//! A scene goes through three hands: [`load`] reads it and says what is wrong with its form, [`mod@file`]
//! is its form, and [`check`] turns it into the core's settings and says what is wrong with its
//! numbers. Whatever is wrong, the message names the file, the key, what is wrong with it, and what
//! would be right.

pub mod check;
mod checked;
mod error;
pub mod file;
pub mod library;
pub mod load;

pub use check::plant;
pub use checked::Checked;
pub use error::SceneError;
pub use file::Scene;

/// Evaluates an expression with a scene's number of axes as a constant.
///
/// The loop is generic over it, and scenes have it at run time.
///
/// ```
/// use host_sim::scene::{Checked, library};
/// use host_sim::sim::simulate;
///
/// let checked = Checked::new(library::find("patent-4").unwrap().scene()).unwrap();
/// let outcome = host_sim::with_axes!(checked.scene.axes.count, N => simulate::<N>(&checked, &mut (), |_, _| {}));
/// assert!(outcome.unwrap().fault.is_none());
/// ```
#[macro_export]
macro_rules! with_axes {
    ($count:expr, $N:ident => $body:expr) => {
        match $count {
            2 => $crate::with_axes!(@ $N, 2, $body),
            3 => $crate::with_axes!(@ $N, 3, $body),
            4 => $crate::with_axes!(@ $N, 4, $body),
            5 => $crate::with_axes!(@ $N, 5, $body),
            6 => $crate::with_axes!(@ $N, 6, $body),
            other => unreachable!("{other} axes: a checked scene has 2 to 6"),
        }
    };
    (@ $N:ident, $count:literal, $body:expr) => {{
        const $N: usize = $count;
        $body
    }};
}
