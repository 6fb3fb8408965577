//! Cranks that are not simply where commanded: the machine's equations of motion, advanced a control tick
//! at a time.
//!
//! Drives that have not been on yet hold their cranks, as whoever set them up left them. Once they have been, cranks
//! whose drives are off run on under load and friction.

use cophase_core::units::MAX_AXES;
use cophase_methods::{Method, Scheme, StepError, Unstable, advance};

use crate::dynamics::{Driven, Field, FrameMotion, Mode, PlaneMotion};

/// By how much what swings may be off, of itself, where nothing says how well it is to be known. RK4 at a damping ratio of 0.05
/// then makes four steps a radian.
pub const RESOLUTION: f64 = 3e-4;

/// Less damping than this is not counted on: what swings longer than a hundred radians is seen by its phase no more.
const LEAST_ZETA: f64 = 0.005;

/// Steps a tick beyond which a scene would take longer than anyone waits.
pub const MOST_STEPS: u32 = 1000;

/// Where drives would have their rotors at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveCommand {
    /// Crank turns since power-up.
    pub turns: f64,
    /// Torque that a servo is commanded to add, N·m.
    pub torque_nm: f64,
}

/// What a scene wants of the method; what it leaves open is chosen here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// Which one.
    pub scheme: Option<Scheme>,
    /// How many steps it makes in a tick.
    pub steps_per_tick: Option<u32>,
    /// By how much what swings may be off, of itself.
    pub resolution: f64,
}

impl Default for Chosen {
    fn default() -> Self {
        Self {
            scheme: None,
            steps_per_tick: None,
            resolution: RESOLUTION,
        }
    }
}

/// How far a mode may turn in a step, rad, for its swing to be off by no more than `resolution` of itself, and half of what is
/// stable not to be passed. An error made in a radian is forgotten within 1/2ζ of them.
pub(super) fn step_rad(scheme: Scheme, zeta: f64, resolution: f64) -> f64 {
    let stable = scheme
        .stability_limit(zeta)
        .map_or(f64::INFINITY, |limit| 0.5 * limit);
    let below_critical = zeta.min(0.99);
    let error_a_radian = resolution * 2.0 * zeta.max(LEAST_ZETA);
    scheme.step_for(below_critical, error_a_radian).min(stable)
}

/// Steps a tick by which the fastest mode is followed.
fn steps_for(scheme: Scheme, mode: Mode, tick_s: f64, resolution: f64) -> Result<u32, String> {
    let steps = (mode.omega_rad_s * tick_s / step_rad(scheme, mode.zeta, resolution))
        .ceil()
        .max(1.0);
    if steps <= f64::from(MOST_STEPS) {
        return Ok(steps as u32);
    }
    Err(format!(
        "{scheme} would take {steps:.0} steps a tick for the fastest mode, {:.3e} rad/s at a damping ratio of {:.3}; at \
         most {MOST_STEPS} are made: give rotors more inertia, softer rods and motors, or another method.name",
        mode.omega_rad_s, mode.zeta
    ))
}

/// What is unstable, with what would be right in the scene's own key.
fn in_steps_per_tick(unstable: &Unstable, tick_s: f64) -> String {
    match *unstable {
        Unstable::Step { limit_s, .. } if limit_s > 0.0 => {
            let steps = (tick_s / limit_s).ceil();
            format!("{unstable}; that is method.steps_per_tick = {steps:.0} or more")
        }
        _ => unstable.to_string(),
    }
}

/// All cranks of a machine, in motion.
#[derive(Debug)]
pub struct Rotors {
    driven: Driven,
    scheme: Scheme,
    method: Box<dyn Method>,
    steps: u32,
    state: Vec<f64>,
    /// State at the beginning of the last tick.
    before: Vec<f64>,
    /// Rates of the state, and torques of the motors, N·m, at the last tick's end.
    rates: Vec<f64>,
    torques_nm: [f64; MAX_AXES],
    /// Motion of the platform at the last tick's end; none where it follows the shaft.
    platform: Option<PlaneMotion>,
    commanded: Vec<DriveCommand>,
    tick_s: f64,
    were_on: bool,
    /// Ticks played, and the speed beyond which no crank turns, rad/s.
    ticks: u64,
    most_rad_s: f64,
    /// Why it went no further.
    broken: Option<Broken>,
}

