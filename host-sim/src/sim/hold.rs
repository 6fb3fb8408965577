//! Tilt of a platform that the drives hold after a fault.

use cophase_core::supervisor::State;

use super::Moment;
use super::places::Places;
use super::record::Figures;

/// Monitor of a platform that the drives hold in the fault state.
#[derive(Clone, Debug, Default)]
pub struct FaultHold {
    /// True if the drives hold now.
    is_on: bool,
    places: Places,
    /// Ticks since a crank moved.
    still_ticks: u64,
}

impl FaultHold {
    /// Takes in one tick. Returns true if drives that held after a fault have just been switched off.
    pub fn tick(&mut self, moment: &Moment<'_>, figures: &mut Figures) -> bool {
        let is_fault = moment.telemetry.state == State::Fault;
        let was_on = std::mem::replace(&mut self.is_on, is_fault && moment.drives_enabled);
        if self.is_on {
            self.hold(moment, was_on, figures);
        }
        was_on && is_fault && !self.is_on
    }

    #[cold]
    fn hold(&mut self, moment: &Moment<'_>, was_on: bool, figures: &mut Figures) {
        let tilt_mrad = moment.tilt_mrad();
        if !was_on {
            figures.tilt_at_stop_mrad = tilt_mrad;
            figures.tilt_worst_held_mrad = tilt_mrad;
            self.places = Places::new(moment.actual_turns);
            self.still_ticks = 0;
        }
        if let Some((worst_mrad, tilt_mrad)) = figures.tilt_worst_held_mrad.as_mut().zip(tilt_mrad)
        {
            *worst_mrad = worst_mrad.max(tilt_mrad);
        }
        self.still_ticks += 1;
        if self.places.take(moment.actual_turns) {
            self.still_ticks = 0;
        }
    }

    /// True if a crank that the drives should hold has moved in the last `within_ticks` ticks.
    pub const fn moves(&self, within_ticks: u64) -> bool {
        self.is_on && self.still_ticks < within_ticks
    }

    /// True if the drives hold after a fault.
    pub const fn is_on(&self) -> bool {
        self.is_on
    }
}
