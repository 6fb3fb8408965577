//! Largest tilt of a platform after a fault: the limit, plus what the kind of fault can add until all cranks stand. Where torque moves the
//! cranks, the bound ends when the drives are off, because nothing holds the cranks together then.
//!
//! Up to the limit L nothing need be reported. A crank beyond the limit is detected within a turn, or two in homing, and three ticks. Then
//! the machine stops, within its stop limits. Meanwhile the crank moves on by an angle e, which depends on the kind of fault. One crank that is off by e,
//! against all others in phase, tilts the platform by at most g(e), computed with true geometry at the worst crank angle
//! ([`Geometry::worst_tilt_mrad`]). Half a turn is the largest possible error of a crank. The bound is L + g(e):
//!
//! | kind | e |
//! | --- | --- |
//! | lost steps | the cycles, at once |
//! | slip | rate × (turns to show it + three ticks + stop), or rate × duration of the slip |
//! | stuck, runaway, reversed | ½ |
//! | underrun | the travel of two ticks |
//! | swapped wiring | the travel by which homing moves a crank to prove the wiring: at most the error that one crank may have |
//! | all others | 0: no crank moves |
//!
//! Some faults take other cranks out of step as well, on model levels where torque moves the cranks: a crank that is stuck, runs away or
//! is loaded, and drives that are cut. The platform transmits the load to the other motors, and these lose their steps, too. Then the
//! bound is the greatest tilt for any positions of the cranks ([`Geometry::any_tilt_mrad`]).
//!
//! On these levels the loads move the cranks apart, too. This module does not compute the distance, and uses the largest possible
//! value. A stepper's rotor is at most a quarter of an electrical cycle from its commanded position, or it loses the cycle. So e is
//! larger by two of these quarters, one ahead and one behind.

use cophase_scene::file::{FaultAt, FaultName, Limits, Scene};
use host_sim::drives::DriveModel;

use super::geometry::Geometry;
use super::watch::Place;

/// Returns the largest allowed tilt, mrad. `beyond_limit` is the place where the crank passed its limit, if it did.
pub fn tilt_mrad(scene: &Scene, geometry: &Geometry, beyond_limit: Option<&Place>) -> f64 {
    let limit_mrad = scene.drift.tilt_limit_mrad;
    let torque_turns = torque_turns(scene);
    let grows = match (scene.fault.first(), beyond_limit) {
        (Some(fault), Some(_)) if torque_turns > 0.0 && overloads(fault.kind) => {
            return geometry.any_tilt_mrad();
        }
        (Some(fault), Some(beyond_limit)) => growth_turns(scene, geometry, fault, beyond_limit),
        _ => 0.0,
    };
    let error = (grows + torque_turns).min(0.5);
    if error == 0.0 {
        return limit_mrad;
    }
    limit_mrad + geometry.worst_tilt_mrad(error)
}

/// Largest distance of cranks that their loads can cause, turns. It is 0 on model levels where torque does not move the cranks.
pub(super) fn torque_turns(scene: &Scene) -> f64 {
    if scene.fidelity.moves_by_torque() {
        lag_turns(scene)
    } else {
        0.0
    }
}

/// Returns true if a kind overloads the other motors where torque moves the cranks, so that they lose their steps, too.
const fn overloads(kind: FaultName) -> bool {
    matches!(
        kind,
        FaultName::Stuck | FaultName::Runaway | FaultName::LoadStep | FaultName::EnableLoss
    )
}

/// Travel of a crank after it passed its limit, turns.
fn growth_turns(scene: &Scene, geometry: &Geometry, fault: &FaultAt, beyond_limit: &Place) -> f64 {
    let tick_s = 1.0 / f64::from(scene.control.tick_hz);
    match fault.kind {
        FaultName::LostSteps => {
            let cycles = fault.cycles.unwrap_or(1).unsigned_abs() as f64;
            let motor_turns = scene.resolved(fault.axis.unwrap_or_default()).gear.ratio();
            cycles * 4.0 / f64::from(scene.axes.full_steps_per_turn) / motor_turns
        }
        FaultName::Slip => {
            let rate = fault.rate_deg_per_s.unwrap_or_default().abs() / 360.0;
            let until_s = beyond_limit.turns_to_show() * turn_s(&scene.limits, beyond_limit)
                + super::DETECTION_TICKS as f64 * tick_s
                + stop_s(&scene.limits, beyond_limit);
            rate * until_s.min(fault.for_s.unwrap_or(f64::INFINITY))
        }
        FaultName::Stuck | FaultName::Runaway | FaultName::Reversed => 0.5,
        FaultName::StepFifoUnderrun => 2.0 * beyond_limit.speed_hz * tick_s,
        FaultName::SwappedWiring => geometry.single_limit_turns(),
        FaultName::IndexMissing
        | FaultName::IndexExtra
        | FaultName::EncoderGlitch
        | FaultName::DriveAlarm
        | FaultName::Overrun
        | FaultName::EnableLoss
        | FaultName::StopInput
        | FaultName::LoadStep => 0.0,
    }
}

