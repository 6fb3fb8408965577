//! A screen as a page, as an object and as a scene.

use std::io::{self, Write};

use cophase_scene::digits::four;
use serde::Serialize;

use super::{Design, Requirement, design};
use crate::design::page::row;
use crate::design::{Method, Refused};

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

/// The object that `--json` prints.
#[derive(Serialize)]
pub struct Figures {
    speed_rad_s: f64,
    throw_index: f64,
    stiffness_kgf_per_cm: f64,
    natural_speed_rpm: f64,
    speed_ratio: f64,
    amplitude_mm: f64,
    wheel_wobble_mm: f64,
    static_deflection_mm: f64,
}

impl Method for Requirement {
    type Design = Design;
    type Figures = Figures;

    fn design(&self) -> Result<Design, Refused> {
        Ok(design(self)?)
    }

    fn figures(&self, design: &Design) -> Figures {
        Figures {
            speed_rad_s: design.speed_rad_s(),
            throw_index: design.throw_index(),
            stiffness_kgf_per_cm: design.stiffness_kgf_per_cm(),
            natural_speed_rpm: design.natural_speed_rpm(),
            speed_ratio: design.speed_ratio(),
            amplitude_mm: design.amplitude_mm(),
            wheel_wobble_mm: design.wheel_wobble_mm(),
            static_deflection_mm: design.static_deflection_mm(),
        }
    }

    fn write_page(&self, design: &Design, out: &mut dyn Write) -> io::Result<()> {
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

    fn scene(&self, design: &Design) -> Result<String, Refused> {
        Ok(design.scene())
    }
}
