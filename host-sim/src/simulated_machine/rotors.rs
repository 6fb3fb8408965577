//! Cranks that deviate from their commanded positions: the equations of motion of the machine, advanced one control tick at a time.
//!
//! Until the drives are on for the first time, the cranks stay where they were set up. After that, cranks whose drives are off
//! coast under load and friction.

use std::cell::{OnceCell, RefCell};

use cophase_core::units::MAX_AXES;
use cophase_methods::{Method, Scheme, advance};

use super::broken::{Broken, Cause};
use super::instant::Instant;
use crate::drives::Field;
use crate::dynamics::plant::State;
use crate::dynamics::step::{Chosen, in_steps_per_tick};
use crate::dynamics::{Driven, FREEDOMS, Frame, FrameMotion};
use crate::pose::Pose;

/// Command of a drive at the end of a tick: the position at which it would hold its rotor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveCommand {
    /// Position of the crank, turns since power-up.
    pub turns: f64,
    /// Torque that a servo is commanded to add, N·m.
    pub torque_nm: f64,
}

/// Cranks of a machine, in motion.
#[derive(Clone, Debug)]
pub struct Rotors {
    driven: Driven,
    scheme: Scheme,
    method: Box<dyn Method>,
    steps: u32,
    state: Vec<f64>,
    /// States within the last tick, one before each step.
    within: Vec<f64>,
    /// Rates and torques at the end of the last tick, computed when first needed.
    end: OnceCell<End>,
    /// Memory for the rates of the next tick.
    room: RefCell<Vec<f64>>,
    commanded: Vec<DriveCommand>,
    tick_s: f64,
    were_on: bool,
    /// Ticks played.
    ticks: u64,
    /// Speed beyond which a shaft has run away.
    limit: SpeedLimit,
    /// Reason why the equations could not be advanced further, if there is one.
    broken: Option<Broken>,
}

/// Limit beyond which a shaft has run away, and the words of its machine about it.
#[derive(Clone, Copy, Debug)]
pub struct SpeedLimit {
    /// Largest speed of a shaft, rad/s.
    pub max_rad_s: f64,
    /// Part that an axis turns, in a word.
    pub axis_noun: &'static str,
    /// Causes of a large torque on a shaft besides its drive, in words.
    pub causes_of_torque: &'static str,
}

impl SpeedLimit {
    const NONE: Self = Self {
        max_rad_s: f64::INFINITY,
        axis_noun: "shaft",
        causes_of_torque: "",
    };
}

/// Rates and torques at the end of a tick.
#[derive(Clone, Debug)]
struct End {
    /// Rates of change of the state.
    rates: Vec<f64>,
    /// Torques of the motors, N·m.
    torques_nm: [f64; MAX_AXES],
}

/// Factor on the steps of a tick that is replayed to find out why a crank ran away.
const REPLAY_STEPS: u32 = 16;
/// Relative difference below which two speeds of a replay count as equal.
const REPLAY_PART: f64 = 0.02;

