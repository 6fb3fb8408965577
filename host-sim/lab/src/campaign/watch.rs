//! Observer of a case: records what the case is judged by, which is where the cranks truly were, and what the loop reported when.
//!
//! A *moment* is a tick that was played. What the loop made of a tick is played from the second moment after it on: one until the
//! loop reads, and one until what it then writes is played. So a *fault event* counts from the beginning of the moment in which it is
//! played.
//!
//! All fault events are kept, each with what the loop does about it; which of them counts, [`super::judge`] says. What every run keeps,
//! such as its largest tilt, is in [`host_sim::sim::Statistics`].

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::reaction::{Reaction, reaction};
use cophase_core::supervisor::{Fault, FaultKind, State};

use super::detection_ticks;
use super::flag::{Extra, Flag};
use super::geometry::Geometry;
use super::moved::Moved;
use host_sim::axes::{Axes, per_axis};
use host_sim::scene::Checked;
use host_sim::scene::file::{FaultAt, FaultName};
use host_sim::sim::event_watch::{EventWatch, NewEvents};
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

/// What was reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReportedFault {
    /// What.
    pub kind: FaultKind,
    /// Of which axis.
    pub axis: Option<usize>,
}

impl From<Fault> for ReportedFault {
    fn from(Fault { kind, axis, .. }: Fault) -> Self {
        Self { kind, axis }
    }
}

/// When something was reported, and what the loop did about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultEvent {
    /// What.
    pub reported: ReportedFault,
    /// What was done: of what did not latch, what the table has for it within limits.
    pub done: Reaction,
    /// The beginning of the moment in which it was played.
    pub place: Place,
    /// Turns of the master so many ticks before that as detection may take.
    pub turns: f64,
    /// The true crank of its axis had been moved since the fault.
    pub is_moved: bool,
    /// Cranks were beyond a limit then.
    pub is_beyond_limit: bool,
}

/// What was detected.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// When what goes wrong began.
    pub injected: Option<Place>,
    /// The end of the first moment since then in which the true cranks were beyond a limit, with the drives on.
    pub beyond_limit: Option<Place>,
    /// The same, and on model levels where cranks without drives stand, with the drives off as well.
    pub out: Option<Place>,
    /// Whether they were in the last moment with the drives on.
    pub is_beyond_limit: bool,
    /// The longest that they stayed so, turns of the master.
    pub stay_turns: f64,
    /// What was reported since the fault, each thing once for each that was done about it.
    pub fault_events: Vec<FaultEvent>,
    /// Whether the axis it befell passed its index flag after the first of them.
    pub passed_after: bool,
    /// What was reported before the fault.
    pub early: Vec<ReportedFault>,
    /// Events, each once.
    pub reported_faults: Vec<ReportedFault>,
    /// The pulse that no flag makes, if that is what went wrong, by the true crank.
    pub extra: Option<Extra>,
    /// The fault that latched, as it was called at last.
    pub fault: Option<ReportedFault>,
    /// The most that an axis, or its crank, was moved by its drive while another had been stopped for over two ticks, turns.
    pub left_running_turns: f64,
    /// The end of the run.
    pub end: Option<Place>,
}

