//! Pull-out: one stepper of three is too weak for its stiff bearing.
//!
//! Failure: beyond a quarter of an electrical cycle, its torque falls, and the crank slips by whole cycles. Guards: the drift monitor
//! detects it at the next index pulse, latches a fault and stops all axes. The quasi-static model level shows beforehand that the
//! required torque exceeds the motor's.

use super::panel::{Curve, Shown, failing, guarded};
use super::runs::{fault_s, first_slip_s, run, three_steppers};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::picture::Level;
use host_sim::sim::Outcome;

/// Axis with the stiff bearing.
pub const WEAK_AXIS: usize = 2;
/// Torque of its motor, over that of the others: too weak.
pub const WEAK: f64 = 0.2;
/// Control tick, s.
pub const TICK_S: f64 = 500e-6;
/// Electrical cycles per turn of [`scene`].
const CYCLES: f64 = 50.0;

/// Returns the scene on a model level, with its third motor scaled.
pub fn scene(model_level: &str, scale: f64) -> String {
    let settling = ("[limits]", "[control]\nsettle_s = 0.02\n[limits]");
    let text = three_steppers(model_level, &[settling]);
    format!("{text}[[axis]]\nnumber = {WEAK_AXIS}\nfriction_nm = 3\npull_out_scale = {scale}\n")
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Time, s, and lead of the third crank, electrical cycles.
    pub ahead: Vec<(f64, f64)>,
    /// Time, s, and commanded speed, rev/s.
    pub speeds: Vec<(f64, f64)>,
    /// End of the run.
    pub outcome: Outcome,
}

impl Facts {
    /// Returns the duration of the turn that begins at a time, s.
    pub fn turn_s(&self, from_s: f64) -> f64 {
        let mut turned = 0.0;
        let after = self.speeds.iter().filter(|(t_s, _)| *t_s >= from_s);
        let ticks = after.take_while(|(_, speed_hz)| {
            turned += speed_hz * TICK_S;
            turned < 1.0
        });
        (ticks.count() + 1) as f64 * TICK_S
    }
}

/// Runs the phased scene.
///
/// # Errors
/// The scene does not run.
pub fn measure(scale: f64) -> Result<Facts, ChartError> {
    let (mut ahead, mut speeds) = (Vec::new(), Vec::new());
    let outcome = run(&scene("phased", scale), &mut |now| {
        ahead.push((now.t_s, now.ahead_turns[WEAK_AXIS] * CYCLES));
        speeds.push((now.t_s, now.speed_hz));
    })?;
    Ok(Facts {
        ahead,
        speeds,
        outcome,
    })
}

/// Returns the ratio of required torque to pull-out torque of the third motor on the quasi-static model level.
///
/// # Errors
/// The scene does not run.
pub fn torque_used(scale: f64) -> Result<f64, ChartError> {
    let outcome = run(&scene("quasi-static", scale), &mut |_| {})?;
    Ok(outcome.record.axes[WEAK_AXIS].pull_out_used.unwrap_or(0.0))
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let (weak, strong) = (measure(WEAK)?, measure(1.0)?);
    let thin = |facts: &Facts| facts.ahead.iter().copied().step_by(4).collect();
    let slip_s = first_slip_s(&weak.outcome).unwrap_or(f64::NAN);
    let fault_s = fault_s(&weak.outcome).unwrap_or(f64::NAN);
    let lost = weak.outcome.record.axes[WEAK_AXIS].motor_slips;
    Ok(Shown {
        key: "pull-out",
        title: "Pull-out: one motor of three too weak".to_owned(),
        x: Axis::linear("time, s", 0.4, 1.0),
        y: Axis::linear("crank ahead of its command, electrical cycles", -5.0, 1.0),
        curves: vec![
            Curve::new("a fifth of the others, cycles", failing(thin(&weak))),
            Curve::new("as strong as the others, cycles", guarded(thin(&strong))),
        ],
        levels: vec![Level::at_x(fault_s, "fault: all stop")],
        says: format!(
            "A motor of which {:.1} times the torque that it has is required ({:.2} if it is as strong as the others) loses {} electrical cycles; the \
             drift monitor stops all cranks {:.0} ms after the first.",
            torque_used(WEAK)?,
            torque_used(1.0)?,
            -lost,
            (fault_s - slip_s) * 1e3
        ),
    })
}
