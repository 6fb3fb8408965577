//! Drives and cranks that do not follow their commands: the effect of a [`Disturbance`] on a machine.
//!
//! The loop commands a travel of every drive in each tick, and its disturbance changes that travel. The result moves the
//! *field*: the position at which the motor would hold its rotor. The crank is behind its motor by the slip on the shaft.
//! If torque moves the cranks, the field leads them. Otherwise the crank is at the position of the field, and turns evenly
//! within the tick. A crank that is stuck, or whose motor has lost its field to the load, does not make its travel. A
//! stepper then locks again whole electrical cycles off, and a servo continues from the position at which it stands.

use super::axis::Overload;
use super::index::Passages;
use super::{DriveCommand, Rotors, SimulatedAxis};
use crate::axes::{Axes, per_axis};
use crate::faults::Disturbance;

/// State of the fields and cranks of a machine under disturbances.
#[derive(Clone, Debug)]
pub struct FaultedDrives {
    tick_s: f64,
    cycles: u32,
    /// Last command on the lines of each drive, turns.
    commanded: Axes<f64>,
    /// Position of each field, turns since power-up.
    field: Axes<f64>,
    /// Travel of the field that the rotor has not made, turns; negative if the load drove the rotor further.
    dropped: Axes<f64>,
    /// Slip of each crank on its motor's shaft, turns: positive behind.
    slipped: Axes<f64>,
    stuck: Axes<bool>,
}

impl FaultedDrives {
    /// Creates the state of axes at power-up, for ticks of `tick_s` seconds and `cycles` cycles.
    pub fn new(axes: &[SimulatedAxis], tick_s: f64, cycles: u32) -> Self {
        let turns: Axes<f64> = axes.iter().map(SimulatedAxis::turns).collect();
        let count = axes.len();
        Self {
            tick_s,
            cycles,
            commanded: turns.clone(),
            field: turns,
            dropped: per_axis(count, |_| 0.0),
            slipped: per_axis(count, |_| 0.0),
            stuck: per_axis(count, |_| false),
        }
    }

    /// Slip of crank `i` on its motor's shaft, turns: positive behind.
    pub fn slipped_turns(&self, i: usize) -> f64 {
        self.slipped[i]
    }

    /// Plays a tick in which the lines carry `commanded`, on cranks that torque moves.
    pub fn turn(
        &mut self,
        axes: &mut [SimulatedAxis],
        rotors: &mut Rotors,
        commanded: &[DriveCommand],
        disturbance: &[Disturbance],
        energised: bool,
        passages: &mut Passages,
    ) {
        let drive_commands = self.drive_commands(axes, commanded, disturbance, energised);
        let lead = per_axis(axes.len(), |i| {
            let lost = self.lose(&axes[i], i, &disturbance[i], energised);
            rotors.fall_back(i, lost);
            if lost > 0.0 {
                axes[i].fall_back(lost);
            }
            rotors.load(i, disturbance[i].load_nm);
            if disturbance[i].stuck || self.stuck[i] {
                rotors.hold(i, disturbance[i].stuck);
                self.stuck[i] = disturbance[i].stuck;
            }
            self.field[i] += drive_commands[i].turns;
            self.slipped[i] += disturbance[i].slip_turns;
            DriveCommand {
                turns: self.field[i] - self.slipped[i],
                torque_nm: drive_commands[i].torque_nm,
            }
        });
        rotors.play(&lead, energised);
        for (i, axis) in axes.iter_mut().enumerate() {
            let origin = axis.turns() - axis.travelled_turns();
            let turns = rotors.turns(i);
            let passed = axis.moved_under(turns, lead[i].turns - origin, self.cycles, energised);
            passages.put(i, passed);
            if axis.drive().follows_rotor(energised) {
                self.field[i] = turns + self.slipped[i];
                rotors.clear(i);
            }
        }
    }

