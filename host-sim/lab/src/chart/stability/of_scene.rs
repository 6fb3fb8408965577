//! Stability of each method on the modes of a user's scene: growth in a step, and the longest stable step.

use std::fmt::Write;

use cophase_methods::Scheme;
use cophase_scene::SceneError;
use host_sim::checked::Checked;
use host_sim::dynamics::Mode;

use super::machines::STEPS_S;
use super::{H_OMEGA, curve, growth_panel};
use crate::chart::ink::{Ink, Stroke};
use crate::chart::integrated::Integrated;
use crate::chart::picture::{Level, Line, Panel, Picture, render};
use crate::chart::{Drawn, Progress, Size};

/// Method, and its longest stable step on a scene.
struct Limit {
    scheme: Scheme,
    /// Longest stable step, s; `None` if it has no limit, and 0 if no step is stable.
    longest_s: Option<f64>,
}

/// Makes the chart of a scene.
pub fn draw(checked: &Checked, _: Size, progress: Progress) -> Result<Drawn, SceneError> {
    let scene = Integrated::new(checked)?;
    let limits = scene
        .schemes()
        .map(|scheme| limit(&scene, scheme))
        .collect::<Result<Vec<_>, _>>()?;
    let mut csv =
        "method,taken,mode_rad_s,zeta,longest_stable_step_s,step_s,margin,point,h_omega,growth\n"
            .to_owned();
    let of = scene.modes.len() as u64;
    let mut panels = Vec::new();
    for (place, mode) in scene.modes.iter().enumerate() {
        panels.push(panel(&scene, &limits, place, mode, &mut csv));
        progress(place as u64 + 1, of);
    }
    let says = says(&scene, &limits);
    let svg = render(Picture {
        title: format!("{}: growth of its modes in a step", checked.scene.name),
        says: says.clone(),
        columns: 2,
        chosen_is: "taken by the scene",
        panels,
    });
    Ok(Drawn::one(csv, svg, says))
}

/// Finds the longest stable step of a method: on linear equations with all modes together, else on each mode by itself. A run refuses a step
/// by the same limit.
fn limit(scene: &Integrated, scheme: Scheme) -> Result<Limit, SceneError> {
    let longest_s = if scene.equations.linear().is_some() {
        scheme
            .longest_stable_step_s(scene.equations.as_ref(), STEPS_S.0, STEPS_S.1)
            .map_err(|refused| SceneError::for_key("method", refused.to_string()))?
    } else {
        let each = scene.modes.iter();
        let each =
            each.filter_map(|mode| Some(scheme.stability_limit(mode.zeta)? / mode.omega_rad_s));
        each.min_by(f64::total_cmp)
    };
    Ok(Limit { scheme, longest_s })
}

/// Makes the panel of a mode, and its data.
fn panel(
    scene: &Integrated,
    limits: &[Limit],
    place: usize,
    mode: &Mode,
    csv: &mut String,
) -> Panel {
    let own = scene.step_s() * mode.omega_rad_s;
    let range = (H_OMEGA.0.min(0.5 * own), H_OMEGA.1.max(2.0 * own));
    let mut lines = Vec::new();
    for limit in limits {
        let points = curve(limit.scheme, mode.zeta, range);
        let at_own = (own, limit.scheme.growth(own, mode.zeta));
        write_rows(csv, scene, limit, mode, "scene", &[at_own]);
        write_rows(csv, scene, limit, mode, "curve", &points);
        let is_taken = limit.scheme == scene.scheme;
        lines.push(Line {
            marked: false,
            chosen: is_taken,
            ..Line::of_scheme(limit.scheme, points)
        });
        if is_taken {
            lines.push(Line {
                stroke: Stroke::None,
                ..Line::new("the scene’s step", Ink::Black, vec![at_own])
            });
        }
    }
    let what = if place == 0 { "fastest mode" } else { "mode" };
    let mut panel = growth_panel(range, lines);
    panel.levels.push(Level::at_x(own, "the scene’s step"));
    Panel {
        title: format!(
            "{what}: {} rad/s, damping ratio {:.3}",
            in_digits(mode.omega_rad_s),
            mode.zeta
        ),
        ..panel
    }
}

fn write_rows(
    csv: &mut String,
    scene: &Integrated,
    limit: &Limit,
    mode: &Mode,
    point: &str,
    points: &[(f64, f64)],
) {
    let number = |value: Option<f64>| {
        value.map_or_else(|| "none".to_owned(), |value| format!("{value:.6e}"))
    };
    let step_s = scene.step_s();
    for (h_omega, growth) in points {
        // Writing to a string cannot fail.
        let _ = writeln!(
            csv,
            "{},{},{:.6e},{:.6},{},{step_s:.6e},{},{point},{h_omega:.6e},{growth:.9e}",
            limit.scheme.facts().name,
            limit.scheme == scene.scheme,
            mode.omega_rad_s,
            mode.zeta,
            number(limit.longest_s),
            number(limit.longest_s.map(|longest_s| longest_s / step_s)),
        );
    }
}

/// Returns a number above 0 with four significant digits.
fn in_digits(value: f64) -> String {
    let decimals = (3.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

/// Returns a summary of the data.
fn says(scene: &Integrated, limits: &[Limit]) -> String {
    let in_us = |step_s: f64| format!("{} µs", in_digits(step_s * 1e6));
    let own = limits.iter().find(|limit| limit.scheme == scene.scheme);
    let margin = match own.and_then(|limit| limit.longest_s) {
        Some(longest_s) => format!(
            "its longest stable step is {}, {:.2} times that",
            in_us(longest_s),
            longest_s / scene.step_s()
        ),
        None => "it is stable at any step".to_owned(),
    };
    let others: Vec<_> = limits
        .iter()
        .filter(|limit| limit.scheme != scene.scheme)
        .map(|limit| match limit.longest_s {
            Some(0.0) => format!("{} none", limit.scheme),
            Some(longest_s) => format!("{} {}", limit.scheme, in_us(longest_s)),
            None => format!("{} any", limit.scheme),
        })
        .collect();
    let bounds = if scene.equations.linear().is_some() {
        ""
    } else {
        " The fastest mode is an upper bound of all modes, and the others are those of single parts."
    };
    format!(
        "The scene takes {} with a step of {}; {margin}. Stable steps of the others: {}.{bounds}",
        scene.scheme,
        in_us(scene.step_s()),
        others.join(", "),
    )
}
