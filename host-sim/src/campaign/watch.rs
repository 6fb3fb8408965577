//! Looks on while a case runs, and keeps what it is judged by: where the cranks truly were, and what the loop told of it when.
//!
//! A *moment* is a tick that was played. What the loop made of a tick is played from the second moment after it on: one until the
//! loop reads, and one until what it then writes is played. So a *telling* counts from the beginning of the moment in which it is
//! played.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Fault, FaultKind, State};

use super::geometry::Geometry;
use crate::scene::file::FaultAt;
use crate::sim::{Moment, Observer};
use crate::units::{speed_hz, turns};

/// A place in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Moments before it.
    pub moment: u64,
    /// Seconds since power-up.
    pub t_s: f64,
    /// Turns of the master.
    pub turns: f64,
    /// Its speed, rev/s.
    pub speed_hz: f64,
    /// Its acceleration, rev/s².
    pub acceleration_hz_per_s: f64,
    /// What the machine was doing.
    pub state: State,
}

/// What was told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Told {
    /// What.
    pub kind: FaultKind,
    /// Of which axis.
    pub axis: Option<usize>,
}

impl From<Fault> for Told {
    fn from(Fault { kind, axis, .. }: Fault) -> Self {
        Self { kind, axis }
    }
}

/// What was seen.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// When what goes wrong began.
    pub injected: Option<Place>,
    /// The end of the first moment since then in which the true cranks were past a limit.
    pub past: Option<Place>,
    /// Whether they were before it.
    pub past_before: bool,
    /// The beginning of the first moment since the fault in which something was told.
    pub told: Option<Place>,
    /// Whether the axis it befell passed its index flag after that.
    pub passed_after: bool,
    /// Turns of the master two ticks before that.
    pub told_turns: f64,
    /// What was told before it.
    pub early: Vec<Told>,
    /// Incidents, each once.
    pub incidents: Vec<Told>,
    /// The fault that latched, as it was called at last.
    pub fault: Option<Told>,
    /// Largest true tilt, mrad.
    pub tilt_mrad: f64,
    /// The most that an axis, or its crank, was moved by its drive while another had been stopped for over two ticks, turns.
    pub left_running_turns: f64,
    /// The end of the run.
    pub end: Option<Place>,
}

/// The observer.
pub struct Watch<'a, const N: usize> {
    geometry: Option<&'a Geometry>,
    /// When the fault comes, ns; never, in a clean run.
    at_ns: Option<u64>,
    /// Which axis it befalls.
    axis: Option<usize>,
    /// Of a crank that its drive does not move, or that torque moves, how far it goes says nothing.
    cranks_count: [bool; N],
    seen: Seen,
    moments: u64,
    incidents: u32,
    has_fault: bool,
    /// Turns of the master at the end of the last three moments, latest first.
    turns: [f64; 3],
    before: Option<([f64; N], [f64; N])>,
    /// For how many moments an axis has stood while another was moved.
    apart: u32,
    /// How far each has been moved since that was over two.
    moved: [f64; N],
}

/// Most incidents that are kept.
const MOST_INCIDENTS: usize = 16;

impl<'a, const N: usize> Watch<'a, N> {
    /// Of a run whose fault comes at a time, if it does; `cranks_count` says of which axes not only the commands, but the cranks
    /// themselves, must stop with the others.
    pub fn new(
        geometry: Option<&'a Geometry>,
        fault: Option<&FaultAt>,
        cranks_count: [bool; N],
    ) -> Self {
        Self {
            geometry,
            at_ns: fault.map(|fault| (fault.at_s * 1e9).round() as u64),
            axis: fault.and_then(|fault| fault.axis),
            cranks_count,
            seen: Seen::default(),
            moments: 0,
            incidents: 0,
            has_fault: false,
            turns: [0.0; 3],
            before: None,
            apart: 0,
            moved: [0.0; N],
        }
    }

    /// What was seen.
    pub fn seen(self) -> Seen {
        self.seen
    }

