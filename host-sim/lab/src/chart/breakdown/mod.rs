//! Breakdown: what happens at the bad places, a small scene or a design and a picture each, with the guard that stands there.
//!
//! Each panel has a file: its scene, the facts measured in it, and the drawing of them. Scenes and facts are for the
//! tests too, which assert both the failure and the guard (`host-sim/command/tests/breakdown.rs`).
//!
//! - [`root`]: an amplitude that rises from 0 asks for an infinite acceleration;
//! - [`band`]: a resonance crossed slowly, and dwelt in;
//! - [`pull_out`]: one motor too weak;
//! - [`chain`]: explicit methods on a stiff chain;
//! - [`rods`]: the over-constrained platform on stiffer rods;
//! - [`overload`]: motors under five times their load, and a loop that takes five times its time;
//! - [`lambda`]: two terms where λ is at its ends;
//! - [`branch`]: a crank-rocker whose dead centres lie on two branches;
//! - [`cam`]: a cam shaft that gives, beside an electronic cam;
//! - [`capture`]: a screen that hangs in its resonance;
//! - [`self_synchronisation`]: a screen whose exciters are left to themselves;
//! - [`stall`]: a crusher in rock that it does not break;
//! - [`singular`]: an arm whose path goes to the edge of its reach;
//! - [`diverging`]: no panel, but the run that ends on the way; [`runs`]: how scenes are run and looked at.

pub mod band;
pub mod branch;
pub mod cam;
pub mod capture;
pub mod chain;
pub mod diverging;
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

/// All panels, in the order of the data and the message. A new panel is a file beside this one and a line here.
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

/// A panel as a picture of its own, with a legend that is valid in this panel only.
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
    // Writing to memory does not fail.
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