impl Observation {
    /// The first thing that was reported since the fault.
    pub fn first_reported(&self) -> Option<&FaultEvent> {
        self.fault_events.first()
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
    observation: Observation,
    /// The true cranks that have moved since the fault.
    moved: Moved,
    /// Turns of the master at which cranks went beyond a limit that they have not come back from.
    beyond_since: Option<f64>,
    moments: u64,
    event_watch: EventWatch,
    /// Turns of the master at the end of the last moments, latest first: of as many as detection may take, and one.
    turns: Vec<f64>,
    before: Option<(Axes<f64>, Axes<f64>)>,
    /// For how many moments an axis has stood while another was moved.
    apart: u32,
    /// How far each has been moved since that was over two.
    run_on: Axes<f64>,
}

/// Most reported faults that are kept, and most fault events.
const MOST_EVENTS: usize = 16;

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
            observation: Observation::default(),
            moved: Moved::new(checked),
            beyond_since: None,
            moments: 0,
            event_watch: EventWatch::default(),
            turns: vec![0.0; detection_ticks(checked.settings.axes.len()) + 1],
            before: None,
            apart: 0,
            run_on: per_axis(checked.settings.axes.len(), |_| 0.0),
        }
    }

    /// What was detected.
    pub fn observation(self) -> Observation {
        self.observation
    }

    /// Records what is reported in a moment and was not reported before it.
    fn fault_events(&mut self, telemetry: &Telemetry, place: Place) {
        let Some(NewEvents { reported, latched }) = self.event_watch.tick(telemetry) else {
            return;
        };
        let observation = &mut self.observation;
        let keep = |list: &mut Vec<ReportedFault>, reported: ReportedFault| {
            if list.len() < MOST_EVENTS && !list.contains(&reported) {
                list.push(reported);
            }
        };
        if let Some(reported) = reported {
            keep(&mut observation.reported_faults, reported.into());
        }
        if let Some(fault) = latched {
            observation.fault = Some(fault.into());
        }
        // What latches is reported as well: once is enough.
        let reported = reported.filter(|reported| telemetry.fault != Some(*reported));
        let latched = latched.map(|fault| (fault, reaction(fault.kind, false).max(Reaction::Stop)));
        let reported =
            reported.map(|fault| (fault, reaction(fault.kind, true).min(Reaction::Correct)));
        for (fault, done) in latched.into_iter().chain(reported) {
            let reported = ReportedFault::from(fault);
            if observation.injected.is_none() {
                keep(&mut observation.early, reported);
                continue;
            }
            let is_known = |known: &FaultEvent| (known.reported, known.done) == (reported, done);
            if observation.fault_events.len() < MOST_EVENTS
                && !observation.fault_events.iter().any(is_known)
            {
                observation.fault_events.push(FaultEvent {
                    reported,
                    done,
                    place,
                    turns: self.turns.last().copied().unwrap_or_default(),
                    is_moved: reported.axis.is_some_and(|axis| self.moved.has(axis)),
                    is_beyond_limit: observation.is_beyond_limit,
                });
            }
        }
    }

    /// Whether cranks are beyond a limit. What they do that the loop has let go is nothing that it could yet see, or stop for.
    fn cranks(&mut self, moment: &Moment<'_>, end: Place) {
        if !moment.drives_enabled && moment.machine.rotors().is_some() {
            return;
        }
        let errors: Axes<f64> = moment.errors().collect();
        // Cranks that are all alike neither tilt nor bend the platform.
        let differ = errors.iter().any(|error| *error != errors[0]);
        let is_beyond_limit = differ && self.geometry.is_some_and(|g| g.is_beyond_limit(&errors));
        let since = is_beyond_limit && self.observation.injected.is_some();
        self.observation.out = self.observation.out.or(since.then_some(end));
        if moment.drives_enabled {
            self.observation.is_beyond_limit = is_beyond_limit;
            self.observation.beyond_limit = self.observation.beyond_limit.or(since.then_some(end));
            if since {
                let beyond_since = self.beyond_since.get_or_insert(end.turns);
                self.observation.stay_turns =
                    self.observation.stay_turns.max(end.turns - *beyond_since);
            } else {
                self.beyond_since = None;
            }
        }
    }

    /// Which cranks have moved, as long as their drives hold them.
    fn moved(&mut self, moment: &Moment<'_>) {
        let cranks = moment.actual_turns.iter().zip(moment.command_turns);
        let off = cranks.map(|(actual, command)| actual - command).collect();
        match (self.observation.injected, moment.drives_enabled) {
            (None, _) => self.moved.sample_before(off),
            (Some(_), true) => self.moved.sample(off),
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
        let commanded = per_axis(now.0.len(), |i| (now.0[i] - commands[i]).abs());
        let went = per_axis(now.0.len(), |i| match self.cranks_count[i] {
            true => commanded[i].max((now.1[i] - cranks[i]).abs()),
            false => commanded[i],
        });
        let someone_stands = commanded.contains(&0.0);
        let someone_moves = went.iter().any(|went| *went > 0.0);
        if !moment.drives_enabled || self.observation.fault_events.is_empty() || !someone_stands {
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
                self.observation.left_running_turns =
                    self.observation.left_running_turns.max(*run_on);
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
        if self.observation.injected.is_none() && at_ns.is_some_and(|at| at < moment.end_ns) {
            self.observation.injected = Some(start);
            self.observation.extra = self.extra(moment);
        }
        self.fault_events(telemetry, start);
        self.cranks(moment, end);
        self.moved(moment);
        self.moves(moment);
        let axis = self.fault.and_then(|fault| fault.axis);
        let index = axis.and_then(|axis| moment.index.get(axis));
        if !self.observation.fault_events.is_empty() && index.is_some_and(Option::is_some) {
            self.observation.passed_after = true;
        }
        self.turns.rotate_right(1);
        self.turns[0] = moment.master_turns;
        self.moments += 1;
        self.observation.end = Some(end);
    }
}
