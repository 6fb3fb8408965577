//! Error of the two-term formula at both ends of the range of λ.
//!
//! Failure: at λ = 0.6, the error of its acceleration is 9.4 % of amax, at 90°. Guards: the simulator has the exact mechanism, and
//! a λ outside 0.1 to 0.6 is refused with the range in the message.

use super::panel::{Curve, Shown, failing, guarded};
use crate::chart::ChartError;
use crate::chart::axis::Axis;
use crate::chart::ink::Stroke;
use crate::chart::picture::{Level, Line};
use host_sim::mechanism::Mechanism;
use host_sim::mechanism::slider_crank::SliderCrank;

/// Returns a scene with λ.
pub fn scene(lambda: f64) -> String {
    super::root::SCENE.replace("lambda = 0.25", &format!("lambda = {lambda}"))
}

/// Mechanism at an end of the range.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Crank radius over rod length.
    pub lambda: f64,
    /// Greatest error of the two-term acceleration, relative to amax.
    pub error: f64,
    /// Crank angle of it, degrees.
    pub at_deg: f64,
    mechanism: SliderCrank,
}

/// Returns the mechanism with λ.
///
/// # Errors
/// There is no such mechanism.
pub fn measure(lambda: f64) -> Result<Facts, ChartError> {
    let mechanism = SliderCrank::new(0.010, 0.010 / lambda)?;
    let worst = mechanism.two_term_error();
    Ok(Facts {
        lambda,
        error: worst.value,
        at_deg: worst.alpha_rad.to_degrees(),
        mechanism,
    })
}

pub(super) fn shown() -> Result<Shown, ChartError> {
    let ends = [measure(0.1)?, measure(0.6)?];
    let mut curves = Vec::new();
    for facts in &ends {
        let over_a_turn = |of: fn(&SliderCrank, f64) -> f64| -> Vec<(f64, f64)> {
            let angles = (0..=180_u32).map(|i| 2.0 * f64::from(i));
            angles
                .map(|deg| (deg, of(&facts.mechanism, deg.to_radians())))
                .collect()
        };
        let name = |what: &str| format!("λ = {}, {what}, a/Rω²", facts.lambda);
        let stroke = if facts.lambda < 0.3 {
            Stroke::Dashed
        } else {
            Stroke::Solid
        };
        let drawn = |line: Line| Line { stroke, ..line };
        curves.push(Curve::new(
            name("two terms"),
            drawn(failing(over_a_turn(SliderCrank::h_two_term))),
        ));
        curves.push(Curve::new(
            name("exact"),
            drawn(guarded(over_a_turn(SliderCrank::h))),
        ));
    }
    Ok(Shown {
        key: "lambda",
        title: "λ at both ends: two terms and exact".to_owned(),
        x: Axis::linear("crank angle, °", 0.0, 360.0),
        y: Axis::linear("acceleration, of R ω²", -1.5, 2.0),
        curves,
        levels: vec![Level::at_x(90.0, "worst")],
        says: format!(
            "Two terms are off by {:.3} % of amax at λ = 0.1 (dashed) and by {:.3} % at 0.6 (solid), both at 90°; λ outside of these is refused.",
            100.0 * ends[0].error,
            100.0 * ends[1].error
        ),
    })
}
