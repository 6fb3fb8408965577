//! What went wrong, what the loop told of it, and what the cranks truly did meanwhile: what a campaign judges a run by.
//!
//! A *tick* here is one by the clock: a time over a tick's length. That of a deadline, of what is told at it, and of the
//! output that begins to play at it, are the same. (A fault's own tick counts those that the loop has made, which are fewer
//! after missed deadlines.) *Truly* is without the loop's belief: cranks against where they would be had nothing happened to
//! them, so without what corrects them.

use cophase_core::supervisor::{Fault, State};

use super::Moment;
use crate::dynamics::Corners;
use crate::faults::Injected;
use crate::mechanism::slider_crank::SliderCrank;
use crate::scene::Checked;

/// A crank that turns by less than this part of the greatest speed stands.
const STANDS: f64 = 1e-3;

/// What is told is kept up to this many times.
pub const MOST_TOLD: usize = 1000;

/// A run, watched.
#[derive(Clone, Debug)]
pub struct Watch {
    /// Every fault that was put in, in the order in which they began.
    pub injected: Vec<Injected>,
    /// What the loop told, and in which tick: the first [`MOST_TOLD`].
    pub told: Vec<(u64, Fault)>,
    /// The first fault that latched, and in which tick.
    pub latched: Option<(u64, Fault)>,
    /// Largest tilt of the platform that there was, mrad, drives on or off.
    pub tilt_mrad: f64,
    /// Largest tilt that the cranks' errors come to at the worst phase of a turn, mrad.
    pub worst_phase_tilt_mrad: f64,
    /// Largest deviation of a crank's error from the plane of all, degrees.
    pub warp_deg: f64,
    /// The first tick in which the errors passed a limit of `[drift]`.
    pub past_limit: Option<u64>,
    /// For each axis the last tick in which its drive was told to move, however slowly.
    pub told_to_move: Vec<Option<u64>>,
    /// For each axis the last tick in which its crank moved, faster than a thousandth of the greatest speed.
    pub moved: Vec<Option<u64>>,
    /// Ticks in which drives were on, and some axes turned while another stood that was told to turn; and the last of them.
    pub ran_alone_ticks: u64,
    /// See `ran_alone_ticks`.
    pub ran_alone: Option<u64>,

    tick_s: f64,
    stands_turns: f64,
    tilt_limit_mrad: f64,
    warp_limit_deg: f64,
    mrad_per_turn: f64,
    corners: Corners,
    has_platform: bool,
    actual: Vec<f64>,
    command: Option<Vec<f64>>,
}

impl Watch {
    /// Of cranks at power-up.
    pub fn new<const N: usize>(checked: &Checked, turns: [f64; N]) -> Self {
        let settings = &checked.setup;
        let (machine, drift) = (&settings.machine, &settings.drift);
        let tick_s = 1.0 / f64::from(settings.tick_hz);
        Self {
            injected: Vec::new(),
            told: Vec::new(),
            latched: None,
            tilt_mrad: 0.0,
            worst_phase_tilt_mrad: 0.0,
            warp_deg: 0.0,
            past_limit: None,
            told_to_move: vec![None; N],
            moved: vec![None; N],
            ran_alone_ticks: 0,
            ran_alone: None,
            tick_s,
            stands_turns: STANDS * settings.limits.speed_hz * tick_s,
            tilt_limit_mrad: drift.tilt_limit_mrad,
            warp_limit_deg: drift.warp_limit_deg,
            mrad_per_turn: 1e3
                * std::f64::consts::TAU
                * machine.crank_radius_m
                * most_way(machine.crank_radius_m, machine.lambda)
                / machine.mount_radius_m,
            // At radius 1 a plane through errors has their amplitudes as its tilts.
            corners: Corners::new(N, 1.0),
            has_platform: checked.cam.is_none(),
            actual: turns.to_vec(),
            command: None,
        }
    }

    /// Takes note of a fault that the scene puts in.
    pub fn injected(&mut self, injected: Injected) {
        self.injected.push(injected);
    }

    /// Looks at one tick.
    pub fn tick<const N: usize>(&mut self, moment: &Moment<'_, N>) {
        let tick = (moment.start_ns as f64 * 1e-9 / self.tick_s).round() as u64;
        let telemetry = moment.telemetry;
        // What plays in this tick was reckoned, and told, at the deadline before.
        let told_at = tick.saturating_sub(1);
        if let Some(fault) = telemetry.incident
            && self.told.len() < MOST_TOLD
        {
            self.told.push((told_at, fault));
        }
        if let Some(fault) = telemetry.fault.filter(|_| self.latched.is_none()) {
            self.latched = Some((told_at, fault));
        }
        self.errors(moment, tick);
        self.motion(moment, tick);
    }

    fn errors<const N: usize>(&mut self, moment: &Moment<'_, N>, tick: u64) {
        // Tilt is a difference of cranks: where they are all alike, there is none.
        let first = moment.actual_turns[0];
        if self.has_platform && moment.actual_turns.iter().any(|&turns| turns != first) {
            let tilt_mrad = moment.machine.tilt_mrad(&moment.actual_turns);
            self.tilt_mrad = self.tilt_mrad.max(tilt_mrad);
        }
        let errors: [f64; N] =
            std::array::from_fn(|i| moment.actual_turns[i] - moment.aim_turns[i]);
        // Where drives have never been on, nobody has said where cranks are.
        if moment.telemetry.state == State::Idle {
            return;
        }
        let plane = self.corners.plane(&errors);
        let off = |i: usize| (errors[i] - self.corners.height(&plane, i)).abs() * 360.0;
        let warp_deg = (0..N).map(off).fold(0.0, f64::max);
        let tilt_mrad = plane[1].hypot(plane[2]) * self.mrad_per_turn;
        self.warp_deg = self.warp_deg.max(warp_deg);
        self.worst_phase_tilt_mrad = self.worst_phase_tilt_mrad.max(tilt_mrad);
        let past = tilt_mrad > self.tilt_limit_mrad || warp_deg > self.warp_limit_deg;
        if past && self.past_limit.is_none() {
            self.past_limit = Some(tick);
        }
    }

    fn motion<const N: usize>(&mut self, moment: &Moment<'_, N>, tick: u64) {
        let command = self
            .command
            .get_or_insert_with(|| moment.command_turns.to_vec());
        let (mut turning, mut astray) = (false, false);
        for (i, command) in command.iter_mut().enumerate() {
            let told = moment.command_turns[i] - *command;
            let moved = (moment.actual_turns[i] - self.actual[i]).abs() > self.stands_turns;
            if told != 0.0 {
                self.told_to_move[i] = Some(tick);
            }
            if moved {
                self.moved[i] = Some(tick);
            }
            turning |= moved;
            astray |= told.abs() > self.stands_turns && !moved;
            *command = moment.command_turns[i];
            self.actual[i] = moment.actual_turns[i];
        }
        if moment.drives_enabled && turning && astray {
            self.ran_alone_ticks += 1;
            self.ran_alone = Some(tick);
        }
    }
}

/// Greatest way of a corner to a radian of its crank and metre of its radius, over a turn: half a degree finds it to 4e-5.
fn most_way(radius_m: f64, lambda: f64) -> f64 {
    let Ok(mechanism) = SliderCrank::new(radius_m, radius_m / lambda) else {
        return 1.0 + lambda;
    };
    let ways = (0..360).map(|half| mechanism.at(f64::from(half).to_radians() / 2.0).s);
    ways.fold(0.0, f64::max)
}
