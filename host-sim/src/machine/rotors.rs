//! Cranks that are not simply where commanded: the machine's equations of motion, advanced a control tick
//! at a time.
//!
//! Drives that have not been on yet hold their cranks, as whoever set them up left them. Once they have been, cranks
//! whose drives are off run on under load and friction.

use std::cell::{OnceCell, RefCell};

use cophase_core::units::MAX_AXES;
use cophase_methods::{Method, Scheme, advance};

use super::broken::{Broken, Cause};
use super::instant::Instant;
use super::step::{Chosen, in_steps_per_tick, steps_for};
use crate::dynamics::{Driven, Field, FrameMotion, PlaneMotion, STICTION_RAD_S};
use crate::plant::State;

/// Where drives would have their rotors at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveCommand {
    /// Crank turns since power-up.
    pub turns: f64,
    /// Torque that a servo is commanded to add, N·m.
    pub torque_nm: f64,
}

/// All cranks of a machine, in motion.
#[derive(Clone, Debug)]
pub struct Rotors {
    driven: Driven,
    scheme: Scheme,
    method: Box<dyn Method>,
    steps: u32,
    /// The method near standstill, where dry friction changes faster than the chosen method's step follows; none if it does not.
    near_rest: Option<Box<dyn Method>>,
    state: Vec<f64>,
    /// States of the last tick, one before each step.
    within: Vec<f64>,
    /// What acts at the last tick's end, worked out where somebody asks.
    end: OnceCell<End>,
    /// Room for the rates of the next.
    room: RefCell<Vec<f64>>,
    commanded: Vec<DriveCommand>,
    tick_s: f64,
    were_on: bool,
    /// Ticks played, and the speed beyond which no crank turns, rad/s.
    ticks: u64,
    most_rad_s: f64,
    /// Why it went no further.
    broken: Option<Broken>,
}

/// What acts at a tick's end.
#[derive(Clone, Debug)]
struct End {
    /// Rates of the state.
    rates: Vec<f64>,
    /// Torques of the motors, N·m.
    torques_nm: [f64; MAX_AXES],
}

/// Speed beyond which dry friction is constant, rad/s: five times that over which it turns round, where tanh is 1 to 1e-4.
const NEAR_REST_RAD_S: f64 = 5.0 * STICTION_RAD_S;

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
        let steps = chosen.steps(|| steps_for(scheme, mode, tick_s, chosen.resolution))?;
        let step_s = tick_s / f64::from(steps);
        for mode in std::iter::once(mode).chain(driven.own_modes()) {
            scheme
                .check_step(step_s, mode.omega_rad_s, mode.zeta)
                .map_err(|unstable| in_steps_per_tick(&unstable, tick_s))?;
        }
        let method = scheme
            .prepare(&driven, step_s)
            .map_err(|refused| refused.to_string())?;
        let friction_per_s = driven.body().fastest_friction_per_s();
        let follows_friction = chosen.scheme.is_some()
            || friction_per_s == 0.0
            || scheme.check_step(step_s, friction_per_s, 1.0).is_ok();
        let near_rest = (!follows_friction)
            .then(|| Scheme::Sdirk4.prepare(&driven, step_s))
            .transpose()
            .map_err(|refused| refused.to_string())?;
        let angles: Vec<f64> = commanded
            .iter()
            .map(|commanded| commanded.turns * std::f64::consts::TAU)
            .collect();
        let state = driven.at_rest(&angles);
        let rates = vec![0.0; state.len()];
        let end = End {
            rates,
            torques_nm: [0.0; MAX_AXES],
        };
        Ok(Self {
            within: Vec::with_capacity(steps as usize * state.len()),
            end: end.into(),
            room: RefCell::default(),
            driven,
            scheme,
            method,
            near_rest,
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
        self.within.clear();
        if !self.were_on || self.broken.is_some() {
            return;
        }
        self.driven.energised = energised;
        if !energised {
            self.driven.forget(&mut self.state);
        }
        self.driven.begin_tick(&self.state, self.tick_s);
        let is_near_rest = self.near_rest.is_some() && self.is_near_rest();
        let method = match &mut self.near_rest {
            Some(near_rest) if is_near_rest => near_rest,
            _ => &mut self.method,
        };
        if let Some(end) = self.end.take() {
            self.room.replace(end.rates);
        }
        for step in 0..self.steps {
            let t_s = f64::from(step) * method.step_s();
            self.within.extend_from_slice(&self.state);
            if let Err(error) = method.step(&self.driven, t_s, &mut self.state) {
                let since_s = (self.ticks - 1) as f64 * self.tick_s;
                self.broken = Some(error.later(since_s).into());
                break;
            }
        }
        self.broken = self.broken.or_else(|| self.ran_away());
        // What comes next changes the fields, and may change the state.
        if self.near_rest.is_some() || self.broken.is_some() {
            self.end();
        }
    }

    /// What acts at the last tick's end.
    fn end(&self) -> &End {
        self.end.get_or_init(|| {
            let mut rates = self.room.take();
            rates.resize(self.state.len(), 0.0);
            let torques_nm = self.driven.torques_nm(self.tick_s, &self.state);
            self.driven
                .rates_under(&torques_nm, &self.state, &mut rates);
            End { rates, torques_nm }
        })
    }

    /// True if a crank is as slow as friction turns round, or may become so within a tick.
    fn is_near_rest(&self) -> bool {
        let from = self.driven.positions();
        let cranks = from..from + self.driven.angles();
        let cranks = self.state[cranks.clone()]
            .iter()
            .zip(&self.end().rates[cranks]);
        cranks
            .into_iter()
            .any(|(omega, rate)| omega.abs() < NEAR_REST_RAD_S + rate.abs() * self.tick_s)
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
            let mut state = self.within[..self.state.len()].to_vec();
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
        self.driven.mean_motion(&self.state, &self.end().rates)
    }

    /// States of the machine within the last tick, one before each of its steps; none if it stood still.
    pub fn within(&self) -> impl ExactSizeIterator<Item = Instant<'_>> {
        let states = self.within.chunks_exact(self.state.len());
        let step_s = self.method.step_s();
        states.enumerate().map(move |(step, state)| Instant {
            driven: &self.driven,
            t_s: step as f64 * step_s,
            state,
        })
    }

    /// State of the equations at the last tick's end.
    pub fn state(&self) -> State<'_> {
        let positions = self.driven.positions();
        State {
            q: &self.state[..positions],
            v: &self.state[positions..2 * positions],
            a: &self.end().rates[positions..2 * positions],
            torques_nm: self.torques_nm(),
        }
    }

    /// Where crank `i` is, turns.
    pub fn turns(&self, i: usize) -> f64 {
        self.driven.alpha_rad(&self.state, i) / std::f64::consts::TAU
    }

    /// Torque of each motor at the last tick's end, N·m.
    pub fn torques_nm(&self) -> &[f64] {
        &self.end().torques_nm[..self.commanded.len()]
    }

    /// Where the platform is and how it moves; none where it follows the shaft.
    pub fn platform(&self) -> Option<PlaneMotion> {
        self.driven.platform(&self.state, &self.end().rates)
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

    /// True if the platform has no equations of its own: where it is follows from the cranks.
    pub fn is_geometric(&self) -> bool {
        self.driven.is_geometric()
    }

    /// The machine and its motors.
    pub fn driven(&self) -> &Driven {
        &self.driven
    }
}
