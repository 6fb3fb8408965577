//! Limits of stability: of methods, as the growth of an oscillation per step against step × frequency; and of the trim of an axis,
//! in gain × delay; and of the treatment of dry friction.

mod friction;
pub mod machines;
pub mod of_scene;
mod trim;

use std::fmt::Write;

use cophase_methods::Scheme;

use super::axis::Axis;
use super::ink::{Ink, Stroke};
use super::picture::{Level, Line, Panel, Picture, render};
use super::{ChartError, Drawn, Progress, Size};

/// Damping ratios of the two panels.
const ZETAS: [f64; 2] = [0.0, 0.1];
/// Range of the curves, and their number of points.
const H_OMEGA: (f64, f64) = (0.1, 100.0);
const POINTS: u32 = 240;
const GROWTH: (f64, f64) = (0.1, 10.0);
/// Delays of the third panel, turns.
const DELAYS: std::ops::RangeInclusive<u32> = 0..=8;
/// Name of the trim in the data.
const TRIM: &str = "trim of an axis";

/// Returns the limit of theory in closed form, if there is a formula, for an oscillation with damping ratio ζ; the inner `None`
/// means no limit.
///
/// - Explicit Euler: the eigenvalues 1 − ζhω ± i hω √(1 − ζ²) have magnitude 1 at hω = 2ζ.
/// - Symplectic Euler: one eigenvalue reaches −1 where (hω)² + 4ζhω = 4.
/// - Velocity Verlet: one eigenvalue reaches −1 at hω = 2 / (ζ + √(1 − 3ζ²)) as long as ζ < ½.
/// - RK4: the eigenvalues have magnitude 1 at hω = 2√2 without damping.
fn theory(scheme: Scheme, zeta: f64) -> Option<Option<f64>> {
    match scheme {
        Scheme::ExplicitEuler => Some(Some(2.0 * zeta)),
        Scheme::SymplecticEuler => Some(Some(2.0 * ((1.0 + zeta * zeta).sqrt() - zeta))),
        Scheme::VelocityVerlet if zeta < 0.5 => {
            Some(Some(2.0 / (zeta + (1.0 - 3.0 * zeta * zeta).sqrt())))
        }
        Scheme::Rk4 if zeta == 0.0 => Some(Some(8.0_f64.sqrt())),
        Scheme::ImplicitMidpoint | Scheme::Sdirk4 | Scheme::Exact => Some(None),
        _ => None,
    }
}

