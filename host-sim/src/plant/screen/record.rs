//! Figures of a screen's run: amplitude, resonance and capture.

use std::f64::consts::TAU;

use super::Screen;
use crate::plant::{Figure, Record, Tick};

/// Time for which the shafts must lag at the resonance before it counts as capture, s.
const CAPTURED_S: f64 = 0.5;

/// Figures of a run.
#[derive(Clone, Debug)]
pub struct ScreenRecord {
    band_hz: (f64, f64),
    resonance_nm: f64,
    motor_nm: Option<f64>,
    /// Largest distance of the box from rest, m, and mean speed of the shafts at that time, rev/s.
    worst: (f64, f64),
    /// Largest distance in ticks at constant commanded speed above the band, m.
    working_m: f64,
    captured_ticks: u32,
    captured_hz: Option<(f64, f64)>,
}

impl ScreenRecord {
    pub(super) fn new(screen: &Screen) -> Self {
        Self {
            band_hz: screen.band_hz(),
            resonance_nm: screen.resonance_nm(),
            motor_nm: screen.motor_nm,
            worst: (0.0, 0.0),
            working_m: 0.0,
            captured_ticks: 0,
            captured_hz: None,
        }
    }
}

impl ScreenRecord {
    fn torque_sentence(&self) -> String {
        let enough = format!(
            "{:.0} N·m of each motor are enough to turn steadily at the resonance, with a block lifted in each turn",
            self.resonance_nm
        );
        match self.motor_nm {
            Some(motor_nm) => format!("{enough}; the motors have {motor_nm:.0} N·m."),
            None => format!("{enough}."),
        }
    }
}

impl Record for ScreenRecord {
    fn tick(&mut self, tick: &Tick<'_>) {
        let commanded_hz = tick.omega_rad_s / TAU;
        let n = tick.turns.len();
        let (away_m, actual_hz) = match tick.state {
            Some(state) => (
                state.q[n].hypot(state.q[n + 1]),
                state.v[..n].iter().sum::<f64>() / (n as f64 * TAU),
            ),
            None => (tick.pose.z_m.abs(), commanded_hz),
        };
        if away_m > self.worst.0 {
            self.worst = (away_m, actual_hz);
        }
        if tick.acceleration_rad_s2 == 0.0 && commanded_hz > self.band_hz.1 {
            self.working_m = self.working_m.max(away_m);
        }
        // Capture means that the drives are on, the commanded speed is above the band, and the shafts remain below its upper edge.
        let lags = tick.drives_enabled
            && commanded_hz > self.band_hz.1
            && (0.5 * self.band_hz.0..self.band_hz.1).contains(&actual_hz);
        self.captured_ticks = if lags { self.captured_ticks + 1 } else { 0 };
        if f64::from(self.captured_ticks) * tick.tick_s > CAPTURED_S {
            self.captured_hz = Some((actual_hz, commanded_hz));
        }
    }

    fn figures(&self) -> Vec<Figure> {
        let (worst_m, at_hz) = self.worst;
        let (from_hz, to_hz) = self.band_hz;
        vec![
            Figure {
                key: "displacement_worst_mm",
                value: Some(1e3 * worst_m),
                sentence: format!(
                    "The box moved by at most {:.2} mm from rest, at {at_hz:.2} rev/s of its shafts.",
                    1e3 * worst_m
                ),
            },
            Figure {
                key: "displacement_working_mm",
                value: (self.working_m > 0.0).then_some(1e3 * self.working_m),
                sentence: format!(
                    "At steady speeds above the resonance it moved by at most {:.2} mm.",
                    1e3 * self.working_m
                ),
            },
            Figure {
                key: "resonance_from_hz",
                value: Some(from_hz),
                sentence: format!(
                    "Its resonance forbids {from_hz:.2} to {to_hz:.2} rev/s: it would move by more than twice its throw."
                ),
            },
            Figure {
                key: "resonance_to_hz",
                value: Some(to_hz),
                sentence: String::new(),
            },
            Figure {
                key: "resonance_torque_nm",
                value: Some(self.resonance_nm),
                sentence: self.torque_sentence(),
            },
            Figure {
                key: "captured_hz",
                value: self.captured_hz.map(|(actual_hz, _)| actual_hz),
                sentence: match self.captured_hz {
                    Some((actual_hz, commanded_hz)) => format!(
                        "The resonance captured the shafts: they turned at {actual_hz:.2} rev/s where {commanded_hz:.2} were commanded."
                    ),
                    None => "The resonance did not capture the shafts.".to_owned(),
                },
            },
        ]
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let reserve = self.motor_nm.map(|motor_nm| motor_nm / self.resonance_nm);
        if let Some(reserve) = reserve.filter(|reserve| *reserve < 1.0) {
            warnings.push(format!(
                "The motors have {reserve:.2} of the torque that is enough at the resonance: a slow run-up may be captured there."
            ));
        }
        if let Some((actual_hz, _)) = self.captured_hz {
            warnings.push(format!(
                "The screen was captured at its resonance, at {actual_hz:.2} rev/s: its motors lack torque to pass."
            ));
        }
        warnings
    }
}
