//! Rotors on the shafts of a plant.

use std::sync::Arc;

use super::{Memory, Plant, Shafts};
use crate::drives::Field;
use crate::dynamics::modes::Bound;
use crate::dynamics::{Dynamics, MAX};
use crate::pose::Pose;

/// Rotors on the shafts of a plant.
#[derive(Clone, Debug)]
pub struct PlantRotors {
    rotors_kgm2: Vec<f64>,
    friction_nm: Vec<f64>,
    plant: Arc<dyn Plant>,
    memory: Memory,
    /// Torques that the plant's drive law gives in this tick, N·m. `None` if the plant has no such law.
    law_nm: Option<[f64; MAX]>,
}

impl PlantRotors {
    /// Creates rotors of these inertias, kg·m², with this dry friction, N·m, one an axis.
    pub fn new(rotors_kgm2: Vec<f64>, friction_nm: Vec<f64>, plant: Arc<dyn Plant>) -> Self {
        Self {
            rotors_kgm2,
            friction_nm,
            plant,
            memory: Memory::default(),
            law_nm: None,
        }
    }
}

impl Dynamics for PlantRotors {
    fn rotors_kgm2(&self) -> &[f64] {
        &self.rotors_kgm2
    }

    fn friction_nm(&self, angle: usize) -> f64 {
        self.friction_nm[angle]
    }

    fn positions(&self) -> usize {
        self.plant.positions()
    }

    fn rest(&self, _: &[f64], positions: &mut [f64]) {
        self.plant.rest(positions);
    }

    fn accelerations(
        &self,
        q: &[f64],
        v: &[f64],
        torques_nm: &[f64],
        held: &[bool; MAX],
        a: &mut [f64],
    ) {
        let axes = self.rotors_kgm2.len();
        let shafts = Shafts {
            rotors_kgm2: &self.rotors_kgm2,
            torques_nm: &torques_nm[..axes],
            held: &held[..axes],
        };
        self.plant.accelerations(&shafts, q, v, a);
    }

    fn resistance_nm(&self, i: usize, q: &[f64]) -> Option<f64> {
        self.plant.resistance_nm(i, q)
    }

    fn fastest_mode(&self, rotors: Bound) -> Bound {
        rotors.or(Bound::of_mode(self.plant.fastest_mode()))
    }

    fn pose(&self, q: &[f64], v: &[f64], a: &[f64]) -> Option<Pose> {
        Some(self.plant.moved(q, v, a).pitched())
    }

    fn energy_j(&self, q: &[f64], v: &[f64]) -> f64 {
        self.plant.energy_j(&self.rotors_kgm2, q, v)
    }

    fn begin_tick(&mut self, fields: Option<&[Field]>, q: &[f64], v: &[f64], tick_s: f64) {
        match fields {
            Some(fields) => {
                self.law_nm = self.plant.drive_law(fields, q, v, &mut self.memory, tick_s);
            }
            None => self.memory = Memory::default(),
        }
    }

    fn law_nm(&self) -> Option<[f64; MAX]> {
        self.law_nm
    }
}