/// Why a machine went no further.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Broken {
    /// A step was not made.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A crank turns faster than any of its machine is to.
    #[error(
        "crank {axis} turns at {speed_hz:.0} rev/s at t = {t_s:.4} s, which is beyond any speed of this machine: {cause}"
    )]
    RanAway {
        /// When, s.
        t_s: f64,
        /// Which crank.
        axis: usize,
        /// Its speed.
        speed_hz: f64,
        /// Why.
        cause: Cause,
    },
}

/// Why a crank turns faster than any of its machine is to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Cause {
    /// With shorter steps it turns at another speed.
    #[error(
        "the step is too long for this method on motors whose torque is no straight line; take more method.steps_per_tick, or RK4"
    )]
    Step,
    /// With shorter steps it turns at the same speed.
    #[error(
        "shorter steps give the same speed, so the torque on this crank is that large; look at its drive (axes.servo.limit_nm \
         limits its torque), at its load, and at cranks that stand apart and bend rods (offset_deg, start_deg, machine.rod_n_per_um)"
    )]
    Torque,
}

/// A tick is replayed with so many times the steps, to find out why a crank ran away; speeds within this part of each other are
/// the same.
const REPLAY_STEPS: u32 = 16;
const REPLAY_PART: f64 = 0.02;

impl Rotors {
    /// At rest where `commanded` has them, to be advanced by ticks of `tick_s`, as chosen.
    ///
    /// # Errors
    /// The method is unstable at that step, or none that a tick can be cut into is short enough; in a sentence.
    pub fn new(
        driven: Driven,
        commanded: Vec<DriveCommand>,
        tick_s: f64,
        chosen: Chosen,
    ) -> Result<Self, String> {
        let scheme = chosen.scheme.unwrap_or(Scheme::Rk4);
        let mode = driven.fastest_mode();
        let steps = match chosen.steps_per_tick {
            Some(steps) => steps,
            None => steps_for(scheme, mode, tick_s, chosen.resolution)?,
        };
        let step_s = tick_s / f64::from(steps);
        for mode in std::iter::once(mode).chain(driven.own_modes()) {
            scheme
                .check_step(step_s, mode.omega_rad_s, mode.zeta)
                .map_err(|unstable| in_steps_per_tick(&unstable, tick_s))?;
        }
        let method = scheme
            .prepare(&driven, step_s)
            .map_err(|refused| refused.to_string())?;
        let angles: Vec<f64> = commanded
            .iter()
            .map(|commanded| commanded.turns * std::f64::consts::TAU)
            .collect();
        let state = driven.at_rest(&angles);
        let rates = vec![0.0; state.len()];
        Ok(Self {
            platform: driven.platform(&state, &rates),
            before: state.clone(),
            rates,
            torques_nm: [0.0; MAX_AXES],
            driven,
            scheme,
            method,
            steps,
            state,
            commanded,
            tick_s,
            were_on: false,
            ticks: 0,
            most_rad_s: f64::INFINITY,
            broken: None,
        })
    }

    /// The same, ended when a crank turns faster than that.
    #[must_use]
    pub fn watched(mut self, most_rad_s: f64) -> Self {
        self.most_rad_s = most_rad_s;
        self
    }

    /// The method, and how many steps a tick it makes.
    pub fn method(&self) -> (Scheme, u32) {
        (self.scheme, self.steps)
    }

    /// Why it went no further, if it did not.
    pub fn broken(&self) -> Option<Broken> {
        self.broken
    }

    /// Has field and rotor of crank `i` fall back together, at once.
    pub fn fall_back(&mut self, i: usize, turns: f64) {
        self.commanded[i].turns -= turns;
        let angle = self.driven.angle(i);
        self.state[angle] -= turns * std::f64::consts::TAU;
    }

    /// Has the command of crank `i` be where the crank is, at once.
    pub fn clear(&mut self, i: usize) {
        self.commanded[i].turns = self.turns(i);
    }

    /// Has crank `i` stand whatever pushes it, or lets it go.
    pub fn hold(&mut self, i: usize, held: bool) {
        self.driven.hold(i, held);
        if held {
            let speed = self.driven.positions() + self.driven.angle(i);
            self.state[speed] = 0.0;
        }
    }

    /// Loads crank `i` with so much more, against its turning forward, N·m.
    pub fn load(&mut self, i: usize, load_nm: f64) {
        self.driven.loads_nm[i] = load_nm;
    }

