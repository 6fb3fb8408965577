//! Inverse kinematics of the suspended five-bar arm: the joint angles for a place of the hand.
//!
//! The source is a paper of 2000 on suspended robots, which is appended to the source of the screen.

mod output;

use super::range::{OutOfRange, Range};
use crate::numbers::number;
use host_sim::mechanism::five_bar::{FiveBar, Joints, Unreachable};

/// Links of the arm, and the required place of its hand
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct Requirement {
    /// Length of the link at joint 1, m: above 0, up to 10
    #[arg(long, value_name = "L1", allow_hyphen_values = true, value_parser = number)]
    pub l1_m: f64,
    /// Length of the link at joint 2, m: above 0, up to 10
    #[arg(long, value_name = "L4", allow_hyphen_values = true, value_parser = number)]
    pub l4_m: f64,
    /// Place of the hand along x, m
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = number)]
    pub x_m: f64,
    /// Place of the hand along y, m
    #[arg(long, value_name = "Y", allow_hyphen_values = true, value_parser = number)]
    pub y_m: f64,
}

/// Reason why a requirement has no joint angles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Numbers out of their ranges: all of them, never empty. Prints a line each.
    #[error("{}", OutOfRange::lines(.0))]
    OutOfRange(Vec<OutOfRange>),
    /// The hand would be beyond the reach of both links.
    #[error(
        "--x-m {x_m}, --y-m {y_m}: {reach_m:.4} m from the axis, and --l1-m and --l4-m reach {max_m} m together; lengthen a link, or move \
         the point nearer"
    )]
    Beyond {
        /// Place of the hand, m.
        x_m: f64,
        /// See `x_m`.
        y_m: f64,
        /// Its distance from the axis, m.
        reach_m: f64,
        /// Length of both links, m.
        max_m: f64,
    },
    /// The hand would be nearer to the axis than the difference of the links.
    #[error(
        "--x-m {x_m}, --y-m {y_m}: {reach_m:.4} m from the axis, and --l1-m and --l4-m, which differ by {min_m} m, come no nearer than \
         that; make the links more alike, or move the point out"
    )]
    Within {
        /// Place of the hand, m.
        x_m: f64,
        /// See `x_m`.
        y_m: f64,
        /// Its distance from the axis, m.
        reach_m: f64,
        /// Difference of the links, m.
        min_m: f64,
    },
    /// The hand would be on the axis. Every angle is a solution.
    #[error(
        "--x-m 0, --y-m 0: on the axis itself every angle fits with links of equal length; give a point beside it"
    )]
    OnAxis,
}

/// Joint angles of an arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Requirement that it meets.
    pub requirement: Requirement,
    /// The arm.
    pub arm: FiveBar,
    /// Joint angles, one pair for each assembly mode: two, or one at the edge of the reach, where the arm is
    /// singular.
    pub solutions: Vec<Joints>,
}

impl Design {
    /// Distance of the point from the edge of the reach: ratio of |det J| to its largest value with these links, 0
    /// to 1.
    #[must_use]
    pub fn margin(&self) -> f64 {
        let det = self.arm.determinant_m2(self.solutions[0]);
        (det / (self.arm.l1_m * self.arm.l4_m)).abs()
    }
}

const fn link(flag: &'static str) -> Range {
    Range::above_zero(flag, 10.0, " m", "the lengths of links", 0.25)
}

const fn place(flag: &'static str) -> Range {
    Range {
        flag,
        low: -20.0,
        closed: true,
        high: 20.0,
        unit: " m",
        meaning: "what two links of 10 m reach",
        usual: 0.3,
    }
}

/// Joint angles for a place of the hand.
///
/// # Errors
/// Numbers out of their ranges, all of them; or the hand cannot be there.
pub fn design(requirement: &Requirement) -> Result<Design, DesignError> {
    let Requirement {
        l1_m,
        l4_m,
        x_m,
        y_m,
    } = *requirement;
    let wrong = OutOfRange::find_all([
        (link("--l1-m"), l1_m),
        (link("--l4-m"), l4_m),
        (place("--x-m"), x_m),
        (place("--y-m"), y_m),
    ]);
    if !wrong.is_empty() {
        return Err(DesignError::OutOfRange(wrong));
    }
    let arm = FiveBar { l1_m, l4_m };
    let both = arm
        .joints(x_m, y_m)
        .map_err(|unreachable| match unreachable {
            Unreachable::Beyond(reach_m) => DesignError::Beyond {
                x_m,
                y_m,
                reach_m,
                max_m: l1_m + l4_m,
            },
            Unreachable::Within(reach_m) => DesignError::Within {
                x_m,
                y_m,
                reach_m,
                min_m: (l1_m - l4_m).abs(),
            },
            Unreachable::OnAxis => DesignError::OnAxis,
        })?;
    let mut solutions = both.to_vec();
    solutions.dedup();
    Ok(Design {
        requirement: *requirement,
        arm,
        solutions,
    })
}
