//! Measured acceleration amplitude of the moved part.
//!
//! It is measured at every tick and then held for a turn. So a trace with a row every n-th tick has the peaks, which its rows of the
//! acceleration itself miss.

/// Measured acceleration amplitude: the greatest magnitude in the last whole turn of the master. Until a turn is complete, it is the
/// greatest since the motion began; at rest it is 0.
#[derive(Clone, Copy, Debug)]
pub struct TurnAmplitude {
    /// Number of the present turn; `None` at rest.
    turn: Option<f64>,
    /// Turns that have begun in this motion. The first of them is the first whole one.
    begun: u32,
    /// Greatest magnitude in this turn so far.
    max: f64,
    measured: f64,
}

impl TurnAmplitude {
    pub const AT_REST: Self = Self {
        turn: None,
        begun: 0,
        max: 0.0,
        measured: 0.0,
    };

    /// Returns the amplitude with the speed, phase and acceleration of the next row.
    pub fn measure(&mut self, omega_rad_s: f64, phase_turns: f64, accel_mps2: f64) -> f64 {
        if omega_rad_s == 0.0 {
            *self = Self::AT_REST;
            return 0.0;
        }
        // Turns are counted from half-way, so that the peak, at phase 0, is in the middle of a turn.
        let turn = (phase_turns + 0.5).floor();
        if self.turn.is_some_and(|present| present != turn) {
            self.begun = self.begun.saturating_add(1);
            if self.begun > 1 {
                self.measured = self.max;
            }
            self.max = 0.0;
        }
        self.turn = Some(turn);
        self.max = self.max.max(accel_mps2.abs());
        if self.begun <= 1 {
            self.measured = self.measured.max(self.max);
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
        let mut amplitude = TurnAmplitude::AT_REST;
        let mut measured = 0.0;
        for tick in 0..8000_u32 {
            let phase_turns = 0.005 * f64::from(tick);
            // A spike in the last turn, which is not whole.
            let spike = if tick == 7998 { 90.0 } else { 1.0 };
            measured =
                amplitude.measure(1.0, phase_turns, -32.25 * spike * (phase_turns * TAU).cos());
        }
        assert!((measured - 32.25).abs() < 1e-9, "{measured}");
        assert_eq!(amplitude.measure(0.0, 40.0, 0.0), 0.0, "at rest");
        assert_eq!(amplitude.measure(1.0, 40.1, 30.0), 30.0, "so far");
        assert_eq!(amplitude.measure(1.0, 40.6, 20.0), 30.0, "so far");
    }
}
