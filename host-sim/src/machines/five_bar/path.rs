//! Path of the hand: straight lines with parabolic blends, there and back to the first point.

use std::f64::consts::TAU;

use crate::machines::five_bar::arm::{Line, TooShort};
use cophase_core::axes::MAX_CAM_POINTS;

use crate::mechanism::five_bar::{FiveBar, Joints, Unreachable};

/// Closed path in the plane. The hand rests at each of its points.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Lines of the path, each with its start time, s.
    lines: Vec<(f64, Line)>,
    duration_s: f64,
}

/// Motion at a point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Position, m.
    pub at_m: [f64; 2],
    /// Velocity, m/s.
    pub velocity_mps: [f64; 2],
    /// Acceleration, m/s².
    pub acceleration_mps2: [f64; 2],
}

/// Reason why a path has no cam table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoTable {
    /// Point that the hand cannot reach, m.
    Unreachable([f64; 2], Unreachable),
    /// Point where the arm is too close to a singular configuration, m, with |sin(q₁ − q₂)|.
    Singular([f64; 2], f64),
}

impl Path {
    /// Creates a path through at least two points, m, and back to the first. It has a speed between blends, and a duration
    /// of each blend.
    ///
    /// # Errors
    /// A line is too short for its blends.
    pub fn new(points_m: &[[f64; 2]], speed_mps: f64, blend_s: f64) -> Result<Self, TooShort> {
        let mut lines = Vec::new();
        let mut duration_s = 0.0;
        let ends = points_m.iter().zip(points_m.iter().cycle().skip(1));
        for (&from_m, &to_m) in ends {
            let line = Line::with_speed(from_m, to_m, speed_mps, blend_s)?;
            lines.push((duration_s, line));
            duration_s += line.duration_s();
        }
        Ok(Self { lines, duration_s })
    }

    /// Duration of the path at its own speed, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Radius of the circle whose circumference equals the length of the path, m.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        let lines = self.lines.iter().map(|(_, line)| line.length_m());
        lines.sum::<f64>() / TAU
    }

    /// Amplitude at the path's own speed, m/s²: the acceleration on that circle.
    #[must_use]
    pub fn nominal_mps2(&self) -> f64 {
        self.radius_m() * (TAU / self.duration_s).powi(2)
    }

    /// Duration of the blends, s.
    #[must_use]
    pub fn blend_s(&self) -> f64 {
        self.lines[0].1.blend_s
    }

    /// Unit vector along the first line.
    #[must_use]
    pub fn direction(&self) -> [f64; 2] {
        self.lines[0].1.direction()
    }

    /// First point, m.
    #[must_use]
    pub fn start_m(&self) -> [f64; 2] {
        self.lines[0].1.from_m
    }

    /// Motion at a fraction of the path's duration, 0 to 1, at the path's own speed.
    #[must_use]
    pub fn at(&self, part: f64) -> Motion {
        let t_s = part.rem_euclid(1.0) * self.duration_s;
        let line = self.lines.iter().rev().find(|(began_s, _)| *began_s <= t_s);
        let (began_s, line) = line.unwrap_or(&self.lines[0]);
        let [distance, speed, acceleration] = line.at(t_s - began_s);
        let direction = line.direction();
        let along = |value: f64| direction.map(|part| part * value);
        let moved = along(distance);
        Motion {
            at_m: [0, 1].map(|i| line.from_m[i] + moved[i]),
            velocity_mps: along(speed),
            acceleration_mps2: along(acceleration),
        }
    }

    /// Distance of a point from the nearest line, m, and the acceleration there, m/s², of a hand that follows the path at
    /// its own speed. A line and its return line have the same acceleration at the same point.
    #[must_use]
    pub fn nearest(&self, point_m: [f64; 2]) -> (f64, [f64; 2]) {
        let of_line = |(_, line): &(f64, Line)| {
            let direction = line.direction();
            let from = [0, 1].map(|i| point_m[i] - line.from_m[i]);
            let along =
                (from[0] * direction[0] + from[1] * direction[1]).clamp(0.0, line.length_m());
            let off = [0, 1].map(|i| from[i] - along * direction[i]);
            let blend_m = 0.5 * line.speed_mps * line.blend_s;
            let acceleration = if along < blend_m {
                line.speed_mps / line.blend_s
            } else if line.length_m() - along < blend_m {
                -line.speed_mps / line.blend_s
            } else {
                0.0
            };
            (
                off[0].hypot(off[1]),
                direction.map(|part| part * acceleration),
            )
        };
        let lines = self.lines.iter().map(of_line);
        lines
            .min_by(|one, other| one.0.total_cmp(&other.0))
            .unwrap_or((f64::INFINITY, [0.0; 2]))
    }

    /// Cam tables of both joints over one turn of the master, with equally spaced points, in turns of each joint. Also
    /// returns the smallest |sin(q₁ − q₂)| on the path.
    ///
    /// # Errors
    /// The hand cannot reach a point of the path, or |sin(q₁ − q₂)| is below `margin` there.
    pub fn tables(
        &self,
        links: &FiveBar,
        mode: usize,
        margin: f64,
    ) -> Result<([Vec<f64>; 2], f64), NoTable> {
        let (mut tables, mut min) = ([Vec::new(), Vec::new()], f64::INFINITY);
        for i in 0..SAMPLES {
            let at_m = self.at(f64::from(i) / f64::from(SAMPLES)).at_m;
            let Joints { q1_rad, q2_rad } = links
                .joints(at_m[0], at_m[1])
                .map_err(|problem| NoTable::Unreachable(at_m, problem))?[mode];
            let sine = (q1_rad - q2_rad).sin().abs();
            if sine < margin {
                return Err(NoTable::Singular(at_m, sine));
            }
            min = min.min(sine);
            if i % (SAMPLES / MAX_CAM_POINTS as u32) == 0 {
                for (table, angle) in tables.iter_mut().zip([q1_rad, q2_rad]) {
                    let turns = angle / TAU;
                    // Angles are within one turn, so the joint takes the shorter direction from point to point.
                    let last = table.last().copied().unwrap_or(turns);
                    table.push(turns + (last - turns).round());
                }
            }
        }
        Ok((tables, min))
    }
}

/// Number of points at which a path is checked: eight per point of the tables.
const SAMPLES: u32 = 8 * MAX_CAM_POINTS as u32;
