//! Measured acceleration amplitude of the moved part.
//!
//! It is measured at every tick and then held for a turn. So a trace with a row every n-th tick has the peaks, which its rows of the
//! acceleration itself miss.

/// Measured acceleration amplitude: the greatest in a turn of the master, available at the end of the turn.
#[derive(Clone, Copy, Debug)]
pub struct TurnAmplitude {
    turn: f64,
    /// Greatest magnitude in this turn so far; `None` in a turn whose beginning was missed.
    greatest: Option<f64>,
    /// Greatest magnitude of the last whole turn; NaN if there is none.
    measured: f64,
}

impl TurnAmplitude {
    pub const NONE: Self = Self {
        turn: f64::NAN,
        greatest: None,
        measured: f64::NAN,
    };

    /// Amplitude of the last whole turn, 0 at rest, from the speed, phase and acceleration of the next row.
    pub fn measure(&mut self, omega_rad_s: f64, phase_turns: f64, accel_mps2: f64) -> f64 {
        if omega_rad_s == 0.0 {
            *self = Self::NONE;
            return 0.0;
        }
        // Turns are counted from half-way, so that the peak, at phase 0, is in the middle of a turn.
        let (turn, accel) = ((phase_turns + 0.5).floor(), accel_mps2.abs());
        if turn == self.turn {
            self.greatest = self.greatest.map(|greatest| greatest.max(accel));
        } else {
            self.measured = self.greatest.unwrap_or(f64::NAN);
            self.greatest = (!self.turn.is_nan()).then_some(accel);
            self.turn = turn;
        }
        self.measured
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// If this fails, the peak of an incomplete turn counts, or the amplitude is that of a row and not of a turn.
    #[test]
    fn the_amplitude_is_that_of_the_last_whole_turn() {
        let mut amplitude = TurnAmplitude::NONE;
        let mut measured = f64::NAN;
        for tick in 0..8000_u32 {
            let phase_turns = 0.005 * f64::from(tick);
            // A spike in the last turn, which is not whole.
            let spike = if tick == 7998 { 90.0 } else { 1.0 };
            measured =
                amplitude.measure(1.0, phase_turns, -32.25 * spike * (phase_turns * TAU).cos());
        }
        assert!((measured - 32.25).abs() < 1e-9, "{measured}");
        assert_eq!(amplitude.measure(0.0, 40.0, 0.0), 0.0, "at rest");
        let first = amplitude.measure(1.0, 40.1, 30.0);
        assert!(first.is_nan(), "in the first turn it is not known: {first}");
    }
}
