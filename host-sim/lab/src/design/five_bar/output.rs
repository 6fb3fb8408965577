//! Joint angles as a page and as an object.

use std::io::{self, Write};

use cophase_scene::digits::four;
use serde::Serialize;

use super::{Design, Requirement, design};
use crate::design::{Method, Refused, no_scene};

/// The object that `--json` prints.
#[derive(Serialize)]
pub struct Figures {
    solutions: Vec<Solution>,
}

/// One assembly mode.
#[derive(Serialize)]
struct Solution {
    q1_deg: f64,
    q2_deg: f64,
    det_j_m2: f64,
}

impl Method for Requirement {
    type Design = Design;
    type Figures = Figures;

    fn design(&self) -> Result<Design, Refused> {
        Ok(design(self)?)
    }

    fn figures(&self, design: &Design) -> Figures {
        let solutions = design.solutions.iter().map(|&joints| Solution {
            q1_deg: joints.q1_rad.to_degrees(),
            q2_deg: joints.q2_rad.to_degrees(),
            det_j_m2: design.arm.determinant_m2(joints),
        });
        Figures {
            solutions: solutions.collect(),
        }
    }

    fn write_page(&self, design: &Design, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "Five-bar arm, hand at ({}, {}) m\n",
            design.requirement.x_m, design.requirement.y_m
        )?;
        writeln!(out, "   assembly mode      q1, deg     q2, deg   det J, m²")?;
        for (mode, joints) in design.solutions.iter().enumerate() {
            writeln!(
                out,
                "   {:<14}{:>12.3}{:>12.3}{:>12}",
                mode + 1,
                joints.q1_rad.to_degrees(),
                joints.q2_rad.to_degrees(),
                four(design.arm.determinant_m2(*joints))
            )?;
        }
        writeln!(
            out,
            "\n   |det J| is {} of its largest; it is 0 at the edge of the reach, where the arm is singular.",
            four(design.margin())
        )
    }

    fn scene(&self, _: &Design) -> Result<String, Refused> {
        Err(no_scene("five-bar"))
    }
}
