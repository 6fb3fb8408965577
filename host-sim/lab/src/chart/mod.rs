//! Charts: speed against accuracy, limits of methods and machines, and wrong decisions. Each chart is data (CSV) and one or more
//! pictures (SVG).
//!
//! Both are the same on every run, except for the column `timing` of some data: the duration of an evaluation, as a ratio to a
//! yardstick that is measured in the same run. No picture uses it.
//!
//! Some charts can also be made of a user's scene.
//!
//! - [`picture`]: panels, lines, legend, and the sentence below; [`axis`], [`ink`]: their parts;
//! - [`yardstick`]: the unit of durations;
//! - `integrated`: the equations of a user's scene;
//! - the others: one chart each, listed in `docs/charts.md`.

pub mod axis;
pub mod breakdown;
mod change_detection;
mod decisions;
mod drawn;
mod energy;
mod fidelity;
mod functions;
pub mod ink;
mod integrated;
pub mod methods;
pub mod picture;
mod stability;
mod tick_rate;
pub mod yardstick;

use cophase_scene::SceneError;
use host_sim::checked::Checked;

pub use drawn::{ChartError, Drawn, DrawnPicture, Progress, Size};

/// Function that makes a chart of a user's scene.
pub type DrawScene = fn(&Checked, Size, Progress) -> Result<Drawn, SceneError>;

/// Chart that can be made.
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    /// Name on the command line and of its files.
    pub name: &'static str,
    /// Summary in one line.
    pub shows: &'static str,
    /// Function that makes it.
    pub draw: fn(Size, Progress) -> Result<Drawn, ChartError>,
    /// Function that makes it of a user's scene; `None` if it is not about scenes.
    pub draw_scene: Option<DrawScene>,
}

/// All charts.
pub const CHARTS: &[Chart] = &[
    Chart {
        name: "methods",
        shows: "error against cost of each method, on this project's machines and on public problems",
        draw: methods::draw,
        draw_scene: Some(methods::of_scene::draw),
    },
    Chart {
        name: "stability",
        shows: "where each method stops being stable in step × frequency, and a trim in gain × delay, beside theory",
        draw: stability::draw,
        draw_scene: Some(stability::of_scene::draw),
    },
    Chart {
        name: "energy",
        shows: "which methods keep the energy of an undamped machine over 10,000 turns",
        draw: energy::draw,
        draw_scene: None,
    },
    Chart {
        name: "functions",
        shows: "error against cycles on the board, for root, sine and arctangent: ours and others'",
        draw: functions::draw,
        draw_scene: None,
    },
    Chart {
        name: "tick-rate",
        shows: "errors of holds, ramps and phase against the tick rate, and what each rate costs on the board",
        draw: tick_rate::draw,
        draw_scene: None,
    },
    Chart {
        name: "fidelity",
        shows: "error against cost of the model levels, for each built-in scene, and which of them auto takes",
        draw: fidelity::draw,
        draw_scene: Some(fidelity::draw_scene),
    },
    Chart {
        name: "decisions",
        shows: "error of each method, over step sizes, in the threshold at which a machine's outcome turns over",
        draw: decisions::draw,
        draw_scene: None,
    },
    Chart {
        name: "breakdown",
        shows: "failures of machines and methods, and the guards against them",
        draw: breakdown::draw,
        draw_scene: None,
    },
    Chart {
        name: "change-detection",
        shows: "how soon the monitor's rules, CUSUM and GLR detect small slips and drifts, against false alarms",
        draw: change_detection::draw,
        draw_scene: None,
    },
];

/// Returns the chart with a name.
pub fn find(name: &str) -> Option<&'static Chart> {
    CHARTS.iter().find(|chart| chart.name == name)
}
