//! A screen as a page of text.

use std::io::{self, Write};

use cophase_scene::digits::four;

use super::Design;
use crate::design::page::row;

/// Designs that the source mixes: name, amplitude in mm, and the figures of the source that belong
/// to the design.
const SOURCE_DESIGNS: [(&str, f64, &str); 2] = [
    (
        "A",
        4.0,
        "speeds of 678 to 814 rpm, throw index 2.86 and 3.15, G R = 11.988 kg m",
    ),
    (
        "B",
        5.0,
        "the amplitude in its prose, the wheel's bore, shaft loads, G R = 14.487 kg m",
    ),
];

/// Writes the design as text.
///
/// # Errors
/// `out` cannot be written to.
pub fn write_page(design: &Design, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "Self-centring screen\n")?;
    let rows = [
        ("speed, rad/s", design.speed_rad_s(), ""),
        (
            "stiffness of all springs, kgf/cm",
            design.stiffness_kgf_per_cm(),
            "K = G ω²",
        ),
        ("natural speed, rpm", design.natural_speed_rpm(), ""),
        ("speed over natural speed", design.speed_ratio(), ""),
        ("amplitude, mm", design.amplitude_mm(), "G R / P"),
        (
            "the rim's centre circles at, mm",
            design.wheel_wobble_mm(),
            "0 if the wheel is bored off by the amplitude",
        ),
        ("throw index", design.throw_index(), ""),
        ("static deflection, mm", design.static_deflection_mm(), ""),
    ];
    for (what, value, note) in rows {
        row(out, what, &four(value), note)?;
    }
    if let Some([low, high]) = design.recommended_throw() {
        let throw = design.throw_index();
        let verdict = if throw < low {
            "below it"
        } else if throw > high {
            "above it"
        } else {
            "within it"
        };
        writeln!(
            out,
            "\n   Recommended throw index on this deck: {} to {}; {verdict}.",
            four(low),
            four(high)
        )?;
    }
    writeln!(out, "\n   The source mixes two designs:")?;
    for (name, amplitude_mm, figures) in SOURCE_DESIGNS {
        let is_this = (design.amplitude_mm() - amplitude_mm).abs() < 0.1;
        let mark = if is_this { " (this one)" } else { "" };
        writeln!(out, "   {name}, {amplitude_mm} mm{mark}: {figures}")?;
    }
    Ok(())
}
