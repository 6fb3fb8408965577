//! Stall: rock that requires more torque than the motor has, on average over a turn, stops the flywheel.
//!
//! Failure: beyond its breakdown slip, the torque of an induction motor falls. So the shaft slows down from turn to turn, until it stops.
//! Guards: the report compares the rock's mean torque with the motor's, and the drive's following-error alarm stops the controller.

use std::f64::consts::TAU;

use super::panel::{Curve, Shown, failing, guarded, requested};
use super::runs::{built_in, check, fault_s, run};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::picture::Level;

/// Peak force of the rock that the crusher of the scene breaks, and of rock that it does not, kN.
pub const BROKEN_KN: f64 = 1310.0;
/// See [`BROKEN_KN`].
pub const HOLDING_KN: f64 = 4000.0;

/// Time, s, and speed of the shaft, rad/s.
pub type Speeds = Vec<(f64, f64)>;

/// One run of the crusher.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Actual speed.
    pub actual: Speeds,
    /// Commanded speed.
    pub commanded: Speeds,
    /// Time of the controller's stop, s; `None` if it did not stop.
    pub stopped_s: Option<f64>,
}

/// Scene `jaw-crusher` with rock of a peak force, kN.
///
/// # Errors
/// There is no such scene.
pub fn scene(rock_kn: f64) -> Result<String, ChartError> {
    let rock = format!("rock_kn = {rock_kn}");
    built_in("jaw-crusher", &[("rock_kn = 1310", &rock)])
}

/// Runs the scene with rock of a peak force.
///
/// # Errors
/// The scene is refused.
pub fn measure(rock_kn: f64) -> Result<Facts, ChartError> {
    let text = scene(rock_kn)?;
    let checked = check(&text)?;
    let tick_s = 1.0 / f64::from(checked.scene.control.tick_hz);
    let (mut actual, mut commanded) = (Speeds::new(), Speeds::new());
    let mut before = 0.0;
    let outcome = run(&text, &mut |now| {
        let ahead = now.ahead_turns[0];
        let actual_hz = now.speed_hz + (ahead - before) / tick_s;
        before = ahead;
        actual.push((now.t_s, TAU * actual_hz));
        commanded.push((now.t_s, TAU * now.speed_hz));
    })?;
    Ok(Facts {
        actual,
        commanded,
        stopped_s: fault_s(&outcome),
    })
}

/// Returns the time from which on the shaft is at rest, s, after it was at speed.
pub fn stands_s(speeds: &Speeds) -> Option<f64> {
    let fast = speeds.iter().position(|(_, speed)| *speed > 20.0)?;
    let stands = speeds[fast..].iter().find(|(_, speed)| *speed < 0.1);
    stands.map(|(t_s, _)| *t_s)
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let (broken, holding) = (measure(BROKEN_KN)?, measure(HOLDING_KN)?);
    let thin = |speeds: &Speeds| -> Speeds {
        speeds
            .iter()
            .copied()
            .filter(|(t_s, _)| (FROM_S..=TO_S).contains(t_s))
            .step_by(10)
            .collect()
    };
    let stopped_s = holding.stopped_s.unwrap_or(f64::NAN);
    let stood_s = stands_s(&holding.actual).unwrap_or(f64::NAN);
    let crushing = |(t_s, _): &&(f64, f64)| *t_s > stopped_s;
    let slowest = thin(&broken.actual);
    let slowest = slowest.iter().filter(crushing).map(|(_, speed)| *speed);
    Ok(Shown {
        key: "stall",
        title: "Stall: a jaw crusher in rock that it does not break".to_owned(),
        x: Axis::linear("time, s", FROM_S, TO_S),
        y: Axis::linear("speed of the shaft, rad/s", 0.0, 30.0),
        curves: vec![
            Curve::new(
                format!("{BROKEN_KN} kN of rock, rad/s"),
                guarded(thin(&broken.actual)),
            ),
            Curve::new(
                format!("{HOLDING_KN} kN, rad/s"),
                failing(thin(&holding.actual)),
            ),
            Curve::new(
                format!("commanded, with {HOLDING_KN} kN, rad/s"),
                requested(thin(&holding.commanded)),
            ),
        ],
        levels: vec![Level::at_x(stopped_s, "fault: stop")],
        says: format!(
            "With {BROKEN_KN} kN of rock the flywheel keeps the shaft above {:.1} rad/s, and with {HOLDING_KN} kN the rock takes more than the motor has on \
             average: the controller stops at {stopped_s:.2} s, and the shaft stands {:.0} ms later.",
            slowest.fold(f64::MAX, f64::min),
            (stood_s - stopped_s) * 1e3
        ),
    })
}

/// Part of the run that is drawn: around the first rock.
const FROM_S: f64 = 7.0;
const TO_S: f64 = 11.0;
