//! Longest stable step on a mass with a spring and dry friction, by the treatment of friction.
//!
//! Friction that reverses smoothly over a speed u damps the mass near standstill, with the ratio ζ = F/(2uω). So it limits the step of
//! explicit methods, the more the sharper it is. Contacts that stick or slide leave at least the limit of the oscillation.

use std::fmt::Write;

use cophase_methods::Scheme;
use cophase_methods::problems::DenHartog;
use cophase_methods::problems::den_hartog::Smoothed;

use super::machines::{Linearised, STEPS_S};
use super::theory;
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::ink::Stroke;
use crate::chart::picture::{Line, Panel};

/// Damping ratios of smoothed friction at standstill.
const ZETAS: [f64; 5] = [1.0, 10.0, 100.0, 1000.0, 10_000.0];

/// Methods with a limit. Explicit Euler has none of its own without damping.
const SCHEMES: [Scheme; 3] = [Scheme::SymplecticEuler, Scheme::VelocityVerlet, Scheme::Rk4];

/// Start of a run with contacts, of F/ω². Friction then is a small part of the spring's force.
const START: f64 = 1000.0;
const STEPS: u32 = 20_000;

/// Growth at which a swing counts as unstable. Near its limit the energy of symplectic Euler ripples by hundreds of times.
const GROWN: f64 = 1e4;

/// Relative error of a limit.
const TOLERANCE: f64 = 1e-3;

/// Makes the panel, and the data.
pub(super) fn panel(csv: &mut String) -> Result<Panel, ChartError> {
    let mut lines = Vec::new();
    for scheme in SCHEMES {
        let smoothed = ZETAS.map(|zeta| Ok((zeta, smoothed(scheme, zeta)?)));
        let smoothed = smoothed
            .into_iter()
            .collect::<Result<Vec<_>, ChartError>>()?;
        for &(zeta, limit) in &smoothed {
            let by_theory = match scheme {
                Scheme::SymplecticEuler => theory(scheme, zeta).flatten(),
                // From ζ = 1/2 on the other eigenvalue is the first to reach −1.
                Scheme::VelocityVerlet => Some(1.0 / zeta),
                _ => None,
            };
            write_row(
                csv,
                scheme,
                "friction smoothed",
                Some(zeta),
                limit,
                by_theory,
            );
        }
        let limit = contacts(scheme)?;
        write_row(csv, scheme, "friction by contacts", None, limit, None);
        let [first, .., last] = ZETAS;
        let flat = Line {
            marked: false,
            ..Line::of_scheme(scheme, vec![(first, limit), (last, limit)])
        };
        lines.push(Line {
            label: format!("{scheme}, contacts"),
            chosen: scheme == Scheme::Rk4,
            stroke: Stroke::Solid,
            ..flat
        });
        lines.push(Line {
            label: format!("{scheme}, smoothed"),
            stroke: Stroke::Dotted,
            ..Line::of_scheme(scheme, smoothed)
        });
    }
    Ok(Panel {
        title: "dry friction: longest stable step".to_owned(),
        x: Axis::log("damping ratio of smoothed friction at rest", 0.7, 15_000.0),
        y: Axis::log("step × frequency, rad", 5e-5, 10.0),
        lines,
        levels: Vec::new(),
    })
}

fn write_row(
    csv: &mut String,
    scheme: Scheme,
    what: &str,
    zeta: Option<f64>,
    limit: f64,
    by_theory: Option<f64>,
) {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6}"));
    let zeta = zeta.map_or_else(String::new, |zeta| zeta.to_string());
    // Writing to a string does not fail.
    let _ = writeln!(
        csv,
        "{} with {what},{zeta},,{limit:.6},{},,",
        scheme.facts().name,
        number(by_theory)
    );
}

/// Returns the limit with smoothed friction, from the step matrix of the mass at rest.
fn smoothed(scheme: Scheme, zeta: f64) -> Result<f64, ChartError> {
    let oscillator = free();
    let smoothed = Smoothed {
        oscillator,
        speed_mps: oscillator.friction / (2.0 * zeta * oscillator.omega_rad_s),
    };
    let at_rest = Linearised::new("mass", &smoothed, &[0.0; 2], &[0, 1]);
    let limit_s = scheme.longest_stable_step_s(&at_rest, STEPS_S.0, STEPS_S.1)?;
    Ok(limit_s.unwrap_or(f64::INFINITY) * oscillator.omega_rad_s)
}

/// Returns the limit with contacts: the longest step with which a mass that swings does not swing ever further. It may be longer than
/// that of the free oscillation, as steps end where the mass reverses.
fn contacts(scheme: Scheme) -> Result<f64, ChartError> {
    let oscillator = free();
    let start_m = START * oscillator.friction / oscillator.omega_rad_s.powi(2);
    let grows = |h_omega: f64| -> Result<bool, ChartError> {
        let step_s = h_omega / oscillator.omega_rad_s;
        let mut method = scheme.prepare(&oscillator, step_s)?;
        let mut y = [start_m, 0.0];
        for step in 0..STEPS {
            let failed = method
                .step(&oscillator, f64::from(step) * step_s, &mut y)
                .is_err();
            if failed || y[0].abs() > GROWN * start_m {
                return Ok(true);
            }
        }
        Ok(false)
    };
    let (mut inside, mut outside) = (1.0, 4.0);
    while outside - inside > TOLERANCE * outside {
        let middle = f64::midpoint(inside, outside);
        if grows(middle)? {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    Ok(inside)
}

/// Mass without a driving force.
fn free() -> DenHartog {
    DenHartog {
        force: 0.0,
        ..DenHartog::STOPPING
    }
}
