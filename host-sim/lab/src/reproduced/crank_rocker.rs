//! Figures of the crank-rocker.

use crate::design::crank_rocker::{Design, Requirement, design};
use host_sim::mechanism::crank_rocker::Linkage;

use super::Tolerance::Absolute;
use super::{Figure, ReproducedError, Section};

const FILE: &str = "host-sim/tests/machines/crank_rocker.rs";

pub(super) fn section() -> Result<Section, ReproducedError> {
    let found = design(&Requirement {
        swing_deg: 60.0,
        pressure_deg: 20.0,
        time_ratio: 0.9,
        screw_lead_mm: Some(12.0),
    })
    .map_err(ReproducedError::from_error)?;
    let linkage = found.linkage;
    let [stretched, folded] = found.dead_centres_deg();
    let printed = Linkage {
        crank: 0.48521,
        coupler: 1.54021,
        ground: 1.92792,
    };
    let (min, max) = printed.pressure_range_rad();
    let samples = (0..=360_u32).map(|degree| {
        printed
            .pressure_rad(f64::from(degree).to_radians())
            .to_degrees()
    });
    let mean_of_361 = samples.sum::<f64>() / 361.0;
    let of_printed = Design {
        linkage: printed,
        ..found
    };
    let (speed, acceleration) = (found.rocker_speed(), found.rocker_acceleration());
    let swing_of = |time_ratio: f64| {
        let refused = design(&Requirement {
            swing_deg: 60.0,
            pressure_deg: 0.0,
            time_ratio,
            screw_lead_mm: None,
        });
        match refused {
            Err(crate::design::crank_rocker::DesignError::Branch { swing_deg, .. }) => swing_deg,
            _ => f64::NAN,
        }
    };
    Ok(Section {
        title: "Crank-rocker with a screw",
        source: "Russian paper of 2013. Its linkage has a swing of 60°, a pressure angle of 20° and a time ratio of 0.9.",
        command: "cargo test -p host-sim --test integration crank_rocker -- --nocapture",
        figures: vec![
            Figure::new(
                1,
                "Θ, °; crank, coupler and ground over the rocker",
                [9.473684, 0.4852094, 1.5402148, 1.9279190],
                [
                    found.theta_deg,
                    linkage.crank,
                    linkage.coupler,
                    linkage.ground,
                ],
                Absolute(1e-6),
                (FILE, "lengths_of_the_example"),
            ),
            Figure::new(
                2,
                "swing; crank at the dead centres, °",
                [60.0, 29.171, 199.697],
                [linkage.swing_rad().to_degrees(), stretched, folded],
                Absolute(5e-4),
                (FILE, "swing_and_dead_centres"),
            ),
            Figure::new(
                2,
                "time ratio",
                [0.9],
                [linkage.time_ratio()],
                Absolute(1e-9),
                (FILE, "swing_and_dead_centres"),
            ),
            Figure::new(
                3,
                "largest pressure angle with printed lengths, and in full precision, °",
                [52.7171, 52.7162],
                [max.to_degrees(), found.pressure_deg().max],
                Absolute(5e-5),
                (FILE, "pressure_angles"),
            ),
            Figure::new(
                3,
                "least pressure angle, and that of the folded dead centre, printed lengths, °",
                [-24.774, 49.475],
                [
                    min.to_degrees(),
                    printed.pressure_rad(printed.dead_centres_rad()[1]).to_degrees(),
                ],
                Absolute(5e-4),
                (FILE, "pressure_angles"),
            ),
            Figure::new(
                4,
                "mean pressure angle as the source averages it, and over the cycle, printed lengths, °",
                [12.1508, 12.2533],
                [mean_of_361, of_printed.mean_pressure_deg()],
                Absolute(5e-5),
                (FILE, "pressure_angles"),
            )
            .noted("the print has 12.151: 361 samples that count 0° and 360°"),
            Figure::new(
                5,
                "Grashof margin",
                [0.12709],
                [linkage.grashof_margin()],
                Absolute(5e-6),
                (FILE, "lengths_of_the_example"),
            ),
            Figure::new(
                6,
                "ψ′ and ψ″, greatest and least",
                [0.53075, -0.50649, 0.69621, -0.62101],
                [speed.max, speed.min, acceleration.max, acceleration.min],
                Absolute(1e-4),
                (FILE, "rocker_speed_acceleration_and_stroke"),
            ),
            Figure::new(
                6,
                "lead over the stroke",
                [6.0],
                [12.0 / found.stroke_mm().unwrap_or(f64::NAN)],
                Absolute(1e-9),
                (FILE, "rocker_speed_acceleration_and_stroke"),
            ),
            Figure::new(
                7,
                "swing of refused linkages, time ratios 0.6 and 0.7, °",
                [47.59, 58.28],
                [swing_of(0.6), swing_of(0.7)],
                Absolute(5e-3),
                (FILE, "requirements_without_a_linkage_are_refused_by_name"),
            ),
        ],
    })
}
