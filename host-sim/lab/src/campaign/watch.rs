//! Looks on while a case runs, and keeps what it is judged by: where the cranks truly were, and what the loop told of it when.
//!
//! A *moment* is a tick that was played. What the loop made of a tick is played from the second moment after it on: one until the
//! loop reads, and one until what it then writes is played. So a *telling* counts from the beginning of the moment in which it is
//! played.
//!
//! All tellings are kept, each with what the loop does about it; which of them counts, [`super::judge`] says. What every run keeps,
//! such as its largest tilt, is in [`host_sim::sim::Statistics`].

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::reaction::{Reaction, reaction};
use cophase_core::supervisor::{Fault, FaultKind, State};

use super::flag::{Extra, Flag};
use super::geometry::Geometry;
use super::moved::Moved;
use host_sim::axes::{Axes, per_axis};
use host_sim::scene::Checked;
use host_sim::scene::file::{FaultAt, FaultName};
use host_sim::sim::news::{News, Tellings};
use host_sim::sim::{Moment, Observer};
use host_sim::units::speed_hz;

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

/// When something was told, and what the loop did about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telling {
    /// What.
    pub told: Told,
    /// What was done: of what did not latch, what the table has for it in safety.
    pub done: Reaction,
    /// The beginning of the moment in which it was played.
    pub place: Place,
    /// Turns of the master two ticks before that.
    pub turns: f64,
    /// The true crank of its axis had been moved since the fault.
    pub is_moved: bool,
    /// Cranks were past a limit then.
    pub is_past: bool,
}

/// What was seen.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// When what goes wrong began.
    pub injected: Option<Place>,
    /// The end of the first moment since then in which the true cranks were past a limit, with the drives on.
    pub past: Option<Place>,
    /// The same, and on rungs where cranks without drives stand, with the drives off as well.
    pub out: Option<Place>,
    /// Whether they were in the last moment with the drives on.
    pub is_past: bool,
    /// The longest that they stayed so, turns of the master.
    pub stay_turns: f64,
    /// What was told since the fault, each thing once for each that was done about it.
    pub tellings: Vec<Telling>,
    /// Whether the axis it befell passed its index flag after the first of them.
    pub passed_after: bool,
    /// What was told before the fault.
    pub early: Vec<Told>,
    /// Incidents, each once.
    pub incidents: Vec<Told>,
    /// The pulse that no flag makes, if that is what went wrong, by the true crank.
    pub extra: Option<Extra>,
    /// The fault that latched, as it was called at last.
    pub fault: Option<Told>,
    /// The most that an axis, or its crank, was moved by its drive while another had been stopped for over two ticks, turns.
    pub left_running_turns: f64,
    /// The end of the run.
    pub end: Option<Place>,
}

impl Seen {
    /// The first thing that was told since the fault.
    pub fn first_told(&self) -> Option<&Telling> {
        self.tellings.first()
    }
}

/// The observer.
pub struct Watch<'a> {
    geometry: Option<&'a Geometry>,
    /// What goes wrong; nothing, in a clean run.
    fault: Option<FaultAt>,
    /// The flag of the axis that it befalls.
    flag: Option<Flag>,
    /// Of a crank that its drive does not move, or that torque moves, how far it goes says nothing.
    cranks_count: Axes<bool>,
    seen: Seen,
    /// The true cranks that have moved since the fault.
    moved: Moved,
    /// Turns of the master at which cranks went past a limit that they have not come back from.
    went_past: Option<f64>,
    moments: u64,
    tellings: Tellings,
    /// Turns of the master at the end of the last three moments, latest first.
    turns: [f64; 3],
    before: Option<(Axes<f64>, Axes<f64>)>,
    /// For how many moments an axis has stood while another was moved.
    apart: u32,
    /// How far each has been moved since that was over two.
    run_on: Axes<f64>,
}

/// Most incidents that are kept, and most tellings.
const MOST_INCIDENTS: usize = 16;

impl<'a> Watch<'a> {
    /// Of a scene's run, and of the first fault in it, if there is one; `cranks_count` says of which axes not only the commands,
    /// but the cranks themselves, must stop with the others.
    pub fn new(
        geometry: Option<&'a Geometry>,
        checked: &Checked,
        cranks_count: Axes<bool>,
    ) -> Self {
        let fault = checked.scene.fault.first();
        let axis = fault.and_then(|fault| fault.axis);
        Self {
            geometry,
            fault: fault.copied(),
            flag: axis.and_then(|axis| Flag::new(checked, axis)),
            cranks_count,
            seen: Seen::default(),
            moved: Moved::new(checked),
            went_past: None,
            moments: 0,
            tellings: Tellings::default(),
            turns: [0.0; 3],
            before: None,
            apart: 0,
            run_on: per_axis(checked.settings.axes.len(), |_| 0.0),
        }
    }

    /// What was seen.
    pub fn seen(self) -> Seen {
        self.seen
    }

