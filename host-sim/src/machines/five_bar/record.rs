//! Figures of an arm's run: errors of the hand's position and of its force on the surface.

use std::f64::consts::TAU;

use crate::machines::five_bar::arm::HybridLaw;

use super::{Arm, both};
use crate::dynamics::plant::{Figure, Record, Tick};

/// Figures of a run.
#[derive(Clone, Debug)]
pub struct ArmRecord {
    arm: Arm,
    /// Largest distance of the commanded hand from the path, m. It is caused by the finite number of cam points.
    table_m: f64,
    /// Duration of the master's current steady rotation, s. As in the source, errors count only after the duration of a blend.
    steady_s: f64,
    /// Largest position error of the hand at steady speed of the master, m. It is measured along the surface, if there is one.
    place_m: Option<f64>,
    /// Largest force error under the same conditions, N.
    force_n: Option<f64>,
    /// Largest distance of the hand from its path with the drives on, m, and the end of that tick, s. Along a surface it is the
    /// distance from the commanded place, because the law does not hold the place across it.
    off_path: (f64, f64),
    /// Time for which the force on the surface was beyond the range of the law's sensor, s, and its first tick's end, s.
    saturated: (f64, Option<f64>),
}

/// Part of the path's length by which a hand has left its path.
const LEFT: f64 = 0.01;

impl ArmRecord {
    pub(super) fn new(arm: &Arm) -> Self {
        Self {
            arm: arm.clone(),
            table_m: 0.0,
            steady_s: 0.0,
            place_m: None,
            force_n: None,
            off_path: (0.0, 0.0),
            saturated: (0.0, None),
        }
    }
}

/// Returns the larger of a value and the previous one, if there was one.
fn worst(before: Option<f64>, value: f64) -> Option<f64> {
    Some(before.map_or(value, |before| before.max(value)))
}

impl Record for ArmRecord {
    fn tick(&mut self, tick: &Tick<'_>) {
        let arm = &self.arm.arm;
        let commanded = arm.hand_m(both(tick.command_turns).map(|turns| turns * TAU));
        self.table_m = self.table_m.max(self.arm.path.nearest(commanded).0);
        let actual = arm.hand_m(both(tick.turns).map(|turns| turns * TAU));
        let off = [0, 1].map(|i| actual[i] - commanded[i]);
        if tick.drives_enabled {
            let off_m = match self.arm.law {
                Some(_) => self.arm.along(off).abs(),
                None => self.arm.path.nearest(actual).0,
            };
            if off_m > self.off_path.0 {
                self.off_path = (off_m, tick.t_s);
            }
        }
        let pressed_n = tick
            .state
            .map(|state| arm.contact_n(both(state.q), both(state.v)));
        let law = self.arm.law.as_ref().zip(pressed_n);
        let is_saturated = |(law, pressed_n): (&HybridLaw, f64)| law.sensor.is_saturated(pressed_n);
        if tick.drives_enabled && law.is_some_and(is_saturated) {
            self.saturated.0 += tick.tick_s;
            self.saturated.1.get_or_insert(tick.t_s);
        }
        let is_steady = tick.acceleration_rad_s2 == 0.0 && tick.omega_rad_s > 0.0;
        if !tick.drives_enabled || !is_steady {
            self.steady_s = 0.0;
            return;
        }
        self.steady_s += tick.tick_s;
        if self.steady_s < self.arm.path.blend_s() {
            return;
        }
        let off_m = match self.arm.law {
            Some(_) => self.arm.along(off).abs(),
            None => off[0].hypot(off[1]),
        };
        self.place_m = worst(self.place_m, off_m);
        if let Some((law, pressed_n)) = law {
            let off_n = (pressed_n - law.required_n).abs();
            self.force_n = worst(self.force_n, off_n);
        }
    }

    fn figures(&self) -> Vec<Figure> {
        let place_mm = self.place_m.map(|m| 1e3 * m);
        let figure = |key, value, sentence| Figure {
            key,
            value,
            sentence,
        };
        vec![
            figure(
                "place_error_mm",
                place_mm,
                place_mm.map_or_else(String::new, |mm| {
                    format!("At the path's speed the hand was at most {mm:.3} mm from its commanded place.")
                }),
            ),
            figure(
                "force_error_n",
                self.force_n,
                self.force_n.map_or_else(String::new, |n| {
                    format!("Its force on the surface was at most {n:.3} N off.")
                }),
            ),
            figure(
                "sensor_saturated_s",
                self.arm.law.as_ref().map(|_| self.saturated.0),
                String::new(),
            ),
            figure(
                "table_error_mm",
                Some(1e3 * self.table_m),
                format!(
                    "The cam tables have the hand at most {:.4} mm beside its path.",
                    1e3 * self.table_m
                ),
            ),
            figure(
                "singularity_margin",
                Some(self.arm.min_sine),
                format!(
                    "On the path |sin(q1 − q2)| is at least {:.3}; 0 would be singular.",
                    self.arm.min_sine
                ),
            ),
        ]
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let (Some(law), (for_s, Some(from_s))) = (&self.arm.law, self.saturated) {
            warnings.push(format!(
                "The force on the surface was beyond the range of its sensor, {} N, for {for_s:.3} s from {from_s:.3} s on: the law knows only \
                 that it was. Give a wider five_bar.contact.sensor_n, or a lower force.",
                law.sensor.full_scale_n
            ));
        }
        let (off_m, at_s) = self.off_path;
        if off_m > LEFT * TAU * self.arm.path.radius_m() {
            warnings.push(format!(
                "The hand left its path: at {at_s:.3} s it was {:.1} mm off, more than {:.0} % of the path's length.",
                1e3 * off_m,
                100.0 * LEFT
            ));
        }
        warnings
    }
}
