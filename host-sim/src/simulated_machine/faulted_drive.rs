//! Effect of a [`Disturbance`] on drives and cranks.
//!
//! The loop commands a travel of every drive in each tick, and its disturbance changes that travel. A disturbance without effect leaves
//! every travel as it is, to the last bit.

use super::Rotors;
use crate::axes::{Axes, per_axis};
use crate::drives::Disturbance;
use crate::drives::{SimulatedAxis, Travel};

/// Applies the disturbances of a tick of `tick_s` seconds to the commanded `travel` of each drive, and to the axes.
pub fn disturb(
    axes: &mut [SimulatedAxis],
    travel: &mut Axes<Travel>,
    disturbance: &[Disturbance],
    tick_s: f64,
    energised: bool,
) {
    *travel = per_axis(axes.len(), |i| {
        disturbed(i, axes, travel, &disturbance[i], tick_s, energised)
    });
    for ((axis, travel), disturbance) in axes.iter_mut().zip(travel.iter()).zip(disturbance) {
        axis.disturb(
            travel,
            lost_cycles(axis, disturbance, energised),
            disturbance.stuck,
        );
    }
}

/// Applies the disturbances of a tick to cranks that torque moves.
pub fn disturb_rotors(
    rotors: &mut Rotors,
    axes: &[SimulatedAxis],
    disturbance: &[Disturbance],
    energised: bool,
) {
    for (i, (axis, disturbance)) in axes.iter().zip(disturbance).enumerate() {
        let lost_cycles = lost_cycles(axis, disturbance, energised);
        rotors.fall_back(i, lost_cycles as f64 * axis.cycle_turns().unwrap_or(0.0));
        rotors.load(i, disturbance.load_nm);
        rotors.hold(i, disturbance.stuck);
    }
}

/// Returns the travel of drive `i`, given the travels that are commanded.
fn disturbed(
    i: usize,
    axes: &[SimulatedAxis],
    travel: &[Travel],
    disturbance: &Disturbance,
    tick_s: f64,
    energised: bool,
) -> Travel {
    let undisturbed = Travel {
        slip_turns: if disturbance.stuck {
            0.0
        } else {
            disturbance.slip_turns
        },
        ..travel[i]
    };
    if let Some(speed_hz) = disturbance.runaway_hz.filter(|_| energised) {
        return Travel {
            field_turns: speed_hz * tick_s,
            torque_nm: 0.0,
            ..undisturbed
        };
    }
    let (own, lines) = (&axes[i], &axes[disturbance.from]);
    // A drive converts pulses to travel by its own resolution, whichever axis they are for. A drive that is
    // mounted in the other sense reverses them.
    let scale = if own.drive().kind().takes_pulses() {
        lines.steps_per_turn() / own.drive_steps_per_turn()
    } else {
        1.0
    };
    let turned = own.is_reversed() ^ lines.is_reversed() ^ disturbance.reversed;
    let sign = if turned { -1.0 } else { 1.0 };
    let commanded = &travel[disturbance.from];
    Travel {
        field_turns: sign * scale * disturbance.travel_share * commanded.commanded_turns,
        torque_nm: sign * commanded.torque_nm,
        ..undisturbed
    }
}

/// Returns the electrical cycles by which field and rotor fall back. A servo has none, and a drive that is off has no field to lose.
fn lost_cycles(axis: &SimulatedAxis, disturbance: &Disturbance, energised: bool) -> i64 {
    if energised && axis.cycle_turns().is_some() {
        disturbance.lost_cycles
    } else {
        0
    }
}
