//! Beginning and end of each fault.

use cophase_scene::file::{FaultAt, FaultName};

use crate::virtual_time::TICKS_PER_S;

/// Fault with its times, µs since power-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    /// Fault of the scene.
    pub fault: FaultAt,
    /// Time at which it begins.
    pub from_us: u64,
    /// Time at which it ends; `u64::MAX` if it is permanent.
    pub until_us: u64,
}

impl Planned {
    /// Plans a fault of a checked scene.
    pub fn new(fault: &FaultAt) -> Self {
        let clock = |seconds: f64| (seconds * TICKS_PER_S as f64).round() as u64;
        let from_us = match fault.kind {
            // Wrong wiring is present from power-up on.
            FaultName::SwappedWiring | FaultName::Reversed => 0,
            _ => clock(fault.at_s),
        };
        Self {
            fault: *fault,
            from_us,
            until_us: fault.for_s.map_or(u64::MAX, |for_s| from_us + clock(for_s)),
        }
    }

    /// True if the fault is active at a time.
    pub const fn is_on(&self, at_us: u64) -> bool {
        self.is_on_within(at_us, at_us)
    }

    /// True if the fault is active at any time from `since_us` to `at_us`.
    pub const fn is_on_within(&self, since_us: u64, at_us: u64) -> bool {
        self.from_us <= at_us && since_us < self.until_us
    }
}
