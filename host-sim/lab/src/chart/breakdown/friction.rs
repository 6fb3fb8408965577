//! Dry friction that is smoothed over a speed, on a mass that sticks and slips.
//!
//! Failure: a smooth reversal of friction has an error that no step removes, as the mass drifts where it should stick. The less it is
//! smoothed, the shorter the step has to be: beyond 2.79 relaxation times RK4 shakes. Guard: contacts that stick or
//! slide ([`cophase_methods::friction`]), which all methods use. Then friction neither has an error of its own nor limits the step.

use cophase_methods::problems::DenHartog;
use cophase_methods::problems::den_hartog::Smoothed;
use cophase_methods::{Equations, Scheme};

use super::panel::{Curve, Shown};
use crate::chart::axis::Axis;
use crate::chart::ink::{Ink, Stroke};
use crate::chart::picture::{Level, Line};
use crate::chart::{ChartError, Size};

/// Duration of a run, s, and the moments at which it is compared with the formula.
const END_S: f64 = 0.4;
const MOMENTS: u32 = 50;

/// Speeds over which friction is smoothed, m/s. The mass moves at up to 0.04 m/s.
pub const SPEEDS_MPS: [f64; 2] = [4e-3, 4e-4];

/// Steps between two moments, as powers of two: the fewest, and the most.
const MIN: u32 = 0;
const MAX: u32 = 9;

/// Relaxation times in a step, up to which RK4 is stable.
const RK4_LIMIT: f64 = 2.785;

/// Treatment of friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Treatment {
    /// Contacts that stick or slide.
    Contacts,
    /// A smooth reversal over a speed, m/s.
    Smoothed(f64),
}

/// Errors of a method with a treatment of friction.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Method.
    pub scheme: Scheme,
    /// Treatment of friction.
    pub treatment: Treatment,
    /// Step, s, and largest error, of F/ω², by steps; an infinite one where a step failed.
    pub errors: Vec<(f64, f64)>,
}

/// Returns the largest error of a method, of F/ω².
fn error(scheme: Scheme, treatment: Treatment, steps: u32) -> Result<f64, ChartError> {
    let oscillator = DenHartog::STOPPING;
    let unit_m = oscillator.friction / oscillator.omega_rad_s.powi(2);
    let smoothed;
    let equations: &dyn Equations = match treatment {
        Treatment::Contacts => &oscillator,
        Treatment::Smoothed(speed_mps) => {
            smoothed = Smoothed {
                oscillator,
                speed_mps,
            };
            &smoothed
        }
    };
    let step_s = END_S / f64::from(MOMENTS * steps);
    let mut method = scheme.prepare(equations, step_s)?;
    let mut state = [0.0; 2];
    let mut max_m: f64 = 0.0;
    for step in 0..MOMENTS * steps {
        if method
            .step(equations, f64::from(step) * step_s, &mut state)
            .is_err()
        {
            return Ok(f64::INFINITY);
        }
        if (step + 1).is_multiple_of(steps) {
            let right = oscillator.exact(f64::from(step + 1) * step_s, [0.0; 2]);
            max_m = max_m.max((state[0] - right[0]).abs());
        }
    }
    Ok(max_m / unit_m)
}

/// Tries all treatments, the coarsest step first.
///
/// # Errors
/// A method is not for this machine; all are.
pub fn measure(size: Size) -> Result<Vec<Tried>, ChartError> {
    let max = match size {
        Size::Small => MAX - 3,
        Size::Full => MAX,
    };
    let [wide, narrow] = SPEEDS_MPS.map(Treatment::Smoothed);
    let tried = [
        (Scheme::Rk4, wide),
        (Scheme::Rk4, narrow),
        (Scheme::Sdirk4, narrow),
        (Scheme::Sdirk4, Treatment::Contacts),
        (Scheme::Rk4, Treatment::Contacts),
    ];
    let tried = tried.map(|(scheme, treatment)| {
        let errors = (MIN..=max).map(|power| {
            let steps = 1 << power;
            let step_s = END_S / f64::from(MOMENTS * steps);
            Ok((step_s, error(scheme, treatment, steps)?))
        });
        Ok(Tried {
            scheme,
            treatment,
            errors: errors.collect::<Result<_, ChartError>>()?,
        })
    });
    tried.into_iter().collect()
}

/// Returns the longest stable step of RK4 with friction smoothed over a speed, s.
pub fn limit_s(speed_mps: f64) -> f64 {
    RK4_LIMIT * speed_mps / DenHartog::STOPPING.friction
}

pub(super) fn shown(size: Size) -> Result<Shown, ChartError> {
    let tried = measure(size)?;
    let min = |scheme: Scheme, treatment: Treatment| {
        let found = tried
            .iter()
            .find(|tried| (tried.scheme, tried.treatment) == (scheme, treatment));
        let errors = found.into_iter().flat_map(|tried| &tried.errors);
        errors
            .map(|(_, error)| *error)
            .fold(f64::INFINITY, f64::min)
    };
    let [wide, narrow] = SPEEDS_MPS;
    let levels = SPEEDS_MPS.map(|speed_mps| {
        Level::at_x(
            limit_s(speed_mps) * 1e3,
            format!("{} mm/s", speed_mps * 1e3),
        )
    });
    Ok(Shown {
        key: "friction",
        title: "A mass that sticks and slips, its friction smoothed".to_owned(),
        x: Axis::log(
            "step, ms; limits of RK4 where friction is smoothed",
            0.01,
            10.0,
        ),
        y: Axis::log(
            "largest error, of the spring's stretch by friction",
            1e-11,
            10.0,
        ),
        curves: tried.iter().map(curve).collect(),
        levels: levels.into(),
        says: format!(
            "Friction smoothed over {} mm/s is off by {:.1e} of its own stretch of the spring however short the step, over {} mm/s by \
             {:.1e}; beyond {:.2} ms RK4 shakes there, and contacts that stick or slide have no such error: RK4 comes to {:.0e}, SDIRK4 to \
             {:.0e}.",
            wide * 1e3,
            min(Scheme::Rk4, Treatment::Smoothed(wide)),
            narrow * 1e3,
            min(Scheme::Rk4, Treatment::Smoothed(narrow)),
            limit_s(narrow) * 1e3,
            min(Scheme::Rk4, Treatment::Contacts),
            min(Scheme::Sdirk4, Treatment::Contacts),
        ),
    })
}

fn curve(tried: &Tried) -> Curve {
    let points: Vec<_> = (tried.errors.iter())
        .map(|(step_s, error)| (step_s * 1e3, *error))
        .collect();
    let (ink, stroke, by) = match tried.treatment {
        Treatment::Contacts => (Ink::Blue, Stroke::Solid, "contacts".to_owned()),
        Treatment::Smoothed(speed_mps) => {
            let ink = if speed_mps == SPEEDS_MPS[0] {
                Ink::Orange
            } else {
                Ink::Vermilion
            };
            (ink, Stroke::Solid, format!("over {} mm/s", speed_mps * 1e3))
        }
    };
    let stroke = if tried.scheme == Scheme::Sdirk4 {
        Stroke::Dashed
    } else {
        stroke
    };
    Curve::new(
        format!("{}, {by}", tried.scheme),
        Line {
            stroke,
            chosen: (tried.scheme, tried.treatment) == (Scheme::Rk4, Treatment::Contacts),
            ..Line::new("", ink, points)
        },
    )
}
