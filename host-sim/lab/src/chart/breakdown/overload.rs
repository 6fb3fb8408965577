//! Five-fold overload: of the motors, and of the loop.
//!
//! Failure: under five times their design load, all motors slip together, so the tilt does not show it. Guard: the monitor also limits
//! the common lag; it latches a fault, and all axes stop together. A loop whose ticks take five times their permitted duration ends in
//! a fault, too: an overrun, with all cranks in phase.

use super::panel::{Curve, Shown, failing, guarded};
use super::runs::{fault_s, first_slip_s, run, three_steppers};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::picture::Level;
use host_sim::sim::Outcome;

/// Design load of the motors, kg. It requires a little more than half of their torque.
pub const SIZED_KG: f64 = 4.0;
/// Limit of the common lag, degrees: the default of `drift.common_limit_deg`.
pub const COMMON_LIMIT_DEG: f64 = 15.0;
/// Time from which on the loop of [`slow_loop`] is too slow, s.
pub const SLOW_FROM_S: f64 = 0.9;
/// Control tick, µs.
const TICK_US: u32 = 500;

/// Returns the scene on a model level, with a load.
pub fn scene(model_level: &str, load_kg: f64) -> String {
    three_steppers(
        model_level,
        &[
            ("load_kg = 8", &format!("load_kg = {load_kg}")),
            ("damping_nms = 0.2", "damping_nms = 0.1"),
            ("[[0, 20.0], [60, 20.0]]", "[[0, 2.0], [60, 2.0]]"),
        ],
    )
}

/// Returns the same scene with a loop that takes five ticks for each tick, from the middle of the program on.
pub fn slow_loop() -> String {
    let mut text = scene("kinematic", SIZED_KG);
    for tick in 0..20 {
        let at_s = SLOW_FROM_S + f64::from(tick * 5 * TICK_US) * 1e-6;
        text += &format!("[[late]]\nat_s = {at_s}\nby_us = {}\n", 4 * TICK_US);
    }
    text
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Time, s, and lead of crank 0, degrees.
    pub ahead_deg: Vec<(f64, f64)>,
    /// End of the run.
    pub outcome: Outcome,
}

/// Runs the phased scene.
///
/// # Errors
/// The scene does not run.
pub fn measure(load_kg: f64) -> Result<Facts, ChartError> {
    let mut ahead_deg = Vec::new();
    let outcome = run(&scene("phased", load_kg), &mut |now| {
        ahead_deg.push((now.t_s, now.ahead_turns[0] * 360.0));
    })?;
    Ok(Facts { ahead_deg, outcome })
}

/// Returns the largest ratio of required torque to pull-out torque on the quasi-static model level.
///
/// # Errors
/// The scene does not run.
pub fn torque_used(load_kg: f64) -> Result<f64, ChartError> {
    let outcome = run(&scene("quasi-static", load_kg), &mut |_| {})?;
    let axes = outcome.record.axes.iter();
    Ok(axes
        .filter_map(|axis| axis.pull_out_used)
        .fold(0.0, f64::max))
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let (sized, over) = (measure(SIZED_KG)?, measure(5.0 * SIZED_KG)?);
    let slow = run(&slow_loop(), &mut |_| {})?;
    let thin = |facts: &Facts| facts.ahead_deg.iter().copied().step_by(4).collect();
    let slip_s = first_slip_s(&over.outcome).unwrap_or(f64::NAN);
    let slow_fault_s = fault_s(&slow).unwrap_or(f64::NAN);
    let fault_s = fault_s(&over.outcome).unwrap_or(f64::NAN);
    Ok(Shown {
        key: "overload",
        title: "Five times the load that motors are for".to_owned(),
        x: Axis::linear("time, s", 0.4, 1.05),
        y: Axis::linear("crank ahead of its command, °", -40.0, 10.0),
        curves: vec![
            Curve::new("five-fold load, °", failing(thin(&over))),
            Curve::new("load they are sized for, °", guarded(thin(&sized))),
        ],
        levels: vec![Level::at_x(fault_s, "fault: all stop")],
        says: format!(
            "Sized for {:.0} % of their torque, motors under five times the load slip, together; {:.0} ms later that is a fault; a loop \
             that takes five ticks for each ends in an overrun within {:.1} ms, its cranks {:.0}° apart.",
            100.0 * torque_used(SIZED_KG)?,
            (fault_s - slip_s) * 1e3,
            (slow_fault_s - SLOW_FROM_S) * 1e3,
            slow.record.figures.phase_spread_worst_deg.unwrap_or(0.0)
        ),
    })
}
