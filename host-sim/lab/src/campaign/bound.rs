//! How far a platform may tilt after a fault, at most: the limit, and what the kind can add until all cranks stand, or the drives are
//! off and torque moves the cranks: then nothing holds them together.
//!
//! Up to the limit L nothing need be reported. A crank that has passed it is detected within a turn and N + 5 ticks, and the stop takes
//! what the stop limits make of it; in that time the crank goes on as its kind has it. What it goes on by, e, tilts the platform
//! by g(e) at most, true geometry at the worst crank angle, one crank against all others in phase ([`Geometry::worst_tilt_mrad`]);
//! half a turn is the most that a crank can be off. The bound is L + g(e):
//!
//! | kind | e |
//! | --- | --- |
//! | lost steps | the cycles, at once |
//! | slip | rate × (turn + N + 5 ticks + stop), or rate × how long it goes on |
//! | stuck, runaway, reversed | ½ |
//! | underrun | the way of two ticks |
//! | swapped wiring | what homing trims a crank by to prove it: as far as a crank may be off |
//! | all others | 0: no crank moves |
//!
//! Where torque moves cranks, and a crank is stuck, runs away, or is loaded, or nothing drives them any more, it is not one crank
//! against all others: the platform hands on what holds one of them, and the others lose their steps as well. Then the bound is the
//! greatest tilt that any cranks make ([`Geometry::any_tilt_mrad`]).
//!
//! Where torque moves cranks they are apart by what their loads do to them too; how much, is not in this bound: steppers' rotors
//! are at most a quarter of their electrical cycle from where commanded, or they lose it, so that e is larger by two of
//! these, one ahead and one behind.

use host_sim::scene::file::{Drive, FaultAt, FaultName, Limits, Scene};

use super::geometry::Geometry;
use super::watch::Place;

/// The most that the platform may tilt, mrad; `beyond_limit` is where the crank passed its limit, if it did.
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

/// How far cranks may be apart by their loads, turns: 0 where they are where their motors have them.
pub(super) fn torque_turns(scene: &Scene) -> f64 {
    if scene.fidelity.moves_by_torque() {
        lag_turns(scene)
    } else {
        0.0
    }
}

/// Whether a kind asks more of the other motors than they have, where torque moves cranks: then these lose their steps too.
const fn overloads(kind: FaultName) -> bool {
    matches!(
        kind,
        FaultName::Stuck | FaultName::Runaway | FaultName::LoadStep | FaultName::EnableLoss
    )
}

/// How far a crank goes on, turns, after it was beyond its limit.
fn growth_turns(scene: &Scene, geometry: &Geometry, fault: &FaultAt, beyond_limit: &Place) -> f64 {
    let tick_s = 1.0 / f64::from(scene.control.tick_hz);
    match fault.kind {
        FaultName::LostSteps => {
            let cycles = fault.cycles.unwrap_or(1).unsigned_abs() as f64;
            cycles * 4.0 / f64::from(scene.axes.full_steps_per_turn)
        }
        FaultName::Slip => {
            let rate = fault.rate_deg_per_s.unwrap_or_default().abs() / 360.0;
            let until_s = turn_s(&scene.limits, beyond_limit)
                + super::detection_ticks(scene.axes.count) as f64 * tick_s
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

/// Two quarters of an electrical cycle, one ahead and one behind; of a servo, its following-error window either way, or as much as of
/// a stepper.
fn lag_turns(scene: &Scene) -> f64 {
    let axes = &scene.axes;
    let servo = axes.servo.filter(|_| axes.drive != Drive::Stepper);
    match servo.and_then(|servo| servo.following_error_deg) {
        Some(window_deg) => 2.0 * window_deg / 360.0,
        None => 2.0 / f64::from(axes.full_steps_per_turn),
    }
}

/// How long the master's next turn takes at most: at the speed that it has, or at homing speed. One that comes to rest before is a stop,
/// which is computed for itself.
fn turn_s(limits: &Limits, beyond_limit: &Place) -> f64 {
    1.0 / beyond_limit.speed_hz.max(limits.homing_speed_hz)
        + limits.homing_speed_hz / limits.acceleration_hz_per_s
}

/// How long the stop takes: the acceleration that there is must go first, and adds to the speed as it goes; then acceleration is
/// built up, held if there is time, and let go. Speed may have grown, in the turn before the stop, up to the limit.
fn stop_s(limits: &Limits, beyond_limit: &Place) -> f64 {
    let usual = (limits.acceleration_hz_per_s, limits.jerk_hz_per_s2);
    let a = limits.stop_acceleration_hz_per_s.unwrap_or(usual.0);
    let j = limits.stop_jerk_hz_per_s2.unwrap_or(usual.1);
    let turn_s = turn_s(limits, beyond_limit);
    let most_hz = (beyond_limit.speed_hz + usual.0 * turn_s).min(limits.speed_hz);
    let rising = usual.0;
    let from_hz = most_hz + rising * rising / (2.0 * j);
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
    use host_sim::scene::library;

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

    /// Were a stop's time computed too short, a slip would go on beyond its bound. 60 rev/s at 60 rev/s² and 600 rev/s³: 1 s of
    /// acceleration and 0.1 s for its ends; before it, 0.1 s in which what there is of acceleration goes and adds 3 rev/s.
    #[test]
    fn a_stop_takes_what_its_limits_make_of_it() {
        let scene = library::find("default").unwrap().scene();
        let stop_s = stop_s(&scene.limits, &place(60.0));
        assert!(
            (stop_s - (0.1 + 63.0 / 60.0 + 0.1)).abs() < 1e-12,
            "{stop_s}"
        );
    }

    /// A fault in which nothing moves may add nothing.
    #[test]
    fn the_bound_is_the_limit_where_no_crank_moves() {
        let scene = library::find("default").unwrap().scene();
        let geometry = Geometry::new(&scene).unwrap();
        let mut kinematic = scene.clone();
        kinematic.fidelity = host_sim::scene::file::Fidelity::Kinematic;
        assert_eq!(tilt_mrad(&kinematic, &geometry, Some(&place(10.0))), 3.0);
    }
}
