//! Breakdown: critical points of machines and methods, each with a small scene or design, a picture, and its guard.
//!
//! Each panel has a file with its scene, the measured facts, and their drawing. The tests use the same scenes and facts, and assert
//! both the failure and the guard (`host-sim/command/tests/breakdown/main.rs`).
//!
//! - [`root`]: an amplitude that rises from 0 requires an infinite acceleration;
//! - [`band`]: a resonance that is crossed slowly, or dwelt in;
//! - [`pull_out`]: one motor that is too weak;
//! - [`chain`]: explicit methods on a stiff chain;
//! - [`rods`]: the over-constrained platform on stiffer rods;
//! - [`overload`]: motors under five times their load, and a loop that takes five times its time;
//! - [`lambda`]: the two-term formula at the ends of the range of λ;
//! - [`branch`]: a crank-rocker whose dead centres lie on two branches;
//! - [`cam`]: a flexible cam shaft, and an electronic cam;
//! - [`capture`]: a screen that stays in its resonance;
//! - [`self_synchronisation`]: a screen with free exciters;
//! - [`stall`]: a crusher with rock that it does not break;
//! - [`friction`]: friction that is smoothed, on a mass that sticks and slips;
//! - [`singular`]: an arm whose path reaches the edge of its workspace;
//! - [`diverging`]: no panel, but a run that diverges; [`runs`]: running and observing the scenes.

pub mod band;
pub mod branch;
pub mod cam;
pub mod capture;
pub mod chain;
pub mod diverging;
pub mod friction;
pub mod lambda;
pub mod overload;
mod panel;
pub mod pull_out;
pub mod rods;
pub mod root;
pub mod runs;
pub mod self_synchronisation;
pub mod singular;
pub mod stall;

use super::picture::{Panel, Picture, render};
use super::{ChartError, Drawn, DrawnPicture, Progress, Size};
use panel::Shown;

/// Makes a panel.
type Show = fn(Size) -> Result<Shown, ChartError>;

/// All panels, in the order of the data and the message. A new panel needs a file beside this one and a line here.
const PANELS: &[Show] = &[
    |_| root::shown(),
    band::shown,
    |_| pull_out::shown(),
    chain::shown,
    rods::shown,
    |_| overload::shown(),
    |_| lambda::shown(),
    |_| branch::shown(),
    |_| cam::shown(),
    |_| capture::shown(),
    |_| self_synchronisation::shown(),
    |_| stall::shown(),
    |_| singular::shown(),
    friction::shown,
];

/// Makes the chart.
pub fn draw(size: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let mut shown = Vec::new();
    for show in PANELS {
        shown.push(show(size)?);
        progress(shown.len() as u64, PANELS.len() as u64);
    }
    let all: Vec<&str> = shown.iter().map(|shown| shown.says.as_str()).collect();
    Ok(Drawn {
        csv: csv(&shown),
        says: all.join("\n"),
        pictures: shown.into_iter().map(picture).collect(),
    })
}

/// Makes a separate picture of a panel, with a legend that is valid in this panel only.
fn picture(shown: Shown) -> DrawnPicture {
    let panel = Panel {
        title: String::new(),
        x: shown.x,
        y: shown.y,
        lines: shown.curves.into_iter().map(|curve| curve.line).collect(),
        levels: shown.levels,
    };
    let svg = render(Picture {
        title: shown.title,
        says: shown.says,
        columns: 1,
        chosen_is: "default",
        panels: vec![panel],
    });
    DrawnPicture {
        part: Some(shown.key),
        svg,
    }
}

fn csv(shown: &[Shown]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let number = |value: f64| {
        if value.is_nan() {
            String::new()
        } else {
            format!("{value:.6e}")
        }
    };
    // Writing to memory cannot fail.
    let _ = writer.write_record(["panel", "line", "x", "y"]);
    for shown in shown {
        for curve in &shown.curves {
            for &(x, y) in &curve.data {
                let _ = writer.write_record([shown.key, &curve.name, &number(x), &number(y)]);
            }
        }
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}
