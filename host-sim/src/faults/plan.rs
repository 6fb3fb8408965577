//! When each fault begins and ends, and which of them touch what.

use crate::scene::file::{FaultAt, FaultName, Lines, Scene};
use crate::virtual_time::TICKS_PER_S;

/// A fault with its times, µs since power-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    /// What it is.
    pub fault: FaultAt,
    /// From when.
    pub from_us: u64,
    /// Until when; for good if that never comes.
    pub until_us: u64,
}

impl Planned {
    /// Of a fault of a checked scene.
    pub fn new(fault: &FaultAt) -> Self {
        let clock = |seconds: f64| (seconds * TICKS_PER_S as f64).round() as u64;
        let from_us = match fault.kind {
            // Wires do not swap while they are looked at.
            FaultName::SwappedWiring | FaultName::Reversed => 0,
            _ => clock(fault.at_s),
        };
        Self {
            fault: *fault,
            from_us,
            until_us: fault.for_s.map_or(u64::MAX, |for_s| from_us + clock(for_s)),
        }
    }

    /// Whether it is on at a time.
    pub const fn is_on(&self, at_us: u64) -> bool {
        self.from_us <= at_us && at_us < self.until_us
    }
}

impl FaultAt {
    /// Whether it makes a crank be elsewhere than commanded.
    pub fn moves_crank(&self) -> bool {
        match self.kind {
            FaultName::LostSteps
            | FaultName::Slip
            | FaultName::Stuck
            | FaultName::Runaway
            | FaultName::Reversed
            | FaultName::StepFifoUnderrun => true,
            FaultName::SwappedWiring => self.lines == Some(Lines::Drive),
            _ => false,
        }
    }

    /// Whether it acts between the loop and the drives, or on the cranks.
    pub fn touches_drives(&self) -> bool {
        self.moves_crank() || self.kind == FaultName::LoadStep
    }
}

impl Scene {
    /// The first of its faults that makes a crank be elsewhere than commanded.
    pub fn moving_fault(&self) -> Option<usize> {
        self.fault.iter().position(FaultAt::moves_crank)
    }

    /// Whether the commands of the drives, or the loads of the cranks, differ from those that the loop and the machine give.
    pub fn touches_drives(&self) -> bool {
        self.noise.load_nm != 0.0 || self.fault.iter().any(FaultAt::touches_drives)
    }
}
