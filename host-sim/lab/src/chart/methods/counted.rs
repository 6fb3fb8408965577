//! What a method costs, counted: how often it asks the machine for its rates, or for its input where that is all it
//! needs.

use std::cell::Cell;

use cophase_methods::{Differences, Equations, Linear};
use nalgebra::DMatrix;

/// Equations that count how often they are asked.
pub struct Counted<'a> {
    equations: &'a dyn Equations,
    asked: Cell<u64>,
}

impl<'a> Counted<'a> {
    /// Of equations, not yet asked.
    pub fn new(equations: &'a dyn Equations) -> Self {
        Self {
            equations,
            asked: Cell::new(0),
        }
    }

    /// How often they were asked for their rates; a Jacobian counts as if it were taken by differences.
    pub fn asked(&self) -> u64 {
        self.asked.get()
    }

    fn count(&self, times: u64) {
        self.asked.set(self.asked.get() + times);
    }
}

impl Equations for Counted<'_> {
    fn dimension(&self) -> usize {
        self.equations.dimension()
    }

    fn rates(&self, t_s: f64, y: &[f64], rates: &mut [f64]) {
        self.count(1);
        self.equations.rates(t_s, y, rates);
    }

    fn is_second_order(&self) -> bool {
        self.equations.is_second_order()
    }

    fn jacobian(
        &self,
        t_s: f64,
        y: &[f64],
        differences: &mut Differences,
        jacobian: &mut DMatrix<f64>,
    ) {
        // What it takes by differences, and about what it takes by a formula: a column each, and one to differ from.
        self.count(self.dimension() as u64 + 1);
        self.equations.jacobian(t_s, y, differences, jacobian);
    }

    fn linear(&self) -> Option<&dyn Linear> {
        self.equations.linear().is_some().then_some(self)
    }
}

impl Linear for Counted<'_> {
    fn matrix(&self) -> DMatrix<f64> {
        match self.equations.linear() {
            Some(linear) => linear.matrix(),
            None => DMatrix::zeros(0, 0), // not asked for: `linear` says that there is none
        }
    }

    fn input(&self, t_s: f64, input: &mut [f64]) {
        self.count(1);
        if let Some(linear) = self.equations.linear() {
            linear.input(t_s, input);
        }
    }
}
