//! Joint angles as a page of text.

use std::io::{self, Write};

use cophase_scene::digits::four;

use super::Design;

/// Writes the page.
///
/// # Errors
/// `out` cannot be written to.
pub fn write_page(design: &Design, out: &mut impl Write) -> io::Result<()> {
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
