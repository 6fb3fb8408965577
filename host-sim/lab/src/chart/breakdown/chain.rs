//! Stiff chain of a cam follower, with steps that are doubled until it diverges.
//!
//! Failure: beyond its limit, an explicit method diverges within a turn of the cam, although the step resolves the motion. Guards: a
//! scene with such a step is refused with the limit in the message, and `auto` takes a method without a limit.

use cophase_methods::problems::{Cam, Chain, Law, Shaft};
use cophase_methods::{Scheme, StepError};

use super::panel::{Curve, Shown};
use crate::chart::axis::Axis;
use crate::chart::picture::{Level, Line};
use crate::chart::{ChartError, Size};

const SCENE: &str = r#"
name = "chain"
fidelity = "elastic"
[method]
METHOD
[cam]
law = "modified-sine"
rise_mm = 84
rise_deg = 120
dwell_deg = 135
return_deg = 105
masses_kg = [0.525, 0.102, 1.01]
stiffness_n_per_mm = [7680, 7500, 102000]
dampers_ns_per_m = [402, 175, 2030]
[limits]
speed_hz = 8
acceleration_hz_per_s = 20
jerk_hz_per_s2 = 400
homing_speed_hz = 5
[axes]
count = 3
drive = "servo"
steps_per_turn = 8192
[[program]]
amax_g = 31.31
ramp_s = 0.5
hold_s = 0.3
"#;

/// Returns a scene of the article's machine, with a method.
pub fn scene(method: &str) -> String {
    SCENE.replace("METHOD", method)
}

/// Steps per turn of the cam, as powers of two: the coarsest, and the finest shown.
const COARSEST: u32 = 6;
const FINEST: u32 = 14;
/// Steps per turn for the true peak, as a power of two.
const TRUE: u32 = 16;

/// Turn of the cam with a step.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Step, s.
    pub step_s: f64,
    /// Largest deviation of the pusher from its law, over the true one; infinite if it diverged.
    pub peak: f64,
    /// Time at which it diverged.
    pub diverged: Option<StepError>,
}

/// Results of a method.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Method.
    pub scheme: Scheme,
    /// Longest stable step, s; `None` if there is no limit up to 10 ms.
    pub limit_s: Option<f64>,
    /// Turns by step, the shortest first.
    pub turns: Vec<Turn>,
}

/// Measured results.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Largest deviation of the pusher from its law, m.
    pub true_m: f64,
    /// All methods.
    pub methods: Vec<Tried>,
}

/// Returns the largest deviation from the law in a turn from rest, or the time at which it diverged.
fn peak_m(
    chain: &Chain,
    scheme: Scheme,
    steps: u32,
) -> Result<(f64, Option<StepError>), ChartError> {
    let step_s = chain.cam.cycle_s() / f64::from(steps);
    let mut method = scheme.prepare(chain, step_s)?;
    let mut state = [0.0; 6];
    let mut peak_m: f64 = 0.0;
    for step in 0..steps {
        if let Err(error) = method.step(chain, f64::from(step) * step_s, &mut state) {
            return Ok((f64::INFINITY, Some(error)));
        }
        let law = chain.cam.at(f64::from(step + 1) * step_s);
        peak_m = peak_m.max((state[2] - law.displacement).abs());
    }
    Ok((peak_m, None))
}

/// Tries all methods.
///
/// # Errors
/// A method is not for this machine; all are.
pub fn measure(size: Size) -> Result<Facts, ChartError> {
    let chain = Chain::wrapper(Cam::wrapper(Law::ModifiedSine), Shaft::DampedToCam);
    let (true_m, _) = peak_m(&chain, Scheme::Exact, 1 << TRUE)?;
    let finest = match size {
        Size::Small => FINEST - 1,
        Size::Full => FINEST,
    };
    let mut methods = Vec::new();
    for scheme in Scheme::ALL {
        let limit_s = scheme.longest_stable_step_s(&chain, 1e-8, 1e-2)?;
        let mut turns = Vec::new();
        for power in (COARSEST..=finest).rev() {
            let (found_m, diverged) = peak_m(&chain, scheme, 1 << power)?;
            turns.push(Turn {
                step_s: chain.cam.cycle_s() / f64::from(1 << power),
                peak: found_m / true_m,
                diverged,
            });
        }
        methods.push(Tried {
            scheme,
            limit_s,
            turns,
        });
    }
    Ok(Facts { true_m, methods })
}

/// Error above which a method counts as diverged. It is drawn at the top.
const TOP: f64 = 1000.0;

pub(super) fn shown(size: Size) -> Result<Shown, ChartError> {
    let facts = measure(size)?;
    let limited = facts
        .methods
        .iter()
        .filter_map(|tried| Some((tried.scheme, tried.limit_s?)));
    let limits: Vec<String> = limited
        .clone()
        .map(|(scheme, limit_s)| format!("{scheme} {:.1}", limit_s * 1e6))
        .collect();
    let levels = limited.filter_map(|(scheme, limit_s)| {
        let label = match scheme {
            Scheme::ExplicitEuler => "Euler",
            Scheme::Rk4 => "RK4",
            _ => return None,
        };
        Some(Level::at_x(limit_s * 1e6, label))
    });
    let without = facts.methods.iter().filter(|tried| tried.limit_s.is_none());
    let coarsest = without.filter_map(|tried| Some((tried.scheme, tried.turns.last()?)));
    let step_ms = coarsest
        .clone()
        .fold(0.0, |max: f64, (_, turn)| max.max(turn.step_s * 1e3));
    let missed: Vec<String> = coarsest
        .map(|(scheme, turn)| format!("{scheme} {:.2}", turn.peak))
        .collect();
    Ok(Shown {
        key: "chain",
        title: "A stiff chain, its step doubled".to_owned(),
        x: Axis::log("step, µs; limits of two methods", 5.0, 3000.0),
        y: Axis::log("way off the law, of the true peak; top: diverged", 0.1, TOP),
        curves: facts.methods.iter().map(curve).collect(),
        levels: levels.collect(),
        says: format!(
            "The chain diverges beyond {} µs; a scene with such a step is refused, and the message gives the limit; what has no limit does not \
             diverge, and may be wrong all the same: at {step_ms:.1} ms it makes of the peak of {:.3} mm, in parts of it, {}.",
            limits.join(", "),
            facts.true_m * 1e3,
            missed.join(", ")
        ),
    })
}

fn curve(tried: &Tried) -> Curve {
    let points = tried.turns.iter();
    let data: Vec<_> = points.map(|turn| (turn.step_s * 1e6, turn.peak)).collect();
    let drawn = data.iter().map(|&(step, peak)| (step, peak.min(TOP)));
    let line = Line::of_scheme(tried.scheme, drawn.collect());
    Curve {
        name: format!("{}, of the true peak", tried.scheme),
        line: Line {
            label: tried.scheme.to_string(),
            ..line
        },
        data,
    }
}
