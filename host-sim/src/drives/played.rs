//! Output of the loop as the machine plays it. Each plan of pulses is stored once, for all axes that
//! share it.

use cophase_core::pulse::{Runs, Sharing};
use cophase_core::servo::Setpoint;
use cophase_core::signals::Output;

use super::pulse_counter::Tally;
use crate::axes::{Axes, per_axis};

/// Pulses and setpoints of all axes in one tick.
#[derive(Clone, Debug)]
pub struct Played {
    /// Plans of pulses, each at the index of the first axis that plays it.
    plans: Axes<Runs>,
    sharing: Sharing,
    /// Setpoints, for servo axes.
    pub setpoints: Axes<Setpoint>,
}

impl Played {
    /// Creates an output without pulses and setpoints, with room for the pulses of `count` axes.
    pub fn nothing(count: usize) -> Self {
        Self {
            plans: per_axis(count, |_| Runs::new()),
            sharing: Sharing::NONE,
            setpoints: per_axis(count, |_| Setpoint::default()),
        }
    }

    /// Returns the pulses of an axis, if it takes pulses.
    pub fn runs(&self, axis: usize) -> &Runs {
        &self.plans[self.sharing.first(axis)]
    }

    /// Returns the plans of all axes, for the drives that play them.
    pub fn plans(&self) -> Plans<'_> {
        Plans {
            played: self,
            first: 0,
            last: Plan::new(&self.plans[0]),
        }
    }

    /// Takes over an output, and reuses the memory of the one before.
    pub fn copy_from(&mut self, output: &Output) {
        self.sharing = output.sharing();
        for (axis, plan) in self.plans.iter_mut().enumerate() {
            if self.sharing.first(axis) == axis {
                plan.copy_from(output.runs(axis));
            }
        }
        let count = self.setpoints.len();
        self.setpoints.copy_from_slice(&output.setpoints[..count]);
    }
}

/// Plans of the axes in a tick, one after the other.
pub struct Plans<'a> {
    played: &'a Played,
    /// First axis that plays the plan returned last, which is in `last`. The next axis mostly plays
    /// the same plan.
    first: usize,
    last: Plan<'a>,
}

impl<'a> Plans<'a> {
    /// Returns the plan of an axis.
    #[inline]
    pub fn of(&mut self, axis: usize) -> &mut Plan<'a> {
        let first = self.played.sharing.first(axis);
        if first != self.first {
            self.first = first;
            self.last = Plan::new(&self.played.plans[first]);
        }
        &mut self.last
    }
}

/// Plan of pulses of one tick, and the count of a drive that has played it.
#[derive(Debug)]
pub struct Plan<'a> {
    /// Pulses of the plan.
    pub runs: &'a Runs,
    /// Result of counting the pulses, once a drive has counted them.
    pub tally: Option<Tally>,
}

impl<'a> Plan<'a> {
    /// Creates a plan that no drive has played.
    pub const fn new(runs: &'a Runs) -> Self {
        Self { runs, tally: None }
    }
}
