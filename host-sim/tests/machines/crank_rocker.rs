//! Synthesis of the crank-rocker, against the figures of its source and independently computed figures.
//!
//! Tolerances are half a unit of the last place given, unless another tolerance is given with the figure.

use std::f64::consts::TAU;

use cophase_lab::design::crank_rocker::{Design, DesignError, Requirement, design};
use host_sim::mechanism::crank_rocker::Linkage;

use super::assert_near;

/// The source's example.
const EXAMPLE: Requirement = Requirement {
    swing_deg: 60.0,
    pressure_deg: 20.0,
    time_ratio: 0.9,
    screw_lead_mm: Some(12.0),
};

fn example() -> Design {
    design(&EXAMPLE).expect("the source's example has a linkage")
}

/// Item 1, and the margin of item 5.
#[test]
fn lengths_of_the_example() {
    let found = example();
    assert_near("theta", found.theta_deg, 9.473684, 1e-6);
    assert_near("crank", found.linkage.crank, 0.4852094, 1e-6);
    assert_near("coupler", found.linkage.coupler, 1.5402148, 1e-6);
    assert_near("ground", found.linkage.ground, 1.9279190, 1e-6);
    assert_near("margin", found.linkage.grashof_margin(), 0.12709, 5e-6);
}

/// Item 2.
#[test]
fn swing_and_dead_centres() {
    let found = example();
    let [stretched, folded] = found.dead_centres_deg();
    assert_near("swing", found.linkage.swing_rad().to_degrees(), 60.0, 1e-6);
    assert_near("stretched out", stretched, 29.171, 5e-4);
    assert_near("folded", folded, 199.697, 5e-4);
    assert_near("forward sector", folded - stretched, 170.526, 5e-4);
    assert_near("return sector", 360.0 - folded + stretched, 189.474, 5e-4);
    assert_near("time ratio", found.linkage.time_ratio(), 0.9, 1e-9);
}

/// Items 3 and 4. Printed lengths have five digits, which changes angles in the third decimal. The source's mean is of 361 samples, with 0°
/// and 360° both counted.
#[test]
fn pressure_angles() {
    let found = example();
    let pressure = found.pressure_deg();
    let printed = Linkage {
        crank: 0.48521,
        coupler: 1.54021,
        ground: 1.92792,
    };
    assert_near("largest", pressure.max, 52.7162, 5e-5);
    let at_dead_centres = found
        .linkage
        .dead_centres_rad()
        .map(|crank| found.linkage.pressure_rad(crank).to_degrees());
    assert_near("stretched out", at_dead_centres[0], -20.0, 1e-9);
    assert_near("folded", at_dead_centres[1], 40.0 + found.theta_deg, 1e-9);
    let of_printed = Design {
        linkage: printed,
        ..found
    };
    let mean = of_printed.mean_pressure_deg();
    assert_near("mean, printed lengths", mean, 12.2533, 5e-5);
    assert_near("mean", found.mean_pressure_deg(), mean, 5e-4);

    let (min, max) = printed.pressure_range_rad();
    assert_near("largest, printed lengths", max.to_degrees(), 52.7171, 5e-5);
    assert_near("least, printed lengths", min.to_degrees(), -24.774, 5e-4);
    assert_near("least", pressure.min, min.to_degrees(), 2e-3);
    let folded = printed.pressure_rad(printed.dead_centres_rad()[1]);
    assert_near("folded, printed lengths", folded.to_degrees(), 49.475, 5e-4);
    let at = |degree: u32| {
        printed
            .pressure_rad(f64::from(degree).to_radians())
            .to_degrees()
    };
    let samples = || (0..=360).map(at);
    let mean = samples().sum::<f64>() / 361.0;
    assert_near("printed mean", mean, 12.1508, 5e-5);
    let places = 3600;
    let cycle = |of: fn(f64) -> f64| {
        let all = (0..places).map(|i| TAU * f64::from(i) / f64::from(places));
        all.map(|crank| of(printed.pressure_rad(crank).to_degrees()))
            .sum::<f64>()
            / f64::from(places)
    };
    assert_near("mean size", cycle(f64::abs), 24.954, 5e-4);
    assert_near("rms", cycle(|deg| deg * deg).sqrt(), 29.422, 5e-4);
}

/// Item 6.
#[test]
fn rocker_speed_acceleration_and_stroke() {
    let found = example();
    let (speed, acceleration) = (found.rocker_speed(), found.rocker_acceleration());
    assert_near("speed, largest", speed.max, 0.53075, 1e-4);
    assert_near("speed, least", speed.min, -0.50649, 1e-4);
    assert_near("acceleration, largest", acceleration.max, 0.69621, 1e-4);
    assert_near("acceleration, least", acceleration.min, -0.62101, 1e-4);
    assert_near("stroke", found.stroke_mm().unwrap(), 12.0 / 6.0, 1e-9);
}