/// Makes the chart.
pub fn draw(_: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let mut csv = "of,zeta,delay_turns,edge_measured,edge_theory,h_omega,growth\n".to_owned();
    let mut panels = Vec::new();
    let of = (ZETAS.len() + DELAYS.count()) as u64;
    for zeta in ZETAS {
        let mut lines = Vec::new();
        for scheme in Scheme::ALL {
            let edge = scheme.stability_limit(zeta);
            let points = curve(scheme, zeta, H_OMEGA);
            for &(h_omega, growth) in &points {
                let (measured, by_theory) = (
                    edge_label(edge),
                    match theory(scheme, zeta) {
                        Some(edge) => edge_label(edge),
                        None => String::new(),
                    },
                );
                // Writing to a string cannot fail.
                let _ = writeln!(
                    csv,
                    "{},{zeta},,{measured},{by_theory},{h_omega:.6},{growth:.9}",
                    scheme.facts().name
                );
            }
            lines.push(Line {
                marked: false,
                ..Line::of_scheme(scheme, points)
            });
        }
        progress(panels.len() as u64 + 1, of);
        panels.push(Panel {
            title: if zeta == 0.0 {
                "undamped".to_owned()
            } else {
                format!("damping ratio {zeta}")
            },
            ..growth_panel(H_OMEGA, lines)
        });
    }
    panels.push(trims(&mut csv, &mut |done| {
        progress(ZETAS.len() as u64 + done, of);
    }));
    panels.push(machines::panel(&mut csv)?);
    panels.push(friction::panel(&mut csv)?);
    let (limited, free): (Vec<_>, Vec<_>) = Scheme::ALL
        .iter()
        .map(|scheme| (scheme, ZETAS.map(|zeta| scheme.stability_limit(zeta))))
        .partition(|(_, edges)| edges.iter().any(Option::is_some));
    let edge =
        |edge: Option<f64>| edge.map_or_else(|| "never".to_owned(), |edge| format!("{edge:.3}"));
    let limited: Vec<_> = limited
        .iter()
        .map(|(scheme, edges)| format!("{scheme} {} / {}", edge(edges[0]), edge(edges[1])))
        .collect();
    let free: Vec<_> = free.iter().map(|(scheme, _)| scheme.to_string()).collect();
    let says = format!(
        "From which step × frequency on an oscillation grows, undamped / at damping ratio {}: {}; never with {}. A drift taken \
         back by a trim dies out up to a gain of 2 sin(π / (2 (2d + 1))) if it is acted on d turns late; beyond, it grows. Friction by \
         contacts does not shorten these steps; smoothed friction does.",
        ZETAS[1],
        limited.join(", "),
        free.join(", "),
    );
    let svg = render(Picture {
        title: "Stability: where an oscillation grows, and where a drift does".to_owned(),
        says: says.clone(),
        columns: 2,
        chosen_is: "default",
        panels,
    });
    Ok(Drawn::one(csv, svg, says))
}

/// Makes a panel of growth without its title.
fn growth_panel((from, to): (f64, f64), lines: Vec<Line>) -> Panel {
    Panel {
        title: String::new(),
        x: Axis::log("step × frequency, rad", from, to),
        y: Axis::log("growth a step", GROWTH.0, GROWTH.1),
        lines,
        levels: vec![Level::at_y(1.0, "above: it grows")],
    }
}

/// Returns the growth of a method in a step at each step × frequency of a range.
fn curve(scheme: Scheme, zeta: f64, (from, to): (f64, f64)) -> Vec<(f64, f64)> {
    let h_omega = |i| from * (to / from).powf(f64::from(i) / f64::from(POINTS));
    (0..=POINTS)
        .map(h_omega)
        .map(|h_omega| (h_omega, scheme.growth(h_omega, zeta)))
        .collect()
}

/// Makes the panel of trims: the measured limit at each delay, on the line of theory.
fn trims(csv: &mut String, progress: &mut dyn FnMut(u64)) -> Panel {
    let mut measured = Vec::new();
    for delay in DELAYS {
        let (edge, by_theory) = (trim::edge(delay), trim::theory(f64::from(delay)));
        // Writing to a string does not fail.
        let _ = writeln!(csv, "{TRIM},,{delay},{edge:.5},{by_theory:.6},,");
        measured.push((f64::from(delay), edge));
        progress(u64::from(delay) + 1);
    }
    // There is no loop with a delay between whole turns; the line connects the points.
    let theory = (0..=170)
        .map(|i| f64::from(i) / 20.0)
        .map(|delay| (delay, trim::theory(delay)));
    Panel {
        title: "trim of an axis: above the line drift grows".to_owned(),
        x: Axis::linear("delay, turns", 0.0, 8.5),
        y: Axis::linear("gain: part of the drift taken back a turn", 0.0, 2.2),
        lines: vec![
            Line {
                stroke: Stroke::Dotted,
                marked: false,
                ..Line::new("trim, theory", Ink::Grey, theory.collect())
            },
            Line {
                stroke: Stroke::None,
                ..Line::new("trim, measured", Ink::Black, measured)
            },
        ],
        levels: Vec::new(),
    }
}

fn edge_label(edge: Option<f64>) -> String {
    edge.map_or_else(|| "none".to_owned(), |edge| format!("{edge:.6}"))
}
