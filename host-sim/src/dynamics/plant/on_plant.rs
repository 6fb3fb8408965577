//! Rotors on the shafts of a plant.

use std::sync::Arc;

use super::{Memory, Plant, Shafts};
use crate::dynamics::modes::Bound;
use crate::dynamics::{Body, Dynamics, Field, MOST, PlaneMotion};

/// Rotors on the shafts of a plant.
#[derive(Clone, Debug)]
pub struct OnPlant {
    body: Body,
    plant: Arc<dyn Plant>,
    memory: Memory,
    /// Torques that the plant's drive law gives in this tick, N·m. `None` if the plant has no such law.
    law_nm: Option<[f64; MOST]>,
}

impl OnPlant {
    /// Creates rotors of a body, free to turn.
    pub fn new(body: Body, plant: Arc<dyn Plant>) -> Self {
        Self {
            body,
            plant,
            memory: Memory::default(),
            law_nm: None,
        }
    }
}

impl Dynamics for OnPlant {
    fn body(&self) -> &Body {
        &self.body
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
        held: &[bool; MOST],
        a: &mut [f64],
    ) {
        let axes = self.body.axes();
        let shafts = Shafts {
            body: &self.body,
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

    fn moved(&self, q: &[f64], v: &[f64], a: &[f64]) -> Option<PlaneMotion> {
        Some(self.plant.moved(q, v, a))
    }

    fn energy_j(&self, q: &[f64], v: &[f64]) -> f64 {
        self.plant.energy_j(&self.body, q, v)
    }

    fn begin_tick(&mut self, fields: Option<&[Field]>, q: &[f64], v: &[f64], tick_s: f64) {
        match fields {
            Some(fields) => {
                self.law_nm = self.plant.drive_law(fields, q, v, &mut self.memory, tick_s);
            }
            None => self.memory = Memory::default(),
        }
    }

    fn law_nm(&self) -> Option<[f64; MOST]> {
        self.law_nm
    }
}
