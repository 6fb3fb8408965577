//! Elastic chain between cam and pusher, advanced a control tick at a time.
//!
//! A chain is linear, so that exact discretisation is the default method. Its step is chosen to resolve the peaks.

use cophase_core::units::MAX_AXES;
use cophase_methods::problems::Chain;
use cophase_methods::{Equations, Method, Scheme, StepError};

use super::pushers::{PusherPeaks, Turned};
use crate::dynamics::Chosen;
use crate::dynamics::step::{MAX_STEPS, in_words};
use crate::machines::follower::{PartMotion, Peaks};

/// Largest phase advance of the slowest mode per step of exact discretisation, rad. A peak of the pusher lies within half a step of a
/// sample, where its cosine is 1 − (0.05/2)²/2, an error of 0.03 %. The cam side follows the cam's motion directly, which the method
/// takes as linear within a step. The error of its peak is up to ten times that, in proportion to the step squared.
const RESOLVED_RAD_A_STEP: f64 = 0.05;
/// Largest phase advance of the fastest mode per step of any other method, rad. The error of RK4 is 3.3e-5 per radian there.
const FOLLOWED_RAD_A_STEP: f64 = 0.25;
/// Shortest step whose stability is checked, s: a thousandth of the shortest step that a tick is divided into.
const SHORTEST_S: f64 = 1e-10;

/// Elastic chains of all axes, with the method that integrates them.
#[derive(Clone, Debug)]
pub(super) struct Elastic {
    pub chain: Chain,
    pub scheme: Scheme,
    pub method: Box<dyn Method>,
    pub steps: u32,
    /// State of each axis.
    pub states: [[f64; 6]; MAX_AXES],
    /// Reason why the chains could not be advanced further, if there is one.
    pub broken: Option<StepError>,
}

impl Elastic {
    /// Creates chains at rest at 0, with the chosen method and step.
    ///
    /// # Errors
    /// Fails, with a sentence, if the method is unstable at that step or does not suit the chain.
    pub fn new(chain: Chain, tick_s: f64, chosen: Chosen) -> Result<Self, String> {
        let scheme = chosen.scheme.unwrap_or(Scheme::Exact);
        let limit_s = scheme
            .longest_stable_step_s(&chain, SHORTEST_S, tick_s)
            .map_err(|refused| refused.to_string())?;
        let steps = chosen.steps(|| steps_for(scheme, &chain, limit_s, tick_s))?;
        let step_s = tick_s / f64::from(steps);
        if let Some(limit_s) = limit_s.filter(|limit_s| step_s > *limit_s) {
            return Err(unstable(scheme, step_s, limit_s, tick_s));
        }
        let method = scheme
            .prepare(&chain, step_s)
            .map_err(|refused| refused.to_string())?;
        Ok(Self {
            chain,
            scheme,
            method,
            steps,
            states: [[0.0; 6]; MAX_AXES],
            broken: None,
        })
    }

    /// Plays a tick of one follower. `observe` receives its pusher after each step.
    pub fn play(
        &mut self,
        axis: usize,
        turned: &Turned,
        tick_s: f64,
        mut observe: impl FnMut(u32, &PartMotion),
    ) -> Result<(PartMotion, Peaks), StepError> {
        let cam = &mut self.chain.cam;
        cam.start_rad = turned.from.rem_euclid(1.0) * std::f64::consts::TAU;
        cam.speed_rad_s = (turned.to - turned.from) * std::f64::consts::TAU / tick_s;
        let state = &mut self.states[axis];
        let mut rates = [0.0; 6];
        let mut pusher = PartMotion::default();
        let mut peaks = Peaks::default();
        let step_s = self.method.step_s();
        for step in 0..self.steps {
            self.method
                .step(&self.chain, f64::from(step) * step_s, state)?;
            let t_s = f64::from(step + 1) * step_s;
            self.chain.rates(t_s, state, &mut rates);
            let by_law = self.chain.cam.at(t_s);
            peaks = peaks.or(PusherPeaks {
                off_law_worst_mm: (state[2] - by_law.displacement).abs() * 1e3,
                off_law_accel_worst_mps2: (rates[5] - by_law.acceleration).abs(),
                pusher_accel_worst_mps2: rates[5].abs(),
                cam_side_accel_worst_mps2: rates[3].abs(),
            }
            .into());
            pusher = PartMotion {
                place_m: state[2],
                accel_mps2: rates[5],
            };
            observe(step, &pusher);
        }
        Ok((pusher, peaks))
    }
}

/// Returns the steps per tick. Exact discretisation takes as many as resolve the peaks. Other methods take as many as resolve the
/// fastest mode. All stay below half of the stability limit.
fn steps_for(
    scheme: Scheme,
    chain: &Chain,
    limit_s: Option<f64>,
    tick_s: f64,
) -> Result<u32, String> {
    let followed_s = if scheme == Scheme::Exact {
        RESOLVED_RAD_A_STEP / chain.undamped_rad_s()[0]
    } else {
        FOLLOWED_RAD_A_STEP / chain.fastest_rad_s()
    };
    let step_s = limit_s.map_or(followed_s, |limit_s| followed_s.min(0.5 * limit_s));
    let steps = (tick_s / step_s).ceil().max(1.0);
    if steps <= f64::from(MAX_STEPS) {
        return Ok(steps as u32);
    }
    Err(format!(
        "{scheme} would take {} steps a tick for a follower that is as fast as {:.3e} rad/s; at most \
         {MAX_STEPS} are made: give it more mass or softer springs, or method.name = \"exact\"",
        in_words(steps),
        chain.fastest_rad_s()
    ))
}

fn unstable(scheme: Scheme, step_s: f64, limit_s: f64, tick_s: f64) -> String {
    const WITHOUT: &str =
        "a method without a limit: \"exact\", \"implicit-midpoint\" or \"sdirk4\"";
    if limit_s == 0.0 {
        return format!("{scheme} is unstable at any step with this follower: take {WITHOUT}");
    }
    let min = (tick_s / limit_s).ceil();
    let (step_us, limit_us) = (step_s * 1e6, limit_s * 1e6);
    let more = if min <= f64::from(MAX_STEPS) {
        format!("method.steps_per_tick = {min:.0} or more, or ")
    } else {
        String::new()
    };
    format!(
        "step {step_us:.4} us is beyond the stability limit of {scheme} with this follower, {limit_us:.4} us: take {more}{WITHOUT}"
    )
}
