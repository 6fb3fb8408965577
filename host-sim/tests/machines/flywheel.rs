//! Drive and flywheel of the jaw crusher, against the figures of its source and independently computed figures.

use cophase_lab::design::flywheel::{DesignError, Requirement, Rock, Shape, design, periodic};

use super::assert_near;

/// The source's crusher, between the fastest and the slowest printed speed.
const SOURCE: Requirement = Requirement {
    power_kw: 15.0,
    rated_rpm: 970.0,
    synchronous_rpm: 1000.0,
    overload: 2.0,
    belt_ratio: 3.7,
    mass_kg: 281.0,
    diameter_m: 0.762,
    speeds_rad_s: Some([28.303, 26.118]),
};

/// Items 1 and 2. The print has 28.3021 rad/s. 1000 rpm give 28.3026 rad/s.
#[test]
fn speeds_and_inertia() {
    let found = design(&SOURCE).expect("in range");
    assert_near("no load", found.synchronous_rad_s(), 28.3026, 5e-5);
    assert_near("rated", found.rated_rad_s(), 27.4536, 5e-5);
    assert_near("thin rim", found.rim_kgm2(), 40.790, 5e-4);
    assert_near("disc", found.disc_kgm2(), 20.40, 5e-3);
}

/// Item 3.
#[test]
fn torque_of_the_motor_and_on_the_shaft() {
    let found = design(&SOURCE).expect("in range");
    assert_near("rated", found.rated_torque_nm(), 147.68, 5e-3);
    assert_near("breakdown", found.breakdown_torque_nm(), 295.36, 5e-3);
    assert_near(
        "speed at breakdown",
        found.breakdown_motor_rad_s(),
        92.995,
        5e-4,
    );
    let published = [-2.541836, 477.3673, -22115.44];
    for (ours, theirs) in found.curve.coefficients.into_iter().zip(published) {
        assert_near("coefficient", ours, theirs, 1e-6 * theirs.abs());
    }
    assert_near("shaft, rated", found.shaft_torque_nm(27.4535), 546.5, 0.06);
    assert_near("shaft, slowest", found.shaft_torque_nm(26.118), 1030.0, 0.5);
}

/// Item 4. The source divides by its mean over time, 27.647 rad/s, and not by the middle of both speeds. The energy is that of 40.9 kg·m².
#[test]
fn irregularity_and_energy() {
    let found = design(&SOURCE).expect("in range");
    let irregularity = found.irregularity().expect("speeds are given");
    let middle = 0.5 * (28.303 + 26.118);
    assert_near("irregularity", irregularity * middle / 27.647, 0.0790, 5e-5);
    let energy_j = found.energy_swing_j().expect("speeds are given");
    assert_near("energy", energy_j * 40.9 / found.rim_kgm2(), 2431.7, 0.05);
}

/// Values that contradict each other, or are out of range, are refused by name.
#[test]
fn contradictory_values_are_refused_by_name() {
    let refused = |change: fn(&mut Requirement)| {
        let mut requirement = SOURCE;
        change(&mut requirement);
        design(&requirement).expect_err("it does not go together")
    };
    let error = refused(|it| it.rated_rpm = 1000.0);
    assert!(matches!(error, DesignError::NoSlip { .. }), "{error}");
    let error = refused(|it| it.rated_rpm = 600.0);
    assert!(matches!(error, DesignError::Slip(_)), "{error}");
    let error = refused(|it| it.speeds_rad_s = Some([26.0, 28.0]));
    assert!(matches!(error, DesignError::Order { .. }), "{error}");
    let error = refused(|it| (it.power_kw, it.overload, it.belt_ratio) = (0.0, 1.0, f64::NAN));
    assert_eq!(error.to_string().lines().count(), 3, "{error}");
}

/// Rock of the source's crusher, with the given number of nodes a turn.
fn rock(nodes: u32, irregularity: Option<f64>) -> Rock {
    Rock {
        shape: Shape::LinearRise,
        peak_kn: 1500.0,
        nodes,
        irregularity,
    }
}

/// If this fails, the source's scheme does not approach the converged solution with more nodes, or one of them solves another equation.
#[test]
fn more_nodes_approach_the_converged_speeds() {
    let found = design(&SOURCE).expect("in range");
    let slowest = |nodes: u32| {
        let dynamic = periodic(&found, &rock(nodes, None)).expect("it turns");
        let by_nodes = dynamic.by_nodes.expect("it turns").slowest_rad_s();
        (by_nodes - dynamic.converged.slowest_rad_s()).abs()
    };
    let (few, many) = (slowest(18), slowest(1800));
    println!("18 nodes are off by {few:.4} rad/s, 1800 by {many:.6}");
    // The scheme is of first order: the error falls to a hundredth.
    assert!(
        few > 0.02 && (0.005..0.02).contains(&(many / few)),
        "{few}, {many}"
    );
}

/// If this fails, the flywheel that is found does not keep the irregularity, or a lighter one does.
#[test]
fn the_required_flywheel_keeps_the_irregularity() {
    let found = design(&SOURCE).expect("in range");
    let limit = 0.05;
    let required = periodic(&found, &rock(18, Some(limit))).expect("it turns");
    let required_kgm2 = required.required_kgm2.expect("requested");
    for (factor, keeps) in [(1.000_001, true), (0.999, false)] {
        let mut heavier = SOURCE;
        heavier.mass_kg *= factor * required_kgm2 / found.rim_kgm2();
        let heavier = design(&heavier).expect("in range");
        let speeds = periodic(&heavier, &rock(18, None))
            .expect("it turns")
            .converged;
        assert_eq!(
            speeds.irregularity() <= limit,
            keeps,
            "{}",
            speeds.irregularity()
        );
    }
}

/// If this fails, rock that the motor cannot break gets a flywheel, or the message does not name the flag.
#[test]
fn too_much_rock_is_refused() {
    let found = design(&SOURCE).expect("in range");
    let heavy = Rock {
        peak_kn: 9000.0,
        ..rock(18, None)
    };
    let refused = periodic(&found, &heavy).expect_err("it stalls").to_string();
    assert!(refused.starts_with("--rock-kn 9000: "), "{refused}");
    let wrong = periodic(&found, &rock(3, Some(0.9))).expect_err("out of range");
    let lines = wrong.to_string();
    assert!(
        lines.contains("--nodes 3") && lines.contains("--irregularity 0.9"),
        "{lines}"
    );
}
