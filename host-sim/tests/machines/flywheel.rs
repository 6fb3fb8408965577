//! Drive and flywheel of the jaw crusher, against the figures of its source and those computed independently.

use host_sim::design::flywheel::{DesignError, Requirement, design};

use super::assert_near;

/// The source's crusher, between the fastest and the slowest speed that it prints.
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

/// Items 1 and 2. The print has 28.3021 rad/s where 1000 rpm give 28.3026.
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

/// What does not go together is refused by name, as is what is out of range.
#[test]
fn what_does_not_go_together_is_refused_by_name() {
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