    /// Plays a tick in which drives lead their rotors evenly from where commanded last to `commanded`.
    pub fn play(&mut self, commanded: &[DriveCommand], energised: bool) {
        self.were_on |= energised;
        self.ticks += 1;
        for ((field, to), from) in self
            .driven
            .fields
            .iter_mut()
            .zip(commanded)
            .zip(&self.commanded)
        {
            let by_turns = to.turns - from.turns;
            *field = Field {
                alpha_rad: from.turns * std::f64::consts::TAU,
                omega_rad_s: by_turns * std::f64::consts::TAU / self.tick_s,
                torque_nm: to.torque_nm,
            };
        }
        self.commanded.copy_from_slice(commanded);
        if !self.were_on || self.broken.is_some() {
            return;
        }
        self.driven.energised = energised;
        if !energised {
            self.driven.forget(&mut self.state);
        }
        self.before.copy_from_slice(&self.state);
        for step in 0..self.steps {
            let t_s = f64::from(step) * self.method.step_s();
            if let Err(error) = self.method.step(&self.driven, t_s, &mut self.state) {
                let since_s = (self.ticks - 1) as f64 * self.tick_s;
                self.broken = Some(error.later(since_s).into());
                self.platform = self.driven.platform(&self.state, &self.rates);
                return;
            }
        }
        self.broken = self.ran_away();
        self.torques_nm = self.driven.torques_nm(self.tick_s, &self.state);
        self.driven
            .rates_under(&self.torques_nm, &self.state, &mut self.rates);
        self.platform = self.driven.platform(&self.state, &self.rates);
    }

    /// A crank that turns as no machine does.
    fn ran_away(&self) -> Option<Broken> {
        let from = self.driven.positions();
        let speeds = &self.state[from..from + self.driven.angles()];
        let axis = speeds
            .iter()
            .position(|omega| omega.abs() > self.most_rad_s)?;
        Some(Broken::RanAway {
            t_s: self.ticks as f64 * self.tick_s,
            axis,
            speed_hz: speeds[axis].abs() / std::f64::consts::TAU,
            cause: self.cause(from + axis),
        })
    }

    /// Why this component of the state went where it is: the last tick is replayed with shorter steps.
    fn cause(&self, component: usize) -> Cause {
        let steps = REPLAY_STEPS * self.steps;
        let step_s = self.tick_s / f64::from(steps);
        let replayed = self.scheme.prepare(&self.driven, step_s).ok();
        let replayed = replayed.and_then(|mut method| {
            let mut state = self.before.clone();
            advance(method.as_mut(), &self.driven, 0.0, steps, &mut state).ok()?;
            Some(state[component])
        });
        let here = self.state[component];
        match replayed {
            Some(there) if (there - here).abs() <= REPLAY_PART * here.abs() => Cause::Torque,
            _ => Cause::Step,
        }
    }

    /// Speed and acceleration of the cranks, their means, rad/s and rad/s².
    pub fn motion(&self) -> (f64, f64) {
        let (angles, positions) = (self.driven.angles(), self.driven.positions());
        let mean = |values: &[f64]| values.iter().sum::<f64>() / angles as f64;
        let speeds = positions..positions + angles;
        (mean(&self.state[speeds.clone()]), mean(&self.rates[speeds]))
    }

    /// Where crank `i` is, turns.
    pub fn turns(&self, i: usize) -> f64 {
        self.driven.alpha_rad(&self.state, i) / std::f64::consts::TAU
    }

    /// Torque of each motor at the last tick's end, N·m.
    pub fn torques_nm(&self) -> &[f64] {
        &self.torques_nm[..self.commanded.len()]
    }

    /// Where the platform is and how it moves; none where it follows the shaft.
    pub fn platform(&self) -> Option<PlaneMotion> {
        self.platform
    }

    /// What the frame does, if it moves.
    pub fn frame(&self) -> Option<FrameMotion> {
        self.driven.frame_motion(&self.state)
    }

    /// How far the frame has sagged under all that it carries, m; 0 where it stands fast.
    pub fn sag_m(&self) -> f64 {
        let load = self.driven.body().load;
        let frame = self.driven.frame();
        frame.map_or(0.0, |frame| frame.sag_m(load.mass_kg, load.gravity_mps2))
    }

    /// The machine and its motors.
    pub fn driven(&self) -> &Driven {
        &self.driven
    }
}
