//! Singular configuration: a five-bar arm whose path reaches the edge of its workspace.
//!
//! Failure: where the links are in line, |sin(q₁ − q₂)| = 0, an outward motion of the hand requires unbounded joint speeds. There the cam
//! tables do not follow the path, and the drives do not follow the tables. Guard: a scene whose path comes within its margin is
//! refused, with the point of the path.

use super::panel::{Curve, Shown, failing, requested};
use super::runs::{built_in, check, refusal, run};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::picture::Level;

/// Reach of the arm: links 1 and 4 in line, mm.
pub const REACH_MM: f64 = 500.0;
/// Margin of the built-in scene.
pub const MARGIN: f64 = 0.2;
/// Distances of the path's end from the axis, mm, one per run.
pub const ENDS_MM: [f64; 8] = [400.0, 440.0, 470.0, 485.0, 492.0, 496.0, 498.0, 499.5];

/// Results of a path that ends at a distance from the axis.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Distance of the path's end from the axis, mm.
    pub end_mm: f64,
    /// Greatest distance of the commanded hand from the path, mm.
    pub table_mm: f64,
    /// Greatest distance of the hand from its commanded position, mm.
    pub place_mm: f64,
}

/// Returns scene `five-bar` without a surface, with its line at y = 300 mm extended to a distance from the axis, and with a margin.
///
/// # Errors
/// There is no such scene.
pub fn scene(end_mm: f64, margin: f64) -> Result<String, ChartError> {
    let x_mm = (end_mm * end_mm - 300.0 * 300.0).sqrt();
    let line = format!("[[0, 300], [{x_mm}, 300]]");
    let changes = [
        ("contact = { force_n = 5 }", &*format!("margin = {margin}")),
        ("[[0, 300], [200, 300]]", &line),
        ("[five_bar]", "fidelity = \"phased\"\n[five_bar]"),
        ("hold_s = 40", "hold_s = 45"),
    ];
    built_in("five-bar", &changes)
}

/// Runs a path with almost no margin.
///
/// # Errors
/// The scene is refused.
pub fn measure(end_mm: f64) -> Result<Facts, ChartError> {
    let text = scene(end_mm, 0.001)?;
    check(&text)?;
    let outcome = run(&text, &mut |_| {})?;
    let figures = &outcome.record.figures.machine_figures;
    let figure = |key: &str| {
        let found = figures.iter().find(|figure| figure.key == key);
        found.and_then(|figure| figure.value).unwrap_or(f64::NAN)
    };
    Ok(Facts {
        end_mm,
        table_mm: figure("table_error_mm"),
        place_mm: figure("place_error_mm"),
    })
}

/// Returns the distance from the axis at which |sin(q₁ − q₂)| of equal links is a margin, mm. With δ the angle between them, it is the
/// reach times cos(δ/2).
pub fn margin_mm(margin: f64) -> f64 {
    REACH_MM * (0.5 * margin.asin()).cos()
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let facts: Result<Vec<Facts>, ChartError> = ENDS_MM.into_iter().map(measure).collect();
    let facts = facts?;
    let curve = |of: fn(&Facts) -> f64| {
        facts
            .iter()
            .map(|facts| (facts.end_mm, of(facts)))
            .collect()
    };
    let refused_mm = margin_mm(MARGIN);
    let (first, last) = (facts[0], facts[facts.len() - 1]);
    let is_refused = refusal(&scene(last.end_mm, MARGIN)?).is_some();
    Ok(Shown {
        key: "singular",
        title: "Singular configuration: a five-bar arm at the edge of its reach".to_owned(),
        x: Axis::linear("distance of the path's end from the axis, mm", 400.0, 520.0),
        y: Axis::log("error of the hand, mm", 1e-4, 1.0),
        curves: vec![
            Curve::new(
                "commanded hand beside its path, mm",
                failing(curve(|facts| facts.table_mm)),
            ),
            Curve::new(
                "hand from its commanded place, mm",
                requested(curve(|facts| facts.place_mm)),
            ),
        ],
        levels: vec![Level::at_x(refused_mm, "refused")],
        says: format!(
            "A path that ends {:.1} instead of {:.0} mm before the edge of the reach leaves the commanded hand {:.3} instead of {:.4} mm beside it; with the default margin \
             the scene {} from {refused_mm:.1} mm on.",
            REACH_MM - last.end_mm,
            REACH_MM - first.end_mm,
            last.table_mm,
            first.table_mm,
            if is_refused { "is refused" } else { "is taken" },
        ),
    })
}
