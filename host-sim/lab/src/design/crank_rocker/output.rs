//! A crank-rocker as a page, as an object, as a scene and as a drawing.

use std::io::{self, Write};
use std::path::PathBuf;

use cophase_scene::digits::four;
use serde::Serialize;

use super::{CrankRocker, Design, design};
use crate::design::page::row;
use crate::design::{Method, Refused};

/// The object that `--json` prints. Lengths are relative to that of the rocker.
#[derive(Serialize)]
pub struct Figures {
    crank_ratio: f64,
    coupler_ratio: f64,
    ground_ratio: f64,
    theta_deg: f64,
    grashof_margin: f64,
    dead_centre_deg: [f64; 2],
    swing_deg: f64,
    time_ratio: f64,
    pressure_max_deg: f64,
    pressure_min_deg: f64,
    pressure_mean_deg: f64,
    rocker_speed_max: f64,
    rocker_speed_min: f64,
    rocker_acceleration_max: f64,
    rocker_acceleration_min: f64,
    /// `None` without a screw.
    stroke_mm: Option<f64>,
}

impl Method for CrankRocker {
    type Design = Design;
    type Figures = Figures;

    fn design(&self) -> Result<Design, Refused> {
        Ok(design(&self.requirement)?)
    }

    fn figures(&self, design: &Design) -> Figures {
        let linkage = &design.linkage;
        let (pressure, speed) = (design.pressure_deg(), design.rocker_speed());
        let acceleration = design.rocker_acceleration();
        Figures {
            crank_ratio: linkage.crank,
            coupler_ratio: linkage.coupler,
            ground_ratio: linkage.ground,
            theta_deg: design.theta_deg,
            grashof_margin: linkage.grashof_margin(),
            dead_centre_deg: design.dead_centres_deg(),
            swing_deg: linkage.swing_rad().to_degrees(),
            time_ratio: linkage.time_ratio(),
            pressure_max_deg: pressure.max,
            pressure_min_deg: pressure.min,
            pressure_mean_deg: design.mean_pressure_deg(),
            rocker_speed_max: speed.max,
            rocker_speed_min: speed.min,
            rocker_acceleration_max: acceleration.max,
            rocker_acceleration_min: acceleration.min,
            stroke_mm: design.stroke_mm(),
        }
    }

    fn write_page(&self, design: &Design, out: &mut dyn Write) -> io::Result<()> {
        let linkage = &design.linkage;
        let degrees = |angle_deg: f64| format!("{angle_deg:.3}");
        writeln!(out, "Crank-rocker; lengths are over the rocker's\n")?;
        let mut line = |what: &str, value: String, note: &str| row(out, what, &value, note);
        line("crank", format!("{:.5}", linkage.crank), "")?;
        line("coupler", format!("{:.5}", linkage.coupler), "")?;
        line("ground", format!("{:.5}", linkage.ground), "")?;
        line(
            "Grashof margin",
            format!("{:.5}", linkage.grashof_margin()),
            "above 0, so that the crank turns all round",
        )?;
        let [stretched, folded] = design.dead_centres_deg();
        line(
            "dead centre, stretched out, deg",
            degrees(stretched),
            "crank angle from the ground line",
        )?;
        line("dead centre, folded, deg", degrees(folded), "")?;
        line("angle between them, Θ, deg", degrees(design.theta_deg), "")?;
        line(
            "swing of the rocker, deg",
            degrees(linkage.swing_rad().to_degrees()),
            "",
        )?;
        line(
            "time ratio",
            four(linkage.time_ratio()),
            "forward over return",
        )?;
        let pressure = design.pressure_deg();
        line("pressure angle, largest, deg", degrees(pressure.max), "")?;
        line("… least, deg", degrees(pressure.min), "")?;
        line(
            "… mean over a turn, deg",
            degrees(design.mean_pressure_deg()),
            "signed",
        )?;
        let (speed, acceleration) = (design.rocker_speed(), design.rocker_acceleration());
        line(
            "rocker speed, largest",
            four(speed.max),
            "times the crank's",
        )?;
        line("… least", four(speed.min), "")?;
        line(
            "rocker acceleration, largest",
            four(acceleration.max),
            "times the crank speed squared",
        )?;
        line("… least", four(acceleration.min), "")?;
        if let Some(stroke_mm) = design.stroke_mm() {
            line("stroke of the screw's rod, mm", four(stroke_mm), "")?;
        }
        Ok(())
    }

    fn scene(&self, design: &Design) -> Result<String, Refused> {
        Ok(design.scene()?)
    }

    fn drawing(&self, design: &Design) -> Result<Option<(PathBuf, String)>, Refused> {
        Ok(self.svg.clone().map(|file| (file, design.linkage.draw())))
    }
}
