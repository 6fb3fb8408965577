//! Figures of the suspended five-bar arm.

use crate::design::five_bar::{Requirement, design};
use host_sim::machines::five_bar::arm::{ForceSensor, GRAVITY_MPS2, Line, Load};

use super::Tolerance::Absolute;
use super::{Figure, ReproducedError, Section};

const DESIGN: &str = "host-sim/tests/machines/five_bar.rs";
const FILE: &str = "host-sim/tests/machines/five_bar_arm.rs";

pub(super) fn section() -> Result<Section, ReproducedError> {
    let found = design(&Requirement {
        l1_m: 0.25,
        l4_m: 0.25,
        x_m: 0.0,
        y_m: 0.3,
    })
    .map_err(ReproducedError::from_error)?;
    let first = found
        .solutions
        .iter()
        .copied()
        .max_by(|one, other| one.q1_rad.total_cmp(&other.q1_rad))
        .ok_or_else(|| ReproducedError::from_error("the arm reaches the point"))?;
    let (from, to) = ([0.0, 0.3], [0.2, 0.3]);
    let by_speed = Line::with_speed(from, to, 0.02, 0.5).map_err(ReproducedError::from_error)?;
    let by_time = Line::with_duration(from, to, 10.0, 0.5).map_err(ReproducedError::from_error)?;
    let rope = Load::Rope {
        lift_n: 19.62,
        length_m: 1.0,
        below_m: [0.2, 0.3],
    };
    let side_n = rope.force_n(from)[0];
    Ok(Section {
        title: "Suspended five-bar arm",
        source: "Paper of 2000, in Chinese translation. Its tables and most of its equations are lost, so that links and gains are assumed.",
        command: "cargo test -p host-sim --test integration five_bar -- --nocapture",
        figures: vec![
            Figure::new(
                1,
                "weight of the tool, N",
                [19.62],
                [2.0 * GRAVITY_MPS2],
                Absolute(1e-9),
                (FILE, "weight_sensor_step_and_side_pull_match_the_source"),
            ),
            Figure::new(
                4,
                "joints at (0, 0.3) with links of 0.25 m, °",
                [143.130, 36.870],
                [first.q1_rad.to_degrees(), first.q2_rad.to_degrees()],
                Absolute(5e-4),
                (DESIGN, "joints_at_the_beginning_of_the_path"),
            ),
            Figure::new(
                4,
                "determinant of the Jacobian there, m²",
                [0.06],
                [found.arm.determinant_m2(first).abs()],
                Absolute(1e-9),
                (DESIGN, "joints_at_the_beginning_of_the_path"),
            ),
            Figure::new(
                5,
                "duration of 0.2 m at 0.02 m/s with blends of 0.5 s, s",
                [10.5],
                [by_speed.duration_s()],
                Absolute(1e-9),
                (FILE, "line_durations_follow_from_speed_and_blends"),
            ),
            Figure::new(
                5,
                "speed for 10 s, m/s",
                [0.0210526],
                [by_time.speed_mps],
                Absolute(5e-8),
                (FILE, "line_durations_follow_from_speed_and_blends"),
            ),
            Figure::new(
                8,
                "step of the force sensor, mN",
                [9.58],
                [1e3 * ForceSensor::SOURCE.step_n()],
                Absolute(5e-3),
                (FILE, "weight_sensor_step_and_side_pull_match_the_source"),
            ),
            Figure::new(
                9,
                "side force of a rope of 1 m, 0.2 m off, N",
                [3.92],
                [side_n],
                Absolute(5e-3),
                (FILE, "weight_sensor_step_and_side_pull_match_the_source"),
            ),
        ],
    })
}
