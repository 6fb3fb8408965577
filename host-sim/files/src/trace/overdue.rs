//! Measurements of the phase error that are overdue.

use host_sim::checked::Checked;

/// Turns of an axis after its last measurement from which the next one is overdue by a turn: an index is due once a turn.
const OVERDUE_TURNS: f64 = 2.0;

/// Sensor that measures the phase error of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PhaseSensor {
    /// An encoder, at any time.
    Always,
    /// An index sensor: commanded phase at its last pulse, turns. Before the first pulse, the phase at power-up.
    At(Option<f64>),
    /// No sensor.
    Never,
}

impl PhaseSensor {
    /// Returns the sensor of axis `i` at power-up.
    pub fn new(checked: &Checked, i: usize) -> Self {
        let axis = &checked.settings.axes[i];
        match axis.index_turns {
            _ if axis.encoder => Self::Always,
            Some(_) => Self::At(None),
            None => Self::Never,
        }
    }

    /// Takes in a tick that ends at a commanded phase, turns. Returns true if a measurement is overdue then.
    pub fn is_overdue(&mut self, command_turns: f64, has_pulse: bool) -> bool {
        match self {
            Self::Always => false,
            Self::Never => true,
            Self::At(measured) if has_pulse => {
                *measured = Some(command_turns);
                false
            }
            Self::At(measured) => {
                let since = command_turns - *measured.get_or_insert(command_turns);
                since.abs() > OVERDUE_TURNS
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the curve of a stuck crank goes on, or that of a sound one has gaps.
    #[test]
    fn a_measurement_is_overdue_two_turns_after_the_last_pulse() {
        let mut index = PhaseSensor::At(None);
        assert!(!index.is_overdue(100.0, false), "power-up is at any phase");
        assert!(!index.is_overdue(100.9, true));
        assert!(!index.is_overdue(102.8, false));
        assert!(index.is_overdue(103.0, false));
        assert!(index.is_overdue(103.0, false), "and stays so at rest");
        assert!(!index.is_overdue(103.0, true));
        // A machine that jogs backwards passes its flags too.
        assert!(index.is_overdue(100.9, false));
        assert!(!PhaseSensor::Always.is_overdue(500.0, false));
        assert!(PhaseSensor::Never.is_overdue(0.0, false));
    }
}
