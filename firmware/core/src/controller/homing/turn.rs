//! A turn in which homing measures every crank.

use crate::monitor::{DriftMonitor, ErrorFilter};
use crate::units::{AxisSet, MAX_AXES, PerAxis, Turns, nearest};

/// Measurement over a turn of the master. In it every index shows its crank, and the errors of encoders are averaged: a load acts on a crank
/// differently at each angle, so a mean over less would depend on where it began.
#[derive(Clone, Debug)]
pub(super) struct FullTurn {
    /// Axes whose index has shown them.
    shown: AxisSet,
    /// Turns of the master so far, up to one.
    turns: Turns,
    /// Sum of each motor's phase error times share of the turn.
    mean: PerAxis<Turns>,
}

impl FullTurn {
    /// Turn that begins.
    pub const NEW: Self = Self {
        shown: 0,
        turns: Turns::ZERO,
        mean: [Turns::ZERO; MAX_AXES],
    };

    /// Adds a tick in which the master made `speed` turns.
    pub fn add(&mut self, monitor: &DriftMonitor, speed: Turns) {
        self.shown |= monitor.shown();
        if !monitor.has_encoders() {
            return;
        }
        let share = speed.min(Turns::ONE.wrapping_sub(self.turns));
        self.turns = self.turns.wrapping_add(share);
        for (axis, mean) in self.mean.iter_mut().enumerate() {
            if let Some(error) = monitor.motor_error(axis) {
                // The error of the product is below a millionth of the errors.
                let part = (error.to_bits() >> 16).wrapping_mul(share.to_bits() >> 16) >> 16;
                *mean = mean.wrapping_add(Turns::from_bits(part));
            }
        }
    }

    /// True if encoders, where there are any, have been read over the turn.
    pub fn is_averaged(&self, monitor: &DriftMonitor) -> bool {
        !monitor.has_encoders() || self.turns >= Turns::ONE
    }

    /// True if every crank has been measured.
    pub fn is_over(&self, monitor: &DriftMonitor) -> bool {
        monitor.with_index() & !self.shown == 0 && self.is_averaged(monitor)
    }

    /// Phase error of each axis, turns, −½ to ½: by its index, and by its encoder on average.
    #[inline(never)]
    pub fn errors(&self, monitor: &DriftMonitor) -> PerAxis<Turns> {
        let mut errors = monitor.errors(ErrorFilter::None);
        for (axis, (error, &mean)) in errors.iter_mut().zip(&self.mean).enumerate() {
            if let Some(now) = monitor.motor_error(axis) {
                *error = nearest(error.wrapping_sub(now).wrapping_add(mean));
            }
        }
        errors
    }
}
