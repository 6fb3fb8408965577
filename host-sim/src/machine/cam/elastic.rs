//! What gives between cam and pusher, advanced a control tick at a time.
//!
//! A chain is linear, so that exact discretisation is the method of choice: its step is chosen for what is to be seen.

use cophase_core::units::MAX_AXES;
use cophase_methods::problems::Chain;
use cophase_methods::{Equations, Method, Scheme, StepError};

use super::pusher::{Peaks, Pusher, Turned};
use crate::machine::Chosen;
use crate::machine::step::{MOST_STEPS, in_words};

/// How far the slowest mode may turn in a step of exact discretisation, rad: a peak of the pusher lies within half a step of one that is
/// looked at, where its cosine is 1 − (0.05/2)²/2, 0.03 % off. The cam side feels the cam's motion directly, which the method takes as
/// straight within a step: its peak is off by up to ten times that, in proportion to the step squared.
const RESOLVED_RAD_A_STEP: f64 = 0.05;
/// How far the fastest mode may turn in a step of any other method, rad: RK4 is off by 3.3e-5 a radian there.
const FOLLOWED_RAD_A_STEP: f64 = 0.25;
/// The shortest step whose stability is looked at, s: a thousandth of the shortest that a tick is ever cut into.
const SHORTEST_S: f64 = 1e-10;

/// What gives.
#[derive(Clone, Debug)]
pub(super) struct Elastic {
    pub chain: Chain,
    pub scheme: Scheme,
    pub method: Box<dyn Method>,
    pub steps: u32,
    /// Of each axis.
    pub states: [[f64; 6]; MAX_AXES],
    /// Why it went no further.
    pub broken: Option<StepError>,
}

impl Elastic {
    /// At rest at 0, as chosen.
    ///
    /// # Errors
    /// The method is unstable at that step, or does not suit; in a sentence.
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

    /// A tick of one follower; `observe` is given its pusher after each step.
    pub fn play(
        &mut self,
        axis: usize,
        turned: &Turned,
        tick_s: f64,
        mut observe: impl FnMut(u32, &Pusher),
    ) -> Result<(Pusher, Peaks), StepError> {
        let cam = &mut self.chain.cam;
        cam.start_rad = turned.from.rem_euclid(1.0) * std::f64::consts::TAU;
        cam.speed_rad_s = (turned.to - turned.from) * std::f64::consts::TAU / tick_s;
        let state = &mut self.states[axis];
        let mut rates = [0.0; 6];
        let mut pusher = Pusher::default();
        let mut peaks = Peaks::default();
        let step_s = self.method.step_s();
        for step in 0..self.steps {
            self.method
                .step(&self.chain, f64::from(step) * step_s, state)?;
            let t_s = f64::from(step + 1) * step_s;
            self.chain.rates(t_s, state, &mut rates);
            let by_law = self.chain.cam.at(t_s);
            peaks = peaks.or(Peaks {
                off_m: (state[2] - by_law.displacement).abs(),
                off_mps2: (rates[5] - by_law.acceleration).abs(),
                pusher_mps2: rates[5].abs(),
                cam_side_mps2: rates[3].abs(),
            });
            pusher = Pusher {
                place_m: state[2],
                accel_mps2: rates[5],
            };
            observe(step, &pusher);
        }
        Ok((pusher, peaks))
    }
}

/// Steps a tick: of a linear method as many as show its peaks, of others as many as follow the fastest of it, and twice
/// what is stable.
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
    if steps <= f64::from(MOST_STEPS) {
        return Ok(steps as u32);
    }
    Err(format!(
        "{scheme} would take {} steps a tick for a follower that is as fast as {:.3e} rad/s; at most \
         {MOST_STEPS} are made: give it more mass or softer springs, or method.name = \"exact\"",
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
    let least = (tick_s / limit_s).ceil();
    let (step_us, limit_us) = (step_s * 1e6, limit_s * 1e6);
    let more = if least <= f64::from(MOST_STEPS) {
        format!("method.steps_per_tick = {least:.0} or more, or ")
    } else {
        String::new()
    };
    format!(
        "step {step_us:.4} us is beyond the stability limit of {scheme} with this follower, {limit_us:.4} us: take {more}{WITHOUT}"
    )
}