/// Two quarters of an electrical cycle, one ahead and one behind, turns. For a servo it is its following-error window in either direction,
/// or the same as for a stepper if it has no window.
fn lag_turns(scene: &Scene) -> f64 {
    let axes = &scene.axes;
    match (DriveModel::for_drive(axes.drive).window_deg)(axes) {
        Some(window_deg) => 2.0 * window_deg / 360.0,
        None => 2.0 / f64::from(axes.full_steps_per_turn) / scene.resolved(0).gear.ratio(),
    }
}

/// Largest duration of the master's next turn, s: at its present speed or at homing speed, whichever is higher, plus the time to reach
/// homing speed. A master that comes to rest before is in a stop, whose duration is computed separately.
fn turn_s(limits: &Limits, beyond_limit: &Place) -> f64 {
    1.0 / beyond_limit.speed_hz.max(limits.homing_speed_hz)
        + limits.homing_speed_hz / limits.acceleration_hz_per_s
}

/// Duration of a stop, s. The present acceleration must first fall to zero, and the speed rises meanwhile. Then the deceleration is built
/// up, held if there is time, and released. In the turn before the stop the speed may have risen, up to the limit.
fn stop_s(limits: &Limits, beyond_limit: &Place) -> f64 {
    let usual = (limits.acceleration_hz_per_s, limits.jerk_hz_per_s2);
    let a = limits.stop_acceleration_hz_per_s.unwrap_or(usual.0);
    let j = limits.stop_jerk_hz_per_s2.unwrap_or(usual.1);
    let turn_s = turn_s(limits, beyond_limit);
    let max_hz = (beyond_limit.speed_hz + usual.0 * turn_s).min(limits.speed_hz);
    let rising = usual.0;
    let from_hz = max_hz + rising * rising / (2.0 * j);
    let ramp_s = if from_hz * j >= a * a {
        from_hz / a + a / j
    } else {
        2.0 * (from_hz / j).sqrt()
    };
    rising / j + ramp_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_core::supervisor::State;
    use cophase_scene::library;

    fn place(speed_hz: f64) -> Place {
        Place {
            moment: 0,
            t_s: 0.0,
            turns: 0.0,
            speed_hz,
            acceleration_hz_per_s: 0.0,
            state: State::Run,
        }
    }

    /// If this fails, the computed stop is too short, and a slip exceeds its bound. From 22 rev/s, at 25 rev/s² and 250 rev/s³, the present
    /// acceleration takes 0.1 s to end and adds 1.25 rev/s. Then the deceleration takes 23.25/25 s, and 0.1 s for its ends.
    #[test]
    fn the_stop_time_follows_from_acceleration_and_jerk_limits() {
        let scene = library::find("default").unwrap().scene();
        let stop_s = stop_s(&scene.limits, &place(22.0));
        assert!(
            (stop_s - (0.1 + 23.25 / 25.0 + 0.1)).abs() < 1e-12,
            "{stop_s}"
        );
    }

    /// If this fails, the bound is too wide for a fault that moves no crank.
    #[test]
    fn the_bound_is_the_limit_where_no_crank_moves() {
        let scene = library::find("default").unwrap().scene();
        let geometry = Geometry::new(&scene).unwrap();
        let mut kinematic = scene.clone();
        kinematic.fidelity = cophase_scene::file::Fidelity::Kinematic;
        assert_eq!(tilt_mrad(&kinematic, &geometry, Some(&place(10.0))), 3.0);
    }
}