    /// What is told in a moment that was not told before it.
    fn tellings(&mut self, telemetry: &Telemetry<N>, place: Place) {
        let mut news = None;
        if telemetry.incidents != self.incidents {
            self.incidents = telemetry.incidents;
            news = telemetry.incident.map(Told::from);
        }
        if let Some(told) = news
            && self.seen.incidents.len() < MOST_INCIDENTS
            && !self.seen.incidents.contains(&told)
        {
            self.seen.incidents.push(told);
        }
        if let Some(fault) = telemetry.fault {
            let told = Told::from(fault);
            self.seen.fault = Some(told);
            if !self.has_fault {
                self.has_fault = true;
                news = news.or(Some(told));
            }
        }
        let Some(told) = news else {
            return;
        };
        if self.seen.injected.is_none() {
            self.seen.early.push(told);
        } else if self.seen.told.is_none() {
            self.seen.told = Some(place);
            self.seen.told_turns = self.turns[2];
        }
    }

    fn cranks(&mut self, moment: &Moment<'_, N>, end: Place) {
        let actual = &moment.actual_turns;
        // What corrects a crank is in its command, and not where it should be.
        let corrected = moment.telemetry.correction.map(turns);
        let errors: [f64; N] =
            std::array::from_fn(|i| actual[i] - (moment.command_turns[i] - corrected[i]));
        // Cranks that are all alike neither tilt nor bend the platform.
        if errors.iter().any(|error| *error != errors[0]) {
            self.seen.tilt_mrad = self.seen.tilt_mrad.max(moment.machine.tilt_mrad(actual));
            let is_past = self.geometry.is_some_and(|g| g.is_past(&errors));
            if is_past && self.seen.injected.is_none() {
                self.seen.past_before = true;
            } else if is_past && self.seen.past.is_none() {
                self.seen.past = Some(end);
            }
        }
    }

    /// Who is moved by its drive while another stands.
    fn moves(&mut self, moment: &Moment<'_, N>) {
        let now = (moment.command_turns, moment.actual_turns);
        let Some((commands, cranks)) = self.before.replace(now) else {
            return;
        };
        let told: [f64; N] = std::array::from_fn(|i| (now.0[i] - commands[i]).abs());
        let went: [f64; N] = std::array::from_fn(|i| match self.cranks_count[i] {
            true => told[i].max((now.1[i] - cranks[i]).abs()),
            false => told[i],
        });
        let someone_stands = told.contains(&0.0);
        let someone_moves = went.iter().any(|went| *went > 0.0);
        if !moment.drives_enabled || self.seen.told.is_none() || !someone_stands {
            self.apart = 0;
            self.moved = [0.0; N];
            return;
        }
        if someone_moves {
            self.apart += 1;
        }
        if self.apart > 2 {
            for (moved, went) in self.moved.iter_mut().zip(went) {
                *moved += went;
                self.seen.left_running_turns = self.seen.left_running_turns.max(*moved);
            }
        }
    }
}

impl<const N: usize> Observer<N> for Watch<'_, N> {
    fn tick(&mut self, moment: &Moment<'_, N>) {
        let telemetry = moment.telemetry;
        let tick_s = (moment.end_ns - moment.start_ns) as f64 * 1e-9;
        let tick_hz = (1.0 / tick_s).round();
        let motion = &telemetry.motion;
        let start = Place {
            moment: self.moments,
            t_s: moment.start_ns as f64 * 1e-9,
            turns: self.turns[0],
            speed_hz: speed_hz(motion.speed, tick_hz as u32),
            acceleration_hz_per_s: speed_hz(motion.acceleration, tick_hz as u32) * tick_hz,
            state: telemetry.state,
        };
        let end = Place {
            moment: self.moments + 1,
            t_s: moment.end_ns as f64 * 1e-9,
            turns: moment.master_turns,
            ..start
        };
        if self.seen.injected.is_none() && self.at_ns.is_some_and(|at| at < moment.end_ns) {
            self.seen.injected = Some(start);
        }
        self.tellings(telemetry, start);
        self.cranks(moment, end);
        self.moves(moment);
        let index = self.axis.and_then(|axis| moment.index.get(axis));
        if self.seen.told.is_some() && index.is_some_and(Option::is_some) {
            self.seen.passed_after = true;
        }
        self.turns = [moment.master_turns, self.turns[0], self.turns[1]];
        self.moments += 1;
        self.seen.end = Some(end);
    }
}
