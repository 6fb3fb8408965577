//! Motion of an axis by its encoder, and the name of the fault that it shows.

use super::AxisWatch;
use crate::drift::detection::angles::angle;
use crate::drift::sensing::encoder_watch::Tracking;
use crate::supervisor::FaultKind;
use crate::units::Turns;

impl AxisWatch {
    /// Name of the fault that moved this axis in the last turns, or moves it now, if it is known.
    pub(in crate::drift) fn name(&self) -> Option<FaultKind> {
        self.tracking().or(self.diagnosis.name())
    }

    /// Name of the motor's motion, if that is the cause of its phase error.
    pub(in crate::drift) fn tracking(&self) -> Option<FaultKind> {
        let encoder = self.encoder.as_ref()?;
        let traits = &self.traits;
        if !traits.is_beyond_gate(angle(encoder.phase_error)) {
            return None;
        }
        match encoder.tracking {
            Tracking::Ok => None,
            Tracking::Stalled if encoder.has_gone_back(traits) => Some(FaultKind::Reversed),
            Tracking::Stalled => Some(FaultKind::Stuck),
            Tracking::Overspeed => Some(FaultKind::Runaway),
        }
    }

    /// Phase error of the motor by its encoder.
    pub(in crate::drift) fn tracking_error(&self) -> Option<Turns> {
        self.encoder.as_ref().map(|encoder| encoder.phase_error)
    }

    /// True if its encoder alone shows that the axis does not turn as commanded.
    pub(in crate::drift) fn is_off_track(&self) -> bool {
        self.tracking_error()
            .is_some_and(|error| error.wrapping_abs() > self.traits.alone)
    }
}