    /// Plays a tick in which the lines carry `commanded`, on cranks that are at the positions of their motors.
    pub fn place(
        &mut self,
        axes: &mut [SimulatedAxis],
        commanded: &[DriveCommand],
        disturbance: &[Disturbance],
        energised: bool,
        passages: &mut Passages,
    ) {
        let drive_commands = self.drive_commands(axes, commanded, disturbance, energised);
        for (i, axis) in axes.iter_mut().enumerate() {
            let lost = self.lose(axis, i, &disturbance[i], energised);
            if lost > 0.0 {
                axis.fall_back(lost);
            }
            // A drive that is off has no field: its crank stands, and its command is discarded.
            let moved = if energised {
                drive_commands[i].turns
            } else {
                0.0
            };
            self.field[i] += moved;
            match axis.overload() {
                _ if disturbance[i].stuck => self.dropped[i] += moved,
                Overload::Driving => self.dropped[i] += moved,
                Overload::Driven => self.dropped[i] -= moved,
                Overload::None => self.catch(axis, i),
            }
            if !disturbance[i].stuck {
                self.slipped[i] += disturbance[i].slip_turns;
            }
            let field = self.field[i] - self.slipped[i];
            let origin = axis.turns() - axis.travelled_turns();
            let turns = field - self.dropped[i];
            let passed = axis.moved_under(turns, field - origin, self.cycles, energised);
            passages.put(i, passed);
        }
    }

    /// Returns the travel of each motor, and the torque that it is commanded to add.
    fn drive_commands(
        &mut self,
        axes: &[SimulatedAxis],
        commanded: &[DriveCommand],
        disturbance: &[Disturbance],
        energised: bool,
    ) -> Axes<DriveCommand> {
        let by = per_axis(axes.len(), |i| commanded[i].turns - self.commanded[i]);
        for (before, commanded) in self.commanded.iter_mut().zip(commanded) {
            *before = commanded.turns;
        }
        per_axis(axes.len(), |i| {
            let disturbance = &disturbance[i];
            if let Some(speed_hz) = disturbance.runaway_hz.filter(|_| energised) {
                return DriveCommand {
                    turns: speed_hz * self.tick_s,
                    torque_nm: 0.0,
                };
            }
            let (own, lines) = (&axes[i], &axes[disturbance.from]);
            // A drive converts pulses to travel by its own resolution, whichever axis they are for. A drive that is
            // mounted in the other sense reverses them.
            let scale = if own.drive().takes_pulses() && disturbance.from != i {
                lines.steps_per_turn() / own.steps_per_turn()
            } else {
                1.0
            };
            let turned = own.is_reversed() ^ lines.is_reversed() ^ disturbance.reversed;
            let sign = if turned { -1.0 } else { 1.0 };
            DriveCommand {
                turns: sign * scale * disturbance.travel_share * by[disturbance.from],
                torque_nm: sign * commanded[disturbance.from].torque_nm,
            }
        })
    }

    /// Makes the field fall back by the lost cycles. Returns the same travel for the rotor, turns. A drive that is off has
    /// no field to lose.
    fn lose(
        &mut self,
        axis: &SimulatedAxis,
        i: usize,
        disturbance: &Disturbance,
        energised: bool,
    ) -> f64 {
        let cycle_turns = axis.cycle_turns().filter(|_| energised).unwrap_or(0.0);
        let lost = disturbance.lost_cycles as f64 * cycle_turns;
        self.field[i] -= lost;
        lost
    }

    /// Locks the field again to a rotor that has not made all of its travel.
    fn catch(&mut self, axis: &SimulatedAxis, i: usize) {
        let dropped = self.dropped[i];
        if dropped == 0.0 {
            return;
        }
        match axis.cycle_turns() {
            // A stepper locks to the nearest equivalent position of its field: these are whole cycles apart.
            Some(cycle) => self.dropped[i] = (dropped / cycle).round() * cycle,
            None => {
                self.field[i] -= dropped;
                self.dropped[i] = 0.0;
            }
        }
    }
}
