//! Branch defect: the dead centres of a synthesized crank-rocker lie on two branches, and an assembly reaches only one of them.
//!
//! Failure: below a time ratio of 5/7, with a swing of 60° and a pressure angle of 0°, the synthesis gives lengths that satisfy
//! Grashof. But the assembled rocker swings by less than 60°: swing + Θ would exceed 90° at the folded dead centre. Guard: the design
//! method compares the swing of the assembled linkage with the requested one, and refuses the time ratio.

use super::panel::{Curve, Shown, failing, guarded, requested};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::ink::Ink;
use crate::chart::picture::Line;
use crate::design::crank_rocker::{DesignError, Requirement, design};

/// Requested swing of the rocker, degrees.
pub const SWING_DEG: f64 = 60.0;

/// Requirement with the pressure angle 0 where crank and coupler are stretched out.
pub fn requirement(time_ratio: f64) -> Requirement {
    Requirement {
        swing_deg: SWING_DEG,
        pressure_deg: 0.0,
        time_ratio,
        screw_lead_mm: None,
    }
}

/// Synthesis at a time ratio.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Ratio of the time of the forward stroke to that of the return.
    pub time_ratio: f64,
    /// Swing of the linkage as assembled, degrees.
    pub swing_deg: f64,
    /// Pressure angle at the folded dead centre, degrees; `None` if the design method refuses the linkage.
    pub folded_pressure_deg: Option<f64>,
}

impl Facts {
    /// True if the design method refuses the time ratio.
    pub fn is_refused(&self) -> bool {
        self.folded_pressure_deg.is_none()
    }
}

/// Synthesizes the linkage with a time ratio.
///
/// # Errors
/// The linkage is refused for another reason than its branches.
pub fn measure(time_ratio: f64) -> Result<Facts, ChartError> {
    match design(&requirement(time_ratio)) {
        Ok(found) => {
            let [_, folded] = found.linkage.dead_centres_rad();
            Ok(Facts {
                time_ratio,
                swing_deg: found.linkage.swing_rad().to_degrees(),
                folded_pressure_deg: Some(found.linkage.pressure_rad(folded).to_degrees()),
            })
        }
        Err(DesignError::Branch { swing_deg, .. }) => Ok(Facts {
            time_ratio,
            swing_deg,
            folded_pressure_deg: None,
        }),
        Err(error) => Err(error.into()),
    }
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let ratios = (0..=200_u32).map(|i| 0.55 + 0.44 * f64::from(i) / 200.0);
    let all: Vec<Facts> = ratios.map(measure).collect::<Result<_, _>>()?;
    let points = |is_refused: bool| -> Vec<(f64, f64)> {
        let of_kind = all.iter().filter(|facts| facts.is_refused() == is_refused);
        of_kind
            .map(|facts| (facts.time_ratio, facts.swing_deg))
            .collect()
    };
    let pressure = all
        .iter()
        .filter_map(|facts| Some((facts.time_ratio, facts.folded_pressure_deg?)));
    let (lower, upper) = (measure(0.6)?, measure(0.7)?);
    let from = all
        .iter()
        .find(|facts| !facts.is_refused())
        .map_or(f64::NAN, |facts| facts.time_ratio);
    Ok(Shown {
        key: "branch",
        title: "Branch defect: dead centres on two branches".to_owned(),
        x: Axis::linear("time ratio, forward stroke over return", 0.55, 1.0),
        y: Axis::linear("angle, °", 0.0, 95.0),
        curves: vec![
            Curve::new(
                "requested swing, °",
                requested(vec![(0.55, SWING_DEG), (1.0, SWING_DEG)]),
            ),
            Curve::new("swing as assembled, refused, °", failing(points(true))),
            Curve::new("swing as assembled, accepted, °", guarded(points(false))),
            Curve::new(
                "pressure angle at the folded dead centre, °",
                Line {
                    marked: false,
                    ..Line::new("", Ink::Green, pressure.collect())
                },
            ),
        ],
        levels: Vec::new(),
        says: format!(
            "A crank-rocker for {SWING_DEG}° swings by {:.2}° at a time ratio of 0.6 and by {:.2}° at 0.7: its dead centres lie on two branches, \
             although the crank turns all round; the design method refuses both and accepts ratios from {from:.3} on, where the pressure \
             angle at the folded dead centre nears 90°.",
            lower.swing_deg, upper.swing_deg
        ),
    })
}
