//! Cost of a method as a count: evaluations of the machine's rates, or of its input for a method that needs only
//! that.

use std::cell::Cell;

use cophase_methods::friction::{Contact, DryFriction};
use cophase_methods::{Differences, Equations, Linear};
use nalgebra::DMatrix;

/// Equations that count their evaluations.
pub struct Counted<'a> {
    equations: &'a dyn Equations,
    evaluations: Cell<u64>,
}

impl<'a> Counted<'a> {
    /// Wraps equations, with a count of 0.
    pub fn new(equations: &'a dyn Equations) -> Self {
        Self {
            equations,
            evaluations: Cell::new(0),
        }
    }

    /// Returns the number of evaluations of their rates. A Jacobian counts as if computed by differences.
    pub fn evaluations(&self) -> u64 {
        self.evaluations.get()
    }

    fn count(&self, times: u64) {
        self.evaluations.set(self.evaluations.get() + times);
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
        // Cost by differences: one evaluation for each column, and one as the reference. A formula costs about the same.
        self.count(self.dimension() as u64 + 1);
        self.equations.jacobian(t_s, y, differences, jacobian);
    }

    fn linear(&self) -> Option<&dyn Linear> {
        self.equations.linear().is_some().then_some(self)
    }

    fn friction(&self) -> Option<&dyn DryFriction> {
        self.equations.friction().is_some().then_some(self)
    }
}

impl Counted<'_> {
    fn rubbing(&self) -> &dyn DryFriction {
        let friction = self.equations.friction();
        friction.expect("`friction` returned these equations because there is some")
    }
}

impl DryFriction for Counted<'_> {
    fn speeds(&self) -> &[usize] {
        self.rubbing().speeds()
    }

    fn bounds(&self, y: &[f64], bounds: &mut [[f64; 2]]) {
        self.rubbing().bounds(y, bounds);
    }

    fn rates_with(&self, t_s: f64, y: &[f64], contacts: &[Contact], rates: &mut [f64]) {
        self.count(1);
        self.rubbing().rates_with(t_s, y, contacts, rates);
    }
}

impl Linear for Counted<'_> {
    fn matrix(&self) -> DMatrix<f64> {
        match self.equations.linear() {
            Some(linear) => linear.matrix(),
            None => DMatrix::zeros(0, 0), // not called, because `linear` returns `None`
        }
    }

    fn input(&self, t_s: f64, input: &mut [f64]) {
        self.count(1);
        if let Some(linear) = self.equations.linear() {
            linear.input(t_s, input);
        }
    }
}
