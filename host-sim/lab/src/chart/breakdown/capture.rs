//! Capture at a resonance (Sommerfeld's effect): a motor of limited power does not pass it when it speeds up. When it coasts down, it
//! passes slowly.
//!
//! Failure: with 1.05 of its rated torque, the motor of the vibrating screen stays near the natural speed of 195 rpm, at five times the
//! working amplitude. Guards: the scene's forbidden band follows from its resonance. A scene whose motors have less torque than the
//! resonance requires is refused. The controller stops shafts that lag together, and reports the capture.

use std::f64::consts::TAU;

use cophase_methods::Scheme;
use cophase_methods::problems::Screen;

use super::panel::{Curve, Shown, failing, guarded, requested};
use super::runs::{built_in, fault_s, run};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::picture::Level;

/// Torque at which the motor is captured, over the rated torque.
pub const CAPTURED: f64 = 1.05;
const STEP_S: f64 = 1e-3;
const END_S: f64 = 30.0;

/// Speed of the shaft, rpm, and largest distance of the box from rest within a tenth of a second, mm, in the order of time.
pub type Path = Vec<(f64, f64)>;

/// Measured results.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Run-up with the motor's full breakdown torque.
    pub through: Path,
    /// Run-up with [`CAPTURED`] of the rated torque.
    pub captured: Path,
    /// Run-down without a motor, from the working speed.
    pub down: Path,
    /// Time after which the controller stopped a scene whose motors are too weak, s; `None` if it did not.
    pub stopped_s: Option<f64>,
}

/// Simulates a screen from a state. It ends when a shaft that began above 60 rpm is slower than that.
fn follow(torque_over_rated: f64, mut state: [f64; Screen::DIMENSION]) -> Result<Path, ChartError> {
    let screen = Screen { torque_over_rated };
    let mut method = Scheme::Rk4.prepare(&screen, STEP_S)?;
    let started_rpm = state[5] * 60.0 / TAU;
    let mut path = Vec::new();
    let mut max_mm = 0.0_f64;
    for step in 1..=(END_S / STEP_S) as u32 {
        method.step(&screen, f64::from(step) * STEP_S, &mut state)?;
        max_mm = max_mm.max(1e3 * Screen::amplitude_m(&state));
        if step % 100 == 0 {
            let rpm = state[5] * 60.0 / TAU;
            path.push((rpm, max_mm));
            max_mm = 0.0;
            if started_rpm > 60.0 && rpm < 60.0 {
                break;
            }
        }
    }
    Ok(path)
}

/// Returns scene `screen` with motors of 100 N·m, where its resonance requires 174 N·m.
fn weak_scene() -> Result<String, ChartError> {
    let phased = "fidelity = \"phased\"\n[screen]\nallow_capture = true";
    let strong = "limit_nm = 399, following_error_deg = 30";
    built_in(
        "screen",
        &[("[screen]", phased), (strong, "limit_nm = 100")],
    )
}

/// Runs the scenes.
///
/// # Errors
/// A method or a scene is refused.
pub fn measure() -> Result<Facts, ChartError> {
    let outcome = run(&weak_scene()?, &mut |_| {})?;
    // The working speed, with the box opposite to the eccentric mass.
    let working = [-4.995e-3, 0.0, 0.0, 0.0, -4.995e-3 * 87.7, 87.7];
    Ok(Facts {
        through: follow(Screen::UNLIMITED, [0.0; Screen::DIMENSION])?,
        captured: follow(CAPTURED, [0.0; Screen::DIMENSION])?,
        down: follow(0.0, working)?,
        stopped_s: fault_s(&outcome),
    })
}

/// Returns the speed and the amplitude at the largest amplitude.
pub fn peak(path: &Path) -> (f64, f64) {
    let max = path.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
    max.unwrap_or_default()
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let facts = measure()?;
    let natural_rpm = Screen::omega_rad_s() * 60.0 / TAU;
    let (held_rpm, held_mm) = facts.captured.last().copied().unwrap_or_default();
    let stopped = facts.stopped_s.map_or_else(
        || "does not stop it".to_owned(),
        |t_s| format!("stops such shafts together {t_s:.2} s after power-up"),
    );
    Ok(Shown {
        key: "capture",
        title: "Capture at a resonance: run-up and run-down of a screen".to_owned(),
        x: Axis::linear("speed of the shaft, rpm", 0.0, 900.0),
        y: Axis::linear("displacement of the box, mm", 0.0, 40.0),
        curves: vec![
            Curve::new("run-up, full torque, mm", guarded(facts.through.clone())),
            Curve::new("run-up, captured, mm", failing(facts.captured.clone())),
            Curve::new("run-down, motor off, mm", requested(facts.down.clone())),
        ],
        levels: vec![Level::at_x(natural_rpm, "natural speed")],
        says: format!(
            "With {CAPTURED} of its rated torque the motor is captured at {held_rpm:.0} rpm and {held_mm:.1} mm, with full torque it passes with {:.1} mm, \
             and coasting down it passes with {:.1} mm; the controller {stopped}.",
            peak(&facts.through).1,
            peak(&facts.down).1,
        ),
    })
}
