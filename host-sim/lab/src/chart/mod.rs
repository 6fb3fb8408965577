//! Charts: speed against accuracy, where things stop working, and what is decided wrongly. Each is data (CSV) and one or
//! more pictures (SVG).
//!
//! Both are the same on every run, but for one column of the data, `timing`, where there is one: what an evaluation takes
//! on a clock, as a ratio to a yardstick measured in the same run. No picture is drawn from it.
//!
//! - [`picture`]: panels, lines, legend, and the sentence under them; [`axis`], [`ink`]: what they are made of;
//! - [`yardstick`]: what time is measured in;
//! - the rest: a chart each, `docs/charts.md` says which.

pub mod axis;
pub mod breakdown;
mod decisions;
mod drawn;
mod energy;
mod fidelity;
mod functions;
pub mod ink;
pub mod methods;
pub mod picture;
mod stability;
mod tick_rate;
pub mod yardstick;

pub use drawn::{ChartError, Drawn, DrawnPicture, Progress, Size};

/// A chart that can be made.
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    /// As it is called on the command line, and its files.
    pub name: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    /// Makes it.
    pub draw: fn(Size, Progress) -> Result<Drawn, ChartError>,
}

/// All charts.
pub const CHARTS: &[Chart] = &[
    Chart {
        name: "methods",
        shows: "error against cost of each method, on this project's machines and on public problems",
        draw: methods::draw,
    },
    Chart {
        name: "stability",
        shows: "where each method stops being stable in step × frequency, and a trim in gain × delay, beside theory",
        draw: stability::draw,
    },
    Chart {
        name: "energy",
        shows: "which methods keep the energy of an undamped machine over 10,000 turns",
        draw: energy::draw,
    },
    Chart {
        name: "functions",
        shows: "error against cycles on the board, for root, sine and arctangent: ours and others'",
        draw: functions::draw,
    },
    Chart {
        name: "tick-rate",
        shows: "errors of holds, ramps and phase against the tick rate, and what each rate costs on the board",
        draw: tick_rate::draw,
    },
    Chart {
        name: "fidelity",
        shows: "error against cost of the model levels, for each built-in scene, and which of them auto takes",
        draw: fidelity::draw,
    },
    Chart {
        name: "decisions",
        shows: "error of each method, over step sizes, in the threshold at which a machine's outcome turns over",
        draw: decisions::draw,
    },
    Chart {
        name: "breakdown",
        shows: "what happens at the bad places, and what stands guard there",
        draw: breakdown::draw,
    },
];

/// A chart by its name.
pub fn find(name: &str) -> Option<&'static Chart> {
    CHARTS.iter().find(|chart| chart.name == name)
}