    /// What is told in a moment that was not told before it.
    fn tellings(&mut self, telemetry: &Telemetry, place: Place) {
        let Some(News { told, latched }) = self.tellings.tick(telemetry) else {
            return;
        };
        let seen = &mut self.seen;
        let keep = |list: &mut Vec<Told>, told: Told| {
            if list.len() < MOST_INCIDENTS && !list.contains(&told) {
                list.push(told);
            }
        };
        if let Some(told) = told {
            keep(&mut seen.incidents, told.into());
        }
        if let Some(fault) = latched {
            seen.fault = Some(fault.into());
        }
        // What latches is told as well: once is enough.
        let told = told.filter(|told| telemetry.fault != Some(*told));
        let latched = latched.map(|fault| (fault, reaction(fault.kind, false).max(Reaction::Stop)));
        let told = told.map(|fault| (fault, reaction(fault.kind, true).min(Reaction::Correct)));
        for (fault, done) in latched.into_iter().chain(told) {
            let told = Told::from(fault);
            if seen.injected.is_none() {
                keep(&mut seen.early, told);
                continue;
            }
            let is_known = |known: &Telling| (known.told, known.done) == (told, done);
            if seen.tellings.len() < MOST_INCIDENTS && !seen.tellings.iter().any(is_known) {
                seen.tellings.push(Telling {
                    told,
                    done,
                    place,
                    turns: self.turns[2],
                    is_moved: told.axis.is_some_and(|axis| self.moved.has(axis)),
                    is_past: seen.is_past,
                });
            }
        }
    }

    /// Whether cranks are past a limit. What they do that the loop has let go is nothing that it could yet see, or stop for.
    fn cranks(&mut self, moment: &Moment<'_>, end: Place) {
        if !moment.drives_enabled && moment.machine.rotors().is_some() {
            return;
        }
        let errors: Axes<f64> = moment.errors().collect();
        // Cranks that are all alike neither tilt nor bend the platform.
        let differ = errors.iter().any(|error| *error != errors[0]);
        let is_past = differ && self.geometry.is_some_and(|g| g.is_past(&errors));
        let since = is_past && self.seen.injected.is_some();
        self.seen.out = self.seen.out.or(since.then_some(end));
        if moment.drives_enabled {
            self.seen.is_past = is_past;
            self.seen.past = self.seen.past.or(since.then_some(end));
            if since {
                let went_past = self.went_past.get_or_insert(end.turns);
                self.seen.stay_turns = self.seen.stay_turns.max(end.turns - *went_past);
            } else {
                self.went_past = None;
            }
        }
    }

    /// Which cranks have moved, as long as their drives hold them.
    fn moved(&mut self, moment: &Moment<'_>) {
        let cranks = moment.actual_turns.iter().zip(moment.command_turns);
        let off = cranks.map(|(actual, command)| actual - command).collect();
        match (self.seen.injected, moment.drives_enabled) {
            (None, _) => self.moved.look_before(off),
            (Some(_), true) => self.moved.look(off),
            (Some(_), false) => {}
        }
    }

    /// Where a pulse comes that no flag makes: each that follows comes a turn later, at the same place.
    fn extra(&self, moment: &Moment<'_>) -> Option<Extra> {
        let is_extra = |fault: &FaultAt| fault.kind == FaultName::IndexExtra;
        let fault = self.fault.filter(is_extra)?;
        let axis = fault.axis?;
        let (_, cranks) = self.before.as_ref()?;
        let since_s = fault.at_s - moment.start_ns as f64 * 1e-9;
        let part = since_s / ((moment.end_ns - moment.start_ns) as f64 * 1e-9);
        let (from, to) = (cranks[axis], moment.actual_turns[axis]);
        Some(
            self.flag?
                .extra_at(from + part.clamp(0.0, 1.0) * (to - from)),
        )
    }

    /// Who is moved by its drive while another stands.
    fn moves(&mut self, moment: &Moment<'_>) {
        let now = (moment.command_turns, moment.actual_turns);
        let kept = (
            now.0.iter().copied().collect(),
            now.1.iter().copied().collect(),
        );
        let Some((commands, cranks)) = self.before.replace(kept) else {
            return;
        };
        let told = per_axis(now.0.len(), |i| (now.0[i] - commands[i]).abs());
        let went = per_axis(now.0.len(), |i| match self.cranks_count[i] {
            true => told[i].max((now.1[i] - cranks[i]).abs()),
            false => told[i],
        });
        let someone_stands = told.contains(&0.0);
        let someone_moves = went.iter().any(|went| *went > 0.0);
        if !moment.drives_enabled || self.seen.tellings.is_empty() || !someone_stands {
            self.apart = 0;
            self.run_on.fill(0.0);
            return;
        }
        if someone_moves {
            self.apart += 1;
        }
        if self.apart > 2 {
            for (run_on, went) in self.run_on.iter_mut().zip(went) {
                *run_on += went;
                self.seen.left_running_turns = self.seen.left_running_turns.max(*run_on);
            }
        }
    }
}

impl Observer for Watch<'_> {
    fn tick(&mut self, moment: &Moment<'_>) {
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
        let at_ns = self.fault.map(|fault| (fault.at_s * 1e9).round() as u64);
        if self.seen.injected.is_none() && at_ns.is_some_and(|at| at < moment.end_ns) {
            self.seen.injected = Some(start);
            self.seen.extra = self.extra(moment);
        }
        self.tellings(telemetry, start);
        self.cranks(moment, end);
        self.moved(moment);
        self.moves(moment);
        let axis = self.fault.and_then(|fault| fault.axis);
        let index = axis.and_then(|axis| moment.index.get(axis));
        if !self.seen.tellings.is_empty() && index.is_some_and(Option::is_some) {
            self.seen.passed_after = true;
        }
        self.turns = [moment.master_turns, self.turns[0], self.turns[1]];
        self.moments += 1;
        self.seen.end = Some(end);
    }
}
