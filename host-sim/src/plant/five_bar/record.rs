//! Figures of an arm's run: errors of the hand's position and of its force on the surface.

use std::f64::consts::TAU;

use super::{Arm, both};
use crate::plant::{Figure, Record, Tick};

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
}

impl ArmRecord {
    pub(super) fn new(arm: &Arm) -> Self {
        Self {
            arm: arm.clone(),
            table_m: 0.0,
            steady_s: 0.0,
            place_m: None,
            force_n: None,
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
        let is_steady = tick.acceleration_rad_s2 == 0.0 && tick.omega_rad_s > 0.0;
        if !tick.drives_enabled || !is_steady {
            self.steady_s = 0.0;
            return;
        }
        self.steady_s += tick.tick_s;
        if self.steady_s < self.arm.path.blend_s() {
            return;
        }
        let actual = arm.hand_m(both(tick.turns).map(|turns| turns * TAU));
        let off = [0, 1].map(|i| actual[i] - commanded[i]);
        let off_m = match self.arm.law {
            Some(_) => self.arm.along(off).abs(),
            None => off[0].hypot(off[1]),
        };
        self.place_m = worst(self.place_m, off_m);
        if let (Some(law), Some(state)) = (&self.arm.law, tick.state) {
            let pressed_n = arm.contact_n(both(state.q), both(state.v));
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
                "table_error_mm",
                Some(1e3 * self.table_m),
                format!(
                    "The cam tables have the hand at most {:.4} mm beside its path.",
                    1e3 * self.table_m
                ),
            ),
            figure(
                "singularity_margin",
                Some(self.arm.least_sine),
                format!(
                    "On the path |sin(q1 − q2)| is at least {:.3}; 0 would be singular.",
                    self.arm.least_sine
                ),
            ),
        ]
    }
}
