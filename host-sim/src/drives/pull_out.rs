//! Pull-out torque: the largest torque that a stepper can give at a speed before it loses step.

use cophase_core::problem::Problem;
use cophase_scene::{SceneError, range};

/// Greatest speed of a point, rev/s. No motor turns faster: it was meant in another unit.
const MAX_HZ: f64 = 600.0;

/// Torque against speed, linear between points. It is constant below the first point, and zero above
/// the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PullOut {
    points: Vec<(f64, f64)>,
}

impl PullOut {
    /// Creates a curve from `[speed_hz, torque_nm]` points. Without points, the motor never loses
    /// step.
    ///
    /// # Errors
    /// Fails if points are not finite, negative, out of range, or not in order of speed.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, SceneError> {
        for (i, &(speed_hz, torque_nm)) in points.iter().enumerate() {
            let wrong =
                |problem: String| Err(SceneError::for_key(format!("axes.pull_out[{i}]"), problem));
            for (column, value, max) in [
                ("speed_hz", speed_hz, MAX_HZ),
                ("torque_nm", torque_nm, 1e5),
            ] {
                if !(0.0..=max).contains(&value) {
                    let problem = Problem::out_of_range(value, 0.0, max);
                    return wrong(range::sentence(column, problem, None));
                }
            }
            if i > 0 && speed_hz <= points[i - 1].0 {
                let before = points[i - 1].0;
                let is_turned_round = points.is_sorted_by(|a, b| a.1 < b.1);
                let fix = match is_turned_round {
                    true => {
                        let turned: Vec<_> =
                            points.iter().map(|(a, b)| format!("[{b}, {a}]")).collect();
                        format!(
                            "a point is [speed_hz, torque_nm]; write [{}]",
                            turned.join(", ")
                        )
                    }
                    false => "list points from the lowest speed up".to_owned(),
                };
                return wrong(format!(
                    "{speed_hz} rev/s is not above the point before, {before} rev/s; {fix}"
                ));
            }
        }
        Ok(Self {
            points: points.to_vec(),
        })
    }

    /// Returns the curve at a crank, from the checked points of its motor, which makes `motor_turns` per turn of the crank and is stronger
    /// by `factor`.
    pub(super) fn behind_gear(points: &[(f64, f64)], motor_turns: f64, factor: f64) -> Self {
        let at_crank = |&(hz, nm): &(f64, f64)| (hz / motor_turns, nm * factor * motor_turns);
        Self {
            points: points.iter().map(at_crank).collect(),
        }
    }

    /// Largest torque at any speed, N·m.
    pub fn max_nm(&self) -> f64 {
        let max = self.points.iter().map(|&(_, nm)| nm).reduce(f64::max);
        max.unwrap_or(f64::INFINITY)
    }

    /// Torque at a speed, N·m.
    pub fn torque_nm(&self, speed_hz: f64) -> f64 {
        let Some((&first, others)) = self.points.split_first() else {
            return f64::INFINITY;
        };
        let (mut a_hz, mut a_nm) = first;
        if speed_hz <= a_hz {
            return a_nm;
        }
        for &(b_hz, b_nm) in others {
            if speed_hz <= b_hz {
                return a_nm + (b_nm - a_nm) * (speed_hz - a_hz) / (b_hz - a_hz);
            }
            (a_hz, a_nm) = (b_hz, b_nm);
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_curve_interpolates_between_points() {
        let curve = PullOut::new(&[(1.0, 8.0), (5.0, 4.0)]).unwrap();
        for (speed_hz, torque_nm) in [(0.0, 8.0), (1.0, 8.0), (2.0, 7.0), (5.0, 4.0), (5.1, 0.0)] {
            assert_eq!(curve.torque_nm(speed_hz), torque_nm, "{speed_hz} rev/s");
        }
        assert_eq!(PullOut::default().torque_nm(100.0), f64::INFINITY);
    }
}
