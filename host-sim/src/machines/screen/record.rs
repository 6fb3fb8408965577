//! Figures of a screen's run: displacement of the box, its resonances, and capture.

use std::f64::consts::TAU;

use cophase_core::supervisor::FaultKind;

use super::{Screen, Sufficient};
use crate::dynamics::plant::{Figure, Record, Tick};

/// Fraction of the common limit of phase errors by which shafts that are captured have fallen behind. It is that of the controller's
/// fault `capture` (`docs/faults.md`).
const BEHIND: f64 = 0.75;

/// Speeds of the shafts and of their command, rev/s.
#[derive(Clone, Copy, Debug)]
struct Held {
    actual_hz: f64,
    commanded_hz: f64,
}

/// Detection of capture. Shafts are *captured* if they enter a forbidden band, fall behind their command by [`BEHIND`] in it, and
/// have not left it at its upper edge when the command begins to come down, or at the end of the run. What the controller stops as a
/// `capture` is one too: it has only the pulses of its sensors to judge by, and does not wait.
#[derive(Clone, Debug)]
struct CaptureWatch {
    bands_hz: Vec<(f64, f64)>,
    behind_turns: f64,
    /// Band in which the shafts are, and their lag behind the command as they entered it, turns.
    entered: Option<(usize, f64)>,
    /// Last speeds at which the shafts were behind in a band, as long as they have not passed it.
    held: Option<Held>,
    captured: Option<Held>,
    /// Speeds as the command began to come down the last time.
    at_stop: Option<Held>,
    was_rising: bool,
}

impl CaptureWatch {
    fn tick(&mut self, tick: &Tick<'_>, speeds: Held, lag_turns: f64) {
        let rises = tick.drives_enabled && tick.acceleration_rad_s2 >= 0.0;
        if self.was_rising && !rises {
            self.at_stop = Some(speeds);
        }
        self.was_rising = rises;
        if !rises {
            self.captured = self.captured.or(self.held.take());
        }
        let actual_hz = speeds.actual_hz;
        let is_within = |&(from_hz, to_hz): &(f64, f64)| (from_hz..=to_hz).contains(&actual_hz);
        let Some(band) = self.bands_hz.iter().position(is_within) else {
            let passed = |(band, _): (usize, f64)| actual_hz > self.bands_hz[band].1;
            if self.entered.take().is_some_and(passed) {
                self.held = None;
            }
            return;
        };
        let entered = self.entered.filter(|(entered, _)| *entered == band);
        let (_, lag_before) = *self.entered.insert(entered.unwrap_or((band, lag_turns)));
        let is_commanded = speeds.commanded_hz >= self.bands_hz[band].0;
        if rises && is_commanded && lag_turns - lag_before > self.behind_turns {
            self.held = Some(speeds);
        }
    }

    fn captured(&self) -> Option<Held> {
        self.captured.or(self.held)
    }
}

/// Figures of a run.
#[derive(Clone, Debug)]
pub struct ScreenRecord {
    sufficient: Sufficient,
    /// Distance of the ends of the box from its centre, m.
    ends_m: f64,
    excites_pitch: bool,
    /// Largest distance of a point of the box from rest, m, and mean speed of the shafts at that time, rev/s.
    worst: (f64, f64),
    pitch_rad: f64,
    /// Largest distance in ticks at constant commanded speed, with command and shafts above the bands, m.
    working_m: f64,
    capture: CaptureWatch,
}

impl ScreenRecord {
    pub(super) fn new(screen: &Screen) -> Self {
        Self {
            sufficient: screen.sufficient,
            ends_m: screen.springs_m,
            excites_pitch: screen.excites_pitch(),
            worst: (0.0, 0.0),
            pitch_rad: 0.0,
            working_m: 0.0,
            capture: CaptureWatch {
                bands_hz: screen.bands_hz(),
                behind_turns: BEHIND * screen.common_limit_turns,
                entered: None,
                held: None,
                captured: None,
                at_stop: None,
                was_rising: false,
            },
        }
    }

    fn torque_sentence(&self) -> String {
        let enough = format!(
            "{:.0} N·m of each motor are enough to turn steadily at the resonance, with a block lifted in each turn",
            self.sufficient.enough_nm
        );
        match self.sufficient.motor_nm {
            Some(motor_nm) => format!("{enough}; the motors have {motor_nm:.0} N·m."),
            None => format!("{enough}."),
        }
    }
}