impl Rotors {
    /// Creates cranks at rest at the positions of `commanded`, for ticks of `tick_s`, with the chosen method and step.
    ///
    /// # Errors
    /// Fails, with a sentence, if the method is unstable at that step, or if no step into which a tick can be divided is short
    /// enough.
    pub fn new(
        driven: Driven,
        commanded: Vec<DriveCommand>,
        tick_s: f64,
        chosen: Chosen,
    ) -> Result<Self, String> {
        let mode = driven.fastest_mode();
        let (scheme, steps) = chosen.method(mode, tick_s)?;
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
            steps,
            state,
            commanded,
            tick_s,
            were_on: false,
            ticks: 0,
            limit: SpeedLimit::NONE,
            broken: None,
        })
    }

    /// Stops the simulation when a shaft turns faster than its limit.
    #[must_use]
    pub fn watched(mut self, limit: SpeedLimit) -> Self {
        self.limit = limit;
        self
    }

    /// Integration method and its steps per tick.
    pub fn method(&self) -> (Scheme, u32) {
        (self.scheme, self.steps)
    }

    /// Reason why the equations could not be advanced further, if there is one.
    pub fn broken(&self) -> Option<Broken> {
        self.broken
    }

    /// Moves field and rotor of crank `i` back together, at once.
    pub fn fall_back(&mut self, i: usize, turns: f64) {
        self.commanded[i].turns -= turns;
        let angle = self.driven.angle(i);
        self.state[angle] -= turns * std::f64::consts::TAU;
    }

    /// Sets the command of crank `i` to its present position, at once.
    pub fn clear(&mut self, i: usize) {
        self.commanded[i].turns = self.turns(i);
    }

    /// Holds crank `i` at rest whatever torque acts on it, or releases it.
    pub fn hold(&mut self, i: usize, held: bool) {
        self.driven.hold(i, held);
        if held {
            let speed = self.driven.positions() + self.driven.angle(i);
            self.state[speed] = 0.0;
        }
    }

    /// Sets the additional load on crank `i`, N·m. It opposes forward rotation.
    pub fn load(&mut self, i: usize, load_nm: f64) {
        self.driven.loads_nm[i] = load_nm;
    }

    /// Plays a tick in which the fields of the drives move evenly from the last commands to `commanded`.
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
        if let Some(end) = self.end.take() {
            self.room.replace(end.rates);
        }
        for step in 0..self.steps {
            let t_s = f64::from(step) * self.method.step_s();
            self.within.extend_from_slice(&self.state);
            if let Err(error) = self.method.step(&self.driven, t_s, &mut self.state) {
                let since_s = (self.ticks - 1) as f64 * self.tick_s;
                self.broken = Some(error.later(since_s).into());
                break;
            }
        }
        self.broken = self.broken.or_else(|| self.ran_away());
        // The next tick changes the fields, and may change the state.
        if self.broken.is_some() {
            self.end();
        }
    }

    /// Returns the rates and torques at the end of the last tick.
    fn end(&self) -> &End {
        self.end.get_or_init(|| {
            let mut rates = self.room.take();
            rates.resize(self.state.len(), 0.0);
            let torques_nm = self.driven.torques_nm(self.tick_s, &self.state);
            self.driven
                .rates_under(&torques_nm, self.tick_s, &self.state, &mut rates);
            End { rates, torques_nm }
        })
    }

    /// Returns the crank that exceeds the speed limit, if there is one.
    fn ran_away(&self) -> Option<Broken> {
        let from = self.driven.positions();
        let speeds = &self.state[from..from + self.driven.angles()];
        let axis = speeds
            .iter()
            .position(|omega| omega.abs() > self.limit.max_rad_s)?;
        Some(Broken::RanAway {
            t_s: self.ticks as f64 * self.tick_s,
            noun: self.limit.axis_noun,
            axis,
            speed_hz: speeds[axis].abs() / std::f64::consts::TAU,
            cause: self.cause(from + axis),
        })
    }

    /// Returns why this component of the state ran away. To find out, the last tick is replayed with shorter steps.
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
            Some(there) if (there - here).abs() <= REPLAY_PART * here.abs() => Cause::Torque {
                noun: self.limit.axis_noun,
                others: self.limit.causes_of_torque,
            },
            _ => Cause::Step,
        }
    }

    /// Mean speed and acceleration of the cranks, rad/s and rad/s².
    pub fn motion(&self) -> (f64, f64) {
        self.driven.mean_motion(&self.state, &self.end().rates)
    }

    /// States of the machine within the last tick, one before each of its steps; none if it was at rest.
    pub fn within(&self) -> impl ExactSizeIterator<Item = Instant<'_>> {
        let states = self.within.chunks_exact(self.state.len());
        let step_s = self.method.step_s();
        states.enumerate().map(move |(step, state)| Instant {
            driven: &self.driven,
            t_s: step as f64 * step_s,
            state,
        })
    }

    /// State of the equations at the end of the last tick.
    pub fn state(&self) -> State<'_> {
        let positions = self.driven.positions();
        State {
            q: &self.state[..positions],
            v: &self.state[positions..2 * positions],
            a: &self.end().rates[positions..2 * positions],
            torques_nm: self.torques_nm(),
        }
    }

    /// Position of crank `i`, turns since power-up.
    pub fn turns(&self, i: usize) -> f64 {
        self.driven.alpha_rad(&self.state, i) / std::f64::consts::TAU
    }

    /// Torque of each motor at the end of the last tick, N·m.
    pub fn torques_nm(&self) -> &[f64] {
        &self.end().torques_nm[..self.commanded.len()]
    }

    /// Pose of the part that the shafts move. `None` if it follows from the shafts' angles.
    pub fn pose(&self) -> Option<Pose> {
        self.driven.pose(&self.state, &self.end().rates)
    }

    /// Position of the platform: heave in m, tilts in rad. `None` if it follows the shaft, or a plant moves it.
    pub fn place(&self) -> Option<[f64; FREEDOMS]> {
        self.driven.place(&self.state)
    }

    /// Motion of the frame, if it moves.
    pub fn frame(&self) -> Option<FrameMotion> {
        self.driven.frame_motion(&self.state)
    }

    /// Static sag of the frame under its own weight and the load, m; 0 if it does not move.
    pub fn sag_m(&self) -> f64 {
        let sag = |frame: &Frame| {
            let load = &self.driven.body()?.load;
            Some(frame.sag_m(load.mass_kg, load.gravity_mps2))
        };
        self.driven.frame().and_then(sag).unwrap_or(0.0)
    }

    /// True if the platform has no equations of its own: its position follows from the cranks.
    pub fn is_geometric(&self) -> bool {
        self.driven.is_geometric()
    }

    /// Machine and its motors.
    pub fn driven(&self) -> &Driven {
        &self.driven
    }
}
