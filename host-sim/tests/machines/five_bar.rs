//! Kinematics of the five-bar arm, against figures computed from its source.

use cophase_lab::design::five_bar::{DesignError, Requirement, design};
use host_sim::mechanism::five_bar::{FiveBar, Joints};

const ARM: FiveBar = FiveBar {
    l1_m: 0.25,
    l4_m: 0.25,
};

/// Item 4: the point at which the source's horizontal path begins.
#[test]
fn joints_at_the_beginning_of_the_path() {
    let found = design(&Requirement {
        l1_m: 0.25,
        l4_m: 0.25,
        x_m: 0.0,
        y_m: 0.3,
    })
    .expect("the hand reaches it");
    let degrees: Vec<[f64; 2]> = found
        .solutions
        .iter()
        .map(|joints| [joints.q1_rad, joints.q2_rad].map(f64::to_degrees))
        .collect();
    assert_eq!(degrees.len(), 2);
    for (found, published) in degrees.iter().zip([[143.130, 36.870], [36.870, 143.130]]) {
        for (found, published) in found.iter().zip(published) {
            assert!((found - published).abs() < 5e-4, "{found}, {published}");
        }
    }
    // The published 0.06 m² has no sign. The two modes have one sign each.
    for (joints, sign) in found.solutions.iter().zip([-1.0, 1.0]) {
        let det = ARM.determinant_m2(*joints);
        assert!((det - sign * 0.06).abs() < 1e-12, "{det}");
    }
}

/// Item 3. The Jacobian is compared with differences of the hand's position, whose error is h²/6 of the third
/// derivative.
#[test]
fn inverse_kinematics_and_jacobian_match_the_hand_position() {
    let step = 1e-5;
    for (l1_m, l4_m) in [(0.25, 0.25), (0.3, 0.2), (0.1, 0.35)] {
        let arm = FiveBar { l1_m, l4_m };
        for place in 0..4000_u32 {
            let turn = f64::from(place) * 0.01;
            let reach = (l1_m - l4_m).abs()
                + 1e-3
                + (2.0 * l1_m.min(l4_m) - 2e-3) * f64::from(place % 97) / 96.0;
            let (x_m, y_m) = (reach * turn.cos(), reach * turn.sin());
            for joints in arm.joints(x_m, y_m).expect("within reach") {
                let [x, y] = arm.hand_m(joints);
                assert!((x - x_m).abs() < 1e-9 && (y - y_m).abs() < 1e-9);
                let moved = |q1: f64, q2: f64| {
                    arm.hand_m(Joints {
                        q1_rad: joints.q1_rad + q1,
                        q2_rad: joints.q2_rad + q2,
                    })
                };
                let jacobian = arm.jacobian_m(joints);
                for (column, (q1, q2)) in [(step, 0.0), (0.0, step)].into_iter().enumerate() {
                    let (after, before) = (moved(q1, q2), moved(-q1, -q2));
                    for row in 0..2 {
                        let slope = (after[row] - before[row]) / (2.0 * step);
                        assert!((slope - jacobian[row][column]).abs() < 1e-9);
                    }
                }
            }
        }
    }
}

/// Unreachable points are refused by name. The edge of the reach has one assembly mode, which is singular.
#[test]
fn unreachable_points_are_refused_and_the_edge_is_singular() {
    let at = |l1_m, l4_m, x_m, y_m| {
        design(&Requirement {
            l1_m,
            l4_m,
            x_m,
            y_m,
        })
    };
    assert!(matches!(
        at(0.25, 0.25, 0.4, 0.4),
        Err(DesignError::Beyond { .. })
    ));
    assert!(matches!(
        at(0.3, 0.1, 0.1, 0.0),
        Err(DesignError::Within { .. })
    ));
    assert!(matches!(at(0.25, 0.25, 0.0, 0.0), Err(DesignError::OnAxis)));
    let edge = at(0.25, 0.25, 0.5, 0.0).expect("the edge is reached");
    assert_eq!(edge.solutions.len(), 1);
    assert!(edge.margin() < 1e-9);
    let error = at(0.0, f64::NAN, 30.0, 0.0).expect_err("three are out of range");
    assert_eq!(error.to_string().lines().count(), 3, "{error}");
    // Every point of the source's paths needs links of more than 0.3945 m together.
    let places = [
        (0.0, 0.3),
        (0.2, 0.3),
        (0.3, 0.0),
        (0.3, 0.1),
        (0.1, 0.34),
        (0.2, 0.34),
        (0.28, 0.22),
        (0.28, 0.26),
    ];
    let all = |link_m| {
        places
            .iter()
            .all(|&(x, y)| at(link_m, link_m, x, y).is_ok())
    };
    assert!(all(0.3946 / 2.0) && !all(0.3944 / 2.0));
}