impl Record for ScreenRecord {
    fn tick(&mut self, tick: &Tick<'_>) {
        let commanded_hz = tick.omega_rad_s / TAU;
        let n = tick.turns.len();
        let (x_m, z_m, pitch_rad, actual_hz) = match tick.state {
            Some(state) => (
                state.q[n],
                state.q[n + 1],
                state.q[n + 2],
                state.v[..n].iter().sum::<f64>() / (n as f64 * TAU),
            ),
            None => (
                0.0,
                tick.pose.z_m,
                tick.pose.pitch_mrad * 1e-3,
                commanded_hz,
            ),
        };
        let ends = self.ends_m * pitch_rad.abs();
        let away_m = x_m.hypot(z_m.abs() + ends);
        if away_m > self.worst.0 {
            self.worst = (away_m, actual_hz);
        }
        self.pitch_rad = self.pitch_rad.max(pitch_rad.abs());
        let top_hz = self.capture.bands_hz.iter().map(|band| band.1);
        let top_hz = top_hz.fold(0.0, f64::max);
        if tick.acceleration_rad_s2 == 0.0 && commanded_hz.min(actual_hz) > top_hz {
            self.working_m = self.working_m.max(away_m);
        }
        if tick.state.is_some() {
            let ahead: f64 = (tick.command_turns.iter().zip(tick.turns))
                .map(|(command, actual)| command - actual)
                .sum();
            let speeds = Held {
                actual_hz,
                commanded_hz,
            };
            self.capture.tick(tick, speeds, ahead / n as f64);
        }
    }

    fn end(&mut self, faults: &[FaultKind]) {
        if faults.contains(&FaultKind::Capture) {
            let stopped = self.capture.at_stop;
            self.capture.captured = self.capture.captured.or(stopped);
        }
    }

    fn figures(&self) -> Vec<Figure> {
        let (worst_m, at_hz) = self.worst;
        let bands_hz = &self.capture.bands_hz;
        let (from_hz, _) = bands_hz[0];
        let (_, to_hz) = bands_hz[bands_hz.len() - 1];
        let bands: Vec<_> = (bands_hz.iter())
            .map(|(from_hz, to_hz)| format!("{from_hz:.2} to {to_hz:.2}"))
            .collect();
        let (its, an_end) = if self.excites_pitch {
            (
                "resonances forbid",
                ", or an end of it by more than twice as much as far above them",
            )
        } else {
            ("resonance forbids", "")
        };
        let captured = self.capture.captured();
        let working_m = (self.working_m > 0.0).then_some(self.working_m);
        let figure = |key, value, sentence| Figure {
            key,
            value,
            sentence,
        };
        vec![
            figure(
                "displacement_worst_mm",
                Some(1e3 * worst_m),
                format!(
                    "The box moved by at most {:.2} mm from rest, its ends included, at {at_hz:.2} rev/s of its shafts.",
                    1e3 * worst_m
                ),
            ),
            figure(
                "pitch_worst_mrad",
                Some(1e3 * self.pitch_rad),
                if self.pitch_rad > 1e-6 {
                    format!("It pitched by at most {:.2} mrad.", 1e3 * self.pitch_rad)
                } else {
                    String::new()
                },
            ),
            figure(
                "displacement_working_mm",
                working_m.map(|m| 1e3 * m),
                working_m.map_or_else(String::new, |m| {
                    format!(
                        "At steady speeds above the resonance it moved by at most {:.2} mm.",
                        1e3 * m
                    )
                }),
            ),
            figure(
                "resonance_from_hz",
                Some(from_hz),
                format!(
                    "Its {its} {} rev/s: it would move by more than twice its throw{an_end}.",
                    bands.join(" and ")
                ),
            ),
            figure("resonance_to_hz", Some(to_hz), String::new()),
            figure(
                "resonance_torque_nm",
                Some(self.sufficient.enough_nm),
                self.torque_sentence(),
            ),
            figure(
                "captured_hz",
                captured.map(|held| held.actual_hz),
                match captured {
                    Some(held) => format!(
                        "The resonance captured the shafts: they were still at {:.2} rev/s where {:.2} were commanded.",
                        held.actual_hz, held.commanded_hz
                    ),
                    None => "The resonance did not capture the shafts.".to_owned(),
                },
            ),
        ]
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let reserve = self.sufficient.reserve();
        if let Some(reserve) = reserve.filter(|reserve| *reserve < 1.0) {
            warnings.push(format!(
                "The motors have {reserve:.2} of the torque that is enough at the resonance: a slow run-up may be captured there."
            ));
        }
        if let Some(held) = self.capture.captured() {
            warnings.push(format!(
                "The screen was captured at its resonance, at {:.2} rev/s: its motors lack the torque to follow their command through it.",
                held.actual_hz
            ));
        }
        warnings
    }
}
