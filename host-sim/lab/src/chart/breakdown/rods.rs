//! Four cranks over-constrain the platform: a crank with an offset bends the rods, and stiffer rods require more torque.
//!
//! Failure: the torque on this crank grows with the stiffness of the rods, and so does the frequency of the fastest mode. At last, the
//! step for soft rods is unstable. Guards: the step is chosen for the rods; an unstable step that the scene sets is refused with
//! the limit in the message; and `drift.warp_limit_deg` stops a machine that bends its rods.

use super::panel::{Curve, Shown, failing, guarded};
use super::runs::{refusal, run};
use crate::chart::axis::Axis;
use crate::chart::ink::{Ink, Stroke};
use crate::chart::picture::{Level, Line};
use crate::chart::{ChartError, Size};
use host_sim::sim::Outcome;

const SCENE: &str = r#"
name = "rods"
fidelity = "phased"
[method]
METHOD
[machine]
crank_radius_mm = 10
lambda = 0.25
load_kg = 8
mount_radius_mm = 200
rod_n_per_um = ROD
[limits]
speed_hz = 30
acceleration_hz_per_s = 60
jerk_hz_per_s2 = 1200
homing_speed_hz = 5
[axes]
count = 4
drive = "stepper"
steps_per_turn = 12800
rotor_inertia_kgm2 = 1e-4
damping_nms = 0.2
pull_out = [[0, 20.0], [60, 20.0]]
[drift]
warp_limit_deg = WARP
[[axis]]
number = 0
start_deg = OFF
[[program]]
amax_g = 15
ramp_s = 0.5
hold_s = 0.5
"#;

/// Stiffness of the soft rods, N/µm.
pub const SOFT_N_PER_UM: f64 = 5.0;

/// Returns a scene with rods of a stiffness, an offset of crank 0, and a method.
pub fn scene(rod_n_per_um: f64, off_deg: f64, warp_limit_deg: f64, method: &str) -> String {
    SCENE
        .replace("METHOD", method)
        .replace("ROD", &rod_n_per_um.to_string())
        .replace("OFF", &off_deg.to_string())
        .replace("WARP", &warp_limit_deg.to_string())
}

/// Results for a stiffness.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Stiffness of a rod, N/µm.
    pub rod_n_per_um: f64,
    /// Steps per tick that are chosen for it.
    pub steps: u32,
    /// Greatest torque of the motor of a crank with an offset of 1°, N·m.
    pub off_nm: f64,
    /// The same torque without an offset, N·m.
    pub in_phase_nm: f64,
    /// Cycles that all motors slipped together.
    pub slipped: i64,
}

/// Measured results.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Results by stiffness.
    pub measured: Vec<Measured>,
    /// Stiffness above which one step per tick is refused, N/µm.
    pub refused_from_n_per_um: f64,
}

/// Runs the scenes.
///
/// # Errors
/// A scene does not run.
pub fn measure(size: Size) -> Result<Facts, ChartError> {
    let stiffnesses: &[f64] = match size {
        Size::Small => &[5.0, 50.0, 500.0],
        Size::Full => &[5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0],
    };
    let mut measured = Vec::new();
    for &rod_n_per_um in stiffnesses {
        let off = run(&scene(rod_n_per_um, 1.0, 3.0, ""), &mut |_| {})?;
        let in_phase = run(&scene(rod_n_per_um, 0.0, 3.0, ""), &mut |_| {})?;
        let axes = off.record.axes.iter();
        let torque_nm = |run: &Outcome| run.record.axes[0].torque_worst_nm.unwrap_or(f64::NAN);
        measured.push(Measured {
            rod_n_per_um,
            steps: off.method.map_or(0, |(_, steps)| steps),
            off_nm: torque_nm(&off),
            in_phase_nm: torque_nm(&in_phase),
            slipped: axes.map(|axis| axis.motor_slips.abs()).sum(),
        });
    }
    Ok(Facts {
        measured,
        refused_from_n_per_um: edge(),
    })
}

/// Bisection to a thousandth.
fn edge() -> f64 {
    let refused = |rod: f64| refusal(&scene(rod, 1.0, 3.0, "steps_per_tick = 1")).is_some();
    let (mut taken, mut not) = (SOFT_N_PER_UM, 100.0 * SOFT_N_PER_UM);
    while not / taken > 1.001 {
        let middle = (taken * not).sqrt();
        if refused(middle) {
            not = middle;
        } else {
            taken = middle;
        }
    }
    not
}

pub(super) fn shown(size: Size) -> Result<Shown, ChartError> {
    let facts = measure(size)?;
    let points = |of: fn(&Measured) -> f64| -> Vec<(f64, f64)> {
        facts
            .measured
            .iter()
            .map(|measured| (measured.rod_n_per_um, of(measured)))
            .collect()
    };
    let steps = Line {
        stroke: Stroke::Dotted,
        ..Line::new("", Ink::Black, points(|measured| f64::from(measured.steps)))
    };
    let of = |stiffness: f64| {
        let found = facts
            .measured
            .iter()
            .find(|measured| measured.rod_n_per_um == stiffness);
        found
            .copied()
            .ok_or_else(|| ChartError(format!("no rods of {stiffness} N/µm")))
    };
    let (soft, stiff) = (of(SOFT_N_PER_UM)?, of(10.0 * SOFT_N_PER_UM)?);
    let marked = |mut line: Line| {
        line.marked = true;
        line
    };
    Ok(Shown {
        key: "rods",
        title: "Four cranks, one 1° off, on stiffer rods".to_owned(),
        x: Axis::log("stiffness of a rod, N/µm", 4.0, 600.0),
        y: Axis::log("torque of its motor, N·m; steps a tick", 1.0, 100.0),
        curves: vec![
            Curve::new(
                "torque, 1° off, N·m",
                marked(failing(points(|measured| measured.off_nm))),
            ),
            Curve::new(
                "torque, none off, N·m",
                marked(guarded(points(|measured| measured.in_phase_nm))),
            ),
            Curve::new("steps a tick", steps),
        ],
        levels: vec![Level::at_x(
            facts.refused_from_n_per_um,
            "1 step a tick: refused",
        )],
        says: format!(
            "Rods ten times stiffer raise the torque of the motor whose crank stands 1° off from {:.1} to {:.1} N·m (none off: {:.1}), \
             and the steps a tick from {} to {}; one step a tick is refused from {:.1} N/µm on.",
            soft.off_nm,
            stiff.off_nm,
            stiff.in_phase_nm,
            soft.steps,
            stiff.steps,
            facts.refused_from_n_per_um
        ),
    })
}
