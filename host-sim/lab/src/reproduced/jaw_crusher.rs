//! Figures of the jaw crusher and its flywheel.

use crate::design::flywheel::{Requirement, design};
use host_sim::machines::crusher::mains::{Jaw, OnMains, Shape, Speeds};

use super::Tolerance::{Absolute, NotReproduced, Relative};
use super::{Figure, ReproducedError, Section};

const DESIGN: &str = "host-sim/tests/machines/flywheel.rs";
const FILE: &str = "host-sim/tests/machines/crusher_on_mains.rs";

/// Slowest speed that the source prints, rad/s.
const SLOWEST: f64 = 26.118;

fn fitted(shape: Shape) -> Result<(OnMains, Speeds), ReproducedError> {
    let empty = OnMains::SOURCE;
    let peak_n = empty
        .fitted_peak_n(shape, SLOWEST, 28.0)
        .map_err(ReproducedError::from_error)?;
    let crusher = empty.with_rock(shape, peak_n);
    let speeds = crusher
        .periodic(0.0, 28.0)
        .map_err(ReproducedError::from_error)?;
    Ok((crusher, speeds))
}

pub(super) fn section() -> Result<Section, ReproducedError> {
    let found = design(&Requirement {
        power_kw: 15.0,
        rated_rpm: 970.0,
        synchronous_rpm: 1000.0,
        overload: 2.0,
        belt_ratio: 3.7,
        mass_kg: 281.0,
        diameter_m: 0.762,
        speeds_rad_s: Some([28.303, SLOWEST]),
    })
    .map_err(ReproducedError::from_error)?;
    let inertia = (0..3600_u32).map(|i| {
        OnMains::SOURCE
            .inertia_kgm2(f64::from(i) * std::f64::consts::TAU / 3600.0)
            .0
    });
    let (min, max) = inertia.fold((f64::MAX, f64::MIN), |(min, max), here| {
        (min.min(here), max.max(here))
    });
    let flywheel = OnMains {
        flywheel_kgm2: 40.884,
        jaw: Jaw::NONE,
        ..OnMains::SOURCE
    };
    let without_rock = flywheel
        .turn(0.0, SLOWEST)
        .map_err(ReproducedError::from_error)?
        .end_rad_s();
    let (crusher, linear) = fitted(Shape::LinearRise)?;
    let (_, half) = fitted(Shape::SecondHalf)?;
    let (_, constant) = fitted(Shape::Constant)?;
    let pair = |speeds: &Speeds| [speeds.fastest_rad_s(), speeds.mean_rad_s()];
    let by_18 = crusher
        .periodic_by_source(18, std::f64::consts::TAU * 30.0 / 360.0, 28.0)
        .map_err(ReproducedError::from_error)?;
    let distance_nm = linear
        .nodes
        .iter()
        .map(|node| crusher.inertia_torque_nm(node[0], node[1]).abs())
        .fold(0.0, f64::max);
    let selected = "the distance of the pivots was selected for these six speeds: no prediction";
    Ok(Section {
        title: "Jaw crusher",
        source: "Chinese paper on its flywheel. The links are lost; their assumptions are in `host-sim/src/machines/crusher/mains/mod.rs`.",
        command: "cargo test -p host-sim --test integration machines:: -- --nocapture",
        figures: vec![
            Figure::new(
                1,
                "speed without load and at rated load, rad/s",
                [28.3026, 27.4536],
                [found.synchronous_rad_s(), found.rated_rad_s()],
                Absolute(5e-5),
                (DESIGN, "speeds_and_inertia"),
            )
            .noted("the source starts its integration at 28.3021 rad/s, 0.002 % below 1000 rpm / 3.7, and gives no reason; its greatest speed, 28.303, agrees with 28.3026"),
            Figure::new(
                2,
                "flywheel, thin rim and disc, kg m²",
                [40.790, 20.40],
                [found.rim_kgm2(), found.disc_kgm2()],
                Absolute(5e-3),
                (DESIGN, "speeds_and_inertia"),
            ),
            Figure::new(
                3,
                "rated and breakdown torque, N m; motor's speed at breakdown, rad/s",
                [147.68, 295.36, 92.995],
                [
                    found.rated_torque_nm(),
                    found.breakdown_torque_nm(),
                    found.breakdown_motor_rad_s(),
                ],
                Absolute(5e-3),
                (DESIGN, "torque_of_the_motor_and_on_the_shaft"),
            ),
            Figure::new(
                4,
                "energy swing of 40.9 kg m², J",
                [2431.7],
                [found.energy_swing_j().unwrap_or(f64::NAN) * 40.9 / found.rim_kgm2()],
                Absolute(0.05),
                (DESIGN, "irregularity_and_energy"),
            ),
            Figure::new(
                5,
                "equivalent inertia, least and greatest, kg m²",
                [40.828, 40.940],
                [min, max],
                Absolute(5e-4),
                (FILE, "equivalent_inertia_has_the_published_range"),
            )
            .noted("the jaw's mass and centre are calibrated to it"),
            Figure::new(
                6,
                "speed after a turn without rock from 26.118, rad/s",
                [28.250],
                [without_rock],
                Absolute(1e-3),
                (FILE, "a_turn_without_rock_does_not_restore_the_speed"),
            ),
            Figure::new(
                7,
                "periodic regime, force that rises: fastest and mean, rad/s",
                [28.043, 27.255],
                pair(&linear),
                Absolute(0.01),
                (FILE, "periodic_regime_matches_an_independent_computation"),
            )
            .noted(selected),
            Figure::new(
                7,
                "… in the second half",
                [28.167, 27.362],
                pair(&half),
                Absolute(0.01),
                (FILE, "periodic_regime_matches_an_independent_computation"),
            )
            .noted(selected),
            Figure::new(
                7,
                "… constant",
                [28.021, 27.177],
                pair(&constant),
                Absolute(0.01),
                (FILE, "periodic_regime_matches_an_independent_computation"),
            )
            .noted(selected),
            Figure::new(
                8,
                "error of 18 nodes, slowest speed, rad/s",
                [-0.073],
                [by_18.slowest_rad_s() - linear.slowest_rad_s()],
                Absolute(2e-3),
                (FILE, "the_source_scheme_error_is_near_the_computed_one"),
            )
            .noted("load and nodes were selected for it"),
            Figure::new(
                8,
                "… fastest speed",
                [0.031],
                [by_18.fastest_rad_s() - linear.fastest_rad_s()],
                NotReproduced,
                (FILE, "the_source_scheme_error_is_near_the_computed_one"),
            )
            .noted("depends on load and nodes, which are not known: −0.017 to 0.056"),
            Figure::new(
                9,
                "largest distance of an extreme's condition from Md = Mr, N m",
                [42.0],
                [distance_nm],
                Relative(0.08),
                (FILE, "extremes_are_not_where_the_torques_are_equal"),
            )
            .noted("of the assumed linkage; the source's is lost"),
        ],
    })
}
