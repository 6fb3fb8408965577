//! Breakdown: what happens at the bad places, a small scene and a panel each, with the guard that stands there.
//!
//! A file a panel: its scene, what is seen when it runs, and what is drawn of that. The scenes and what is seen are for the
//! tests too, which assert both the failure and the guard (`host-sim/command/tests/breakdown.rs`).
//!
//! - [`root`]: an amplitude that rises from 0 asks for an infinite acceleration;
//! - [`band`]: a resonance crossed slowly, and dwelt in;
//! - [`pull_out`]: one motor too weak;
//! - [`chain`]: explicit methods on a stiff chain;
//! - [`rods`]: the over-constrained platform on stiffer rods;
//! - [`overload`]: motors under five times their load, and a loop that takes five times its time;
//! - [`lambda`]: two terms where λ is at its ends;
//! - [`diverging`]: no panel, but the run that ends on the way; [`runs`]: how scenes are run and looked at.

pub mod band;
pub mod chain;
pub mod diverging;
pub mod lambda;
pub mod overload;
mod panel;
pub mod pull_out;
pub mod rods;
pub mod root;
pub mod runs;

use super::picture::{Panel, Picture, render};
use super::{ChartError, Drawn, Progress, Size};
use panel::Shown;

/// Makes a panel.
type Show = fn(Size) -> Result<Shown, ChartError>;

const PANELS: [Show; 7] = [
    |_| root::shown(),
    band::shown,
    |_| pull_out::shown(),
    chain::shown,
    rods::shown,
    |_| overload::shown(),
    |_| lambda::shown(),
];

/// Makes the chart.
pub fn draw(size: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let mut shown = Vec::new();
    for show in PANELS {
        shown.push(show(size)?);
        progress(shown.len() as u64, PANELS.len() as u64);
    }
    let csv = csv(&shown);
    let all: Vec<&str> = shown.iter().map(|shown| shown.says.as_str()).collect();
    let says = all.join(" ");
    let svg = render(Picture {
        title: "Breakdown: the bad places, and what stands guard there".to_owned(),
        says: says.clone(),
        columns: 3,
        chosen_is: "default",
        panels: shown.into_iter().map(panel).collect(),
    });
    Ok(Drawn { csv, svg, says })
}

fn panel(shown: Shown) -> Panel {
    Panel {
        title: shown.title,
        x: shown.x,
        y: shown.y,
        lines: shown.curves.into_iter().map(|curve| curve.line).collect(),
        levels: shown.levels,
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
