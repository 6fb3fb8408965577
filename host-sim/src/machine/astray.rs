//! Drives and cranks that do not do as they are told: what a machine makes of an [`Amiss`].
//!
//! Every drive is told a way to go in each tick; what is wrong with it makes another way of that. From these ways follows
//! where its *field* is: where the motor would have its rotor. The crank is behind its motor by what it has slipped on the
//! shaft. Where torque moves cranks the field leads them; elsewhere the crank is where the field has it, and turns evenly
//! within the tick. A crank that stands, or whose motor has lost its field to the load, drops its way; a stepper is caught
//! again whole electrical cycles off, and a servo goes on from where it stands.

use super::axis::Overload;
use super::index::Passages;
use super::{Rotors, SimulatedAxis, Told};
use crate::axes::{Axes, per_axis};
use crate::faults::Amiss;

/// What has become of the fields and cranks of a machine.
#[derive(Clone, Debug)]
pub struct Astray {
    tick_s: f64,
    cycles: u32,
    /// What each drive's lines told last, turns.
    told: Axes<f64>,
    /// Where each field is, turns since power-up, and what of its way the rotor has dropped.
    field: Axes<f64>,
    dropped: Axes<f64>,
    /// What each crank has slipped on its motor's shaft, turns: positive behind.
    slipped: Axes<f64>,
    stuck: Axes<bool>,
}

impl Astray {
    /// Of axes at power-up, in ticks of so many seconds and cycles.
    pub fn new(axes: &[SimulatedAxis], tick_s: f64, cycles: u32) -> Self {
        let turns: Axes<f64> = axes.iter().map(SimulatedAxis::turns).collect();
        let count = axes.len();
        Self {
            tick_s,
            cycles,
            told: turns.clone(),
            field: turns,
            dropped: per_axis(count, |_| 0.0),
            slipped: per_axis(count, |_| 0.0),
            stuck: per_axis(count, |_| false),
        }
    }

    /// What crank `i` has slipped on its motor's shaft, turns: positive behind.
    pub fn slipped_turns(&self, i: usize) -> f64 {
        self.slipped[i]
    }

    /// Plays a tick in which lines tell `told`, on cranks that torque moves.
    pub fn turn(
        &mut self,
        axes: &mut [SimulatedAxis],
        rotors: &mut Rotors,
        told: &[Told],
        amiss: &[Amiss],
        energised: bool,
        passages: &mut Passages,
    ) {
        let ways = self.ways(axes, told, amiss, energised);
        let lead = per_axis(axes.len(), |i| {
            let lost = self.lose(&axes[i], i, &amiss[i], energised);
            rotors.fall_back(i, lost);
            if lost > 0.0 {
                axes[i].fall_back(lost);
            }
            rotors.load(i, amiss[i].load_nm);
            if amiss[i].stuck || self.stuck[i] {
                rotors.hold(i, amiss[i].stuck);
                self.stuck[i] = amiss[i].stuck;
            }
            self.field[i] += ways[i].turns;
            self.slipped[i] += amiss[i].slip_turns;
            Told {
                turns: self.field[i] - self.slipped[i],
                torque_nm: ways[i].torque_nm,
            }
        });
        rotors.play(&lead, energised);
        for (i, axis) in axes.iter_mut().enumerate() {
            let origin = axis.turns() - axis.travelled_turns();
            let passed = axis.moved_under(rotors.turns(i), lead[i].turns - origin, self.cycles);
            passages.put(i, passed);
        }
    }

    /// Plays a tick in which lines tell `told`, on cranks that are where their motors have them.
    pub fn place(
        &mut self,
        axes: &mut [SimulatedAxis],
        told: &[Told],
        amiss: &[Amiss],
        energised: bool,
        passages: &mut Passages,
    ) {
        let ways = self.ways(axes, told, amiss, energised);
        for (i, axis) in axes.iter_mut().enumerate() {
            let lost = self.lose(axis, i, &amiss[i], energised);
            if lost > 0.0 {
                axis.fall_back(lost);
            }
            // A drive that is off has no field to lead with: its crank stands, and what it was told is forgotten.
            let way = if energised { ways[i].turns } else { 0.0 };
            self.field[i] += way;
            match axis.overload() {
                _ if amiss[i].stuck => self.dropped[i] += way,
                Overload::Driving => self.dropped[i] += way,
                Overload::Driven => self.dropped[i] -= way,
                Overload::None => self.catch(axis, i),
            }
            if !amiss[i].stuck {
                self.slipped[i] += amiss[i].slip_turns;
            }
            let field = self.field[i] - self.slipped[i];
            let origin = axis.turns() - axis.travelled_turns();
            let passed = axis.moved_under(field - self.dropped[i], field - origin, self.cycles);
            passages.put(i, passed);
        }
    }

    /// The way that each motor goes, and the torque that it is told to add.
    fn ways(
        &mut self,
        axes: &[SimulatedAxis],
        told: &[Told],
        amiss: &[Amiss],
        energised: bool,
    ) -> Axes<Told> {
        let by = per_axis(axes.len(), |i| told[i].turns - self.told[i]);
        self.told = told.iter().map(|told| told.turns).collect();
        per_axis(axes.len(), |i| {
            let amiss = &amiss[i];
            if let Some(speed_hz) = amiss.runaway_hz.filter(|_| energised) {
                return Told {
                    turns: speed_hz * self.tick_s,
                    torque_nm: 0.0,
                };
            }
            let (own, lines) = (&axes[i], &axes[amiss.from]);
            // Pulses are counted by whoever hears them, and turned by whoever is mounted the other way round.
            let scale = if own.cycle_turns().is_some() && amiss.from != i {
                lines.steps_per_turn() / own.steps_per_turn()
            } else {
                1.0
            };
            let turned = own.is_reversed() ^ lines.is_reversed() ^ amiss.reversed;
            let sign = if turned { -1.0 } else { 1.0 };
            Told {
                turns: sign * scale * amiss.part * by[amiss.from],
                torque_nm: sign * told[amiss.from].torque_nm,
            }
        })
    }

    /// By how much field and rotor fall back as the tick begins, turns; a drive that is off has no field to lose.
    fn lose(&mut self, axis: &SimulatedAxis, i: usize, amiss: &Amiss, energised: bool) -> f64 {
        let cycle_turns = axis.cycle_turns().filter(|_| energised).unwrap_or(0.0);
        let lost = amiss.lost_cycles as f64 * cycle_turns;
        self.field[i] -= lost;
        lost
    }

    /// The field takes hold of a rotor that has dropped some of its way.
    fn catch(&mut self, axis: &SimulatedAxis, i: usize) {
        let dropped = self.dropped[i];
        if dropped == 0.0 {
            return;
        }
        match axis.cycle_turns() {
            // Of a stepper it is the next field of its kind: those are cycles apart.
            Some(cycle) => self.dropped[i] = (dropped / cycle).round() * cycle,
            None => {
                self.field[i] -= dropped;
                self.dropped[i] = 0.0;
            }
        }
    }
}