/// If this fails, speed and acceleration do not match the angle. A central difference of step h is off by h²/6 of the third derivative,
/// here below 5.
#[test]
fn slope_and_curvature_are_derivatives_of_the_angle() {
    let step = 1e-4;
    for swing_deg in [20.0, 60.0, 100.0] {
        let found = design(&Requirement {
            swing_deg,
            pressure_deg: 0.3 * swing_deg,
            time_ratio: 0.93,
            screw_lead_mm: None,
        });
        let linkage = found.expect("a linkage").linkage;
        for degree in 0..360 {
            let angle = f64::from(degree).to_radians();
            let (before, here, after) = (
                linkage.at(angle - step),
                linkage.at(angle),
                linkage.at(angle + step),
            );
            let slope = (after.angle_rad - before.angle_rad) / (2.0 * step);
            let curvature = (after.slope - before.slope) / (2.0 * step);
            assert!((slope - here.slope).abs() < 1e-6, "{swing_deg}, {degree}°");
            assert!(
                (curvature - here.curvature).abs() < 1e-6,
                "{swing_deg}, {degree}°"
            );
            // The links keep their lengths.
            let pin = (linkage.crank * angle.cos(), linkage.crank * angle.sin());
            let end = (linkage.ground + here.angle_rad.cos(), here.angle_rad.sin());
            let coupler = (end.0 - pin.0).hypot(end.1 - pin.1);
            assert!((coupler - linkage.coupler).abs() < 1e-12);
        }
    }
}

/// Item 7, and numbers out of range. Each is refused by the name of the parameter.
#[test]
fn requirements_without_a_linkage_are_refused_by_name() {
    let refused = |change: fn(&mut Requirement)| {
        let mut requirement = EXAMPLE;
        change(&mut requirement);
        design(&requirement).expect_err("it has no linkage")
    };
    let error = refused(|it| it.pressure_deg = 30.0);
    assert!(matches!(error, DesignError::Pressure { .. }), "{error}");
    assert!(error.to_string().starts_with("--pressure-deg 30: "));
    for error in [
        refused(|it| it.time_ratio = 1.0),
        refused(|it| it.time_ratio = 1.2),
    ] {
        assert!(error.to_string().starts_with("--time-ratio 1"), "{error}");
    }
    for (time_ratio, swing) in [(0.7, 58.28), (0.6, 47.59)] {
        let error = design(&Requirement {
            pressure_deg: 0.0,
            time_ratio,
            ..EXAMPLE
        });
        let Err(DesignError::Branch { swing_deg, .. }) = error else {
            panic!("{time_ratio}: {error:?}");
        };
        assert_near("swing of a branch", swing_deg, swing, 5e-3);
    }
    let error = design(&Requirement {
        swing_deg: 29.0,
        pressure_deg: 0.0,
        time_ratio: 0.05,
        screw_lead_mm: None,
    });
    assert!(
        matches!(error, Err(DesignError::Grashof { .. })),
        "{error:?}"
    );
    let error = refused(|it| {
        *it = Requirement {
            swing_deg: f64::NAN,
            pressure_deg: -1.0,
            time_ratio: 0.0,
            screw_lead_mm: Some(0.0),
        }
    });
    let DesignError::OutOfRange(all) = &error else {
        panic!("{error}");
    };
    assert_eq!(all.len(), 4, "{error}");
}

/// Every accepted linkage swings as far as requested, in the requested time, and its crank turns all round.
#[test]
fn every_accepted_linkage_meets_its_requirement() {
    let (mut accepted, mut refused) = (0, 0);
    for swing_deg in (5..180).step_by(12).map(f64::from) {
        for part in [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
            for time_ratio in [0.05, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99] {
                let found = design(&Requirement {
                    swing_deg,
                    pressure_deg: 0.5 * swing_deg * part,
                    time_ratio,
                    screw_lead_mm: None,
                });
                let Ok(found) = found else {
                    refused += 1;
                    continue;
                };
                accepted += 1;
                let linkage = found.linkage;
                assert!(linkage.is_crank_rocker());
                // A separate search finds the extremes of the angle over a turn.
                let angles =
                    || (0..7200).map(|i| linkage.at(TAU * f64::from(i) / 7200.0).angle_rad);
                let (low, high) = (
                    angles().fold(f64::INFINITY, f64::min),
                    angles().fold(f64::NEG_INFINITY, f64::max),
                );
                let swing = (high - low).to_degrees();
                assert!((swing - swing_deg).abs() < 1e-3, "{found:?}: {swing}");
                assert!(
                    (linkage.time_ratio() - time_ratio).abs() < 1e-7,
                    "{found:?}"
                );
            }
        }
    }
    println!("{accepted} accepted, {refused} refused");
    assert!(accepted > 200 && refused > 50, "{accepted}, {refused}");
}
