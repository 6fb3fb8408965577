//! `cophase design five-bar`: joint angles for a position of the hand.

use std::io::Write;

use host_sim::design::five_bar::{Design, Requirement, design, write_page};
use serde::Serialize;

use super::{DesignCommandError, write_json};
use crate::numbers::number;

/// Find the joint angles of a suspended five-bar arm for a place of its hand
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct FiveBarArgs {
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

/// The object that `--json` prints.
#[derive(Serialize)]
struct Figures {
    solutions: Vec<Solution>,
}

/// One assembly mode.
#[derive(Serialize)]
struct Solution {
    q1_deg: f64,
    q2_deg: f64,
    det_j_m2: f64,
}

impl From<&Design> for Figures {
    fn from(design: &Design) -> Self {
        let solutions = design.solutions.iter().map(|&joints| Solution {
            q1_deg: joints.q1_rad.to_degrees(),
            q2_deg: joints.q2_rad.to_degrees(),
            det_j_m2: design.arm.determinant_m2(joints),
        });
        Self {
            solutions: solutions.collect(),
        }
    }
}

/// Finds the angles and writes text, or with `json` one object, to `out`.
///
/// # Errors
/// Bad input, before anything is written; or `out` cannot be written.
pub fn run(args: &FiveBarArgs, json: bool, out: &mut impl Write) -> Result<(), DesignCommandError> {
    let found = design(&Requirement {
        l1_m: args.l1_m,
        l4_m: args.l4_m,
        x_m: args.x_m,
        y_m: args.y_m,
    })
    .map_err(DesignCommandError::input)?;
    if json {
        write_json(&Figures::from(&found), out)
    } else {
        Ok(write_page(&found, out)?)
    }
}
