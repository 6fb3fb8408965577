//! Observer of a case. It records what the judge needs: the true positions of the cranks, and the times of the loop's reports.
//!
//! A *moment* is a tick that was played. The loop reads the sensors of a moment one moment later, and the outputs that it then computes are
//! played one moment after that. So a *fault event* counts from the beginning of the moment in which the outputs computed with it are
//! played.
//!
//! Reports are kept for their names. The outputs show the response to the fault ([`super::response`]). [`host_sim::sim::RunRecord`] has
//! what every run records, such as its largest tilt.

use std::collections::VecDeque;

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{Fault, FaultKind, State};
use cophase_scene::file::{FaultAt, FaultName};
use cophase_scene::units::{nearest, speed_hz};
use host_sim::axes::{Axes, per_axis};
use host_sim::checked::Checked;
use host_sim::sim::event_watch::{EventWatch, NewEvents};
use host_sim::sim::{Moment, Observer};

use super::DETECTION_TICKS;
use super::flag::{Extra, Flag};
use super::geometry::Geometry;
use super::hold::{self, Hold};
use super::response::{Now, Responded, Responses, Twin};
use super::truth::Truth;

/// Place in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Number of moments before it.
    pub moment: u64,
    /// Seconds since power-up.
    pub t_s: f64,
    /// Turns of the master.
    pub turns: f64,
    /// Speed of the master, rev/s.
    pub speed_hz: f64,
    /// Acceleration of the master, rev/s².
    pub acceleration_hz_per_s: f64,
    /// State of the machine.
    pub state: State,
}

impl Place {
    /// Turns of the master within which an index shows a crank that passes its limit here. In homing, a second turn confirms where its flag
    /// is.
    pub fn turns_to_show(&self) -> f64 {
        if self.state == State::Homing {
            2.0
        } else {
            1.0
        }
    }
}

/// Fault that was reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReportedFault {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Axis of the fault, if it has one.
    pub axis: Option<usize>,
}

impl From<Fault> for ReportedFault {
    fn from(Fault { kind, axis, .. }: Fault) -> Self {
        Self { kind, axis }
    }
}

/// Report of a fault, and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultEvent {
    /// Fault that was reported.
    pub reported: ReportedFault,
    /// Beginning of the moment in which the outputs computed with the report were played.
    pub place: Place,
    /// Turns of the master three ticks before that. Detection may take as many ticks.
    pub turns: f64,
}

/// Record of a run, from which it is judged.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// Beginning of the moment in which the fault came.
    pub injected: Option<Place>,
    /// End of the first moment since then in which the true cranks were beyond a limit, with the drives on.
    pub beyond_limit: Option<Place>,
    /// End of the first such moment with the drives on or, on model levels where cranks without drives stand, off.
    pub out: Option<Place>,
    /// True if they were beyond a limit in the last moment with the drives on.
    pub is_beyond_limit: bool,
    /// Longest stay beyond a limit without a break, with the drives on, turns of the master; less the three ticks that detection may take.
    pub stay_turns: f64,
    /// Longest stay that is allowed, turns: the angle that one crank may be off and, once cranks went beyond a limit,
    /// [`Place::turns_to_show`]. If a crank falls back by that angle just after its flag, it passes the flag again later than a turn, by the
    /// same angle.
    pub may_stay_turns: f64,
    /// True if no monitor can know from indices alone that a crank is beyond its limit. As they show the cranks, these were not beyond a
    /// limit for longer than they may be, and made one pulse at most there, which may be noise.
    pub is_hidden: bool,
    /// Reports since the fault, each once, including the latched fault.
    pub fault_events: Vec<FaultEvent>,
    /// First event since the fault in which the outputs stop the machine or switch its drives off, and those of the twin do not.
    pub stopped: Option<Responded>,
    /// First correction since the fault, whether it suffices or not.
    pub corrected: Option<Responded>,
    /// True if the drives went off or the machine came to rest before the fault, and before its program was over.
    pub stopped_early: bool,
    /// Tilt after a stop while the drives hold.
    pub hold: Hold,
    /// True if the axis with the fault passed its index flag at the first report since the fault, or after it.
    pub passed_after: bool,
    /// Reports before the fault, each once.
    pub early: Vec<ReportedFault>,
    /// Faults that were reported in the whole run, whatever the response, each once.
    pub reported_faults: Vec<ReportedFault>,
    /// Extra pulse, relative to the true crank, if the fault is one.
    pub extra: Option<Extra>,
    /// Latched fault, with its final name.
    pub fault: Option<ReportedFault>,
    /// Largest travel of an axis, commanded or made by its drive, while another had been stopped for over two ticks, turns. While all
    /// commands stand, the travel of the axis with the fault counts only above [`hold::runaway_turns`].
    pub left_running_turns: f64,
    /// End of the run.
    pub end: Option<Place>,
}

impl Observation {
    /// Returns the first report since the fault.
    pub fn first_reported(&self) -> Option<&FaultEvent> {
        self.fault_events.first()
    }
}

/// Observer of a case.
#[derive(Clone)]
pub struct Watch<'a> {
    geometry: Option<&'a Geometry>,
    /// Injected fault. None in a clean run.
    fault: Option<FaultAt>,
    /// Index flag of the axis with the fault.
    flag: Option<Flag>,
    /// True for axes whose cranks are compared as well as their commands. The travel of a crank shows nothing if its drive does not move
    /// it, or if torque moves it.
    cranks_count: Axes<bool>,
    observation: Observation,
    truth: Truth,
    responses: Responses<'a>,
    /// True if the scene has commands or inputs of its own. These may stop the machine.
    stops_itself: bool,
    /// Ticks per second, each a whole number of microseconds long.
    tick_hz: u32,
    were_enabled: bool,
    /// Turns of the master when cranks went beyond a limit, while they are still beyond it.
    beyond_since: Option<f64>,
    /// Turns of the master in which cranks were beyond a limit as indices show them, and pulses of the axes with the fault in them.
    shown_turns: f64,
    shown_pulses: usize,
    moments: u64,
    event_watch: EventWatch,
    /// Turns of the master at the ends of the last four moments, latest first. Detection may take three ticks.
    turns: VecDeque<f64>,
    before: Option<(Axes<f64>, Axes<f64>)>,
    /// Number of moments in which an axis stood while another was moved.
    apart: u32,
    /// Travel of each axis since that number was over two: while another command went on, and while all commands stood.
    run_on: Axes<f64>,
    held_on: Axes<f64>,
    /// Travel that the axis with the fault is allowed while all commands stand, turns: if it rests elsewhere, and if it rests at its flag.
    held_turns: [f64; 2],
    /// True if the axis with the fault rested at its flag when all commands came to stand. None while they have not.
    rests_at_flag: Option<bool>,
}

/// Largest number of reported faults that are kept, and of fault events.
const MAX_EVENTS: usize = 16;

impl<'a> Watch<'a> {
    /// Observer of a run of a scene, and of the first fault in it, if there is one. `cranks_count` is true for axes whose cranks must stop
    /// with the others, and not only their commands.
    pub fn new(
        geometry: Option<&'a Geometry>,
        checked: &Checked,
        cranks_count: Axes<bool>,
    ) -> Self {
        let scene = &checked.scene;
        let tick_s = f64::from(1_000_000 / scene.control.tick_hz * 1000) * 1e-9;
        let fault = scene.fault.first();
        let axis = fault.and_then(|fault| fault.axis);
        Self {
            geometry,
            fault: fault.copied(),
            flag: axis.and_then(|axis| Flag::new(checked, geometry, axis)),
            cranks_count,
            observation: Observation {
                may_stay_turns: geometry.map_or(0.0, Geometry::single_limit_turns),
                ..Observation::default()
            },
            truth: Truth::new(checked),
            responses: Responses::new(scene.resolved(0).steps_per_crank_turn()),
            stops_itself: !scene.command.is_empty() || !scene.input.is_empty(),
            tick_hz: nearest(1.0 / tick_s) as u32,
            were_enabled: false,
            beyond_since: None,
            shown_turns: 0.0,
            shown_pulses: 0,
            moments: 0,
            event_watch: EventWatch::default(),
            turns: vec![0.0; DETECTION_TICKS + 1].into(),
            before: None,
            apart: 0,
            run_on: per_axis(checked.settings.axes.len(), |_| 0.0),
            held_on: per_axis(checked.settings.axes.len(), |_| 0.0),
            held_turns: [false, true].map(|at_flag| hold::runaway_turns(scene, geometry, at_flag)),
            rests_at_flag: None,
        }
    }

    /// Returns the same run up to now, for a scene that differs only in its faults. These must all be still to come.
    #[must_use]
    pub fn go_on_in(&self, checked: &Checked, cranks_count: Axes<bool>) -> Self {
        let Self {
            fault,
            flag,
            cranks_count,
            held_turns,
            ..
        } = Self::new(self.geometry, checked, cranks_count);
        Self {
            fault,
            flag,
            cranks_count,
            held_turns,
            ..self.clone()
        }
    }

    /// Returns the same observer, which compares the outputs with those of a twin from the fault on.
    #[must_use]
    pub const fn compared_with(mut self, twin: &'a Twin) -> Self {
        self.responses.twin = Some(twin);
        self
    }

    /// Returns the record of the run.
    pub fn observation(self) -> Observation {
        Observation {
            stopped: self.responses.stopped(),
            corrected: self.responses.corrected(),
            ..self.observation
        }
    }

    /// Returns the turns of the master three ticks before this one.
    fn turns_before(&self) -> f64 {
        self.turns.back().copied().unwrap_or_default()
    }

    /// Returns [`Observation::stay_turns`] at the beginning of this tick.
    fn stay_turns(&self) -> f64 {
        let now = self.beyond_since.map(|since| self.turns_before() - since);
        self.observation.stay_turns.max(now.unwrap_or(0.0))
    }

    /// Records what is reported in a moment and was not reported before it.
    fn fault_events(&mut self, telemetry: &Telemetry, place: Place) {
        let Some(NewEvents {
            reported, latched, ..
        }) = self.event_watch.tick(telemetry)
        else {
            return;
        };
        let turns = self.turns_before();
        let observation = &mut self.observation;
        let keep = |list: &mut Vec<ReportedFault>, reported: ReportedFault| {
            if list.len() < MAX_EVENTS && !list.contains(&reported) {
                list.push(reported);
            }
        };
        if let Some(reported) = reported {
            keep(&mut observation.reported_faults, reported.into());
        }
        if let Some(fault) = latched {
            observation.fault = Some(fault.into());
        }
        // A fault that latches is reported as well, and is recorded once.
        let reported = reported.filter(|reported| telemetry.fault != Some(*reported));
        for fault in latched.into_iter().chain(reported) {
            let reported = ReportedFault::from(fault);
            if observation.injected.is_none() {
                keep(&mut observation.early, reported);
                continue;
            }
            let is_known = |known: &FaultEvent| known.reported == reported;
            if observation.fault_events.len() < MAX_EVENTS
                && !observation.fault_events.iter().any(is_known)
            {
                observation.fault_events.push(FaultEvent {
                    reported,
                    place,
                    turns,
                });
            }
        }
    }

    /// Records whether cranks are beyond a limit. With the drives off, the loop cannot stop cranks that torque moves, so these do not
    /// count.
    fn cranks(&mut self, moment: &Moment<'_>, errors: &[f64], end: Place) {
        if !moment.drives_enabled && moment.machine.rotors().is_some() {
            return;
        }
        // Cranks with equal errors neither tilt nor warp the platform.
        let differ = errors.iter().any(|error| *error != errors[0]);
        let is_beyond_limit = differ && self.geometry.is_some_and(|g| g.is_beyond_limit(errors));
        let since = is_beyond_limit && self.observation.injected.is_some();
        self.observation.out = self.observation.out.or(since.then_some(end));
        if moment.drives_enabled {
            self.observation.is_beyond_limit = is_beyond_limit;
            if since && self.observation.beyond_limit.is_none() {
                self.observation.beyond_limit = Some(end);
                self.observation.may_stay_turns += end.turns_to_show();
            }
            if since {
                self.beyond_since.get_or_insert(end.turns);
                self.observation.stay_turns = self.stay_turns();
                self.shown(moment, errors, end);
            } else {
                self.beyond_since = None;
            }
        }
    }

    /// Records whether indices alone show that cranks are beyond a limit.
    fn shown(&mut self, moment: &Moment<'_>, errors: &[f64], end: Place) {
        let Some((geometry, (_, before))) = self.geometry.zip(self.before.as_ref()) else {
            return;
        };
        let went_turns = end.turns - self.turns[0];
        let turns_back = per_axis(errors.len(), |i| {
            (moment.actual_turns[i] - before[i]) * went_turns < 0.0
        });
        let Some(shown) = self.truth.shown(errors, &turns_back) else {
            return;
        };
        if geometry.is_beyond_limit(&shown) {
            self.shown_turns += went_turns;
            let axes = self
                .fault
                .map_or([None; 2], |fault| [fault.axis, fault.with]);
            let pulses = axes.into_iter().flatten();
            self.shown_pulses += pulses.filter(|&axis| moment.index[axis].is_some()).count();
        }
        self.observation.is_hidden =
            self.shown_turns <= self.observation.may_stay_turns && self.shown_pulses <= 1;
    }

    /// Records a stop before the fault and before the end of the program.
    fn stops_early(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let went_off = self.were_enabled && !moment.drives_enabled;
        self.were_enabled = moment.drives_enabled;
        let rests = telemetry.state == State::Parked && !telemetry.program_done;
        if self.observation.injected.is_none() && !self.stops_itself {
            self.observation.stopped_early |= went_off || rests;
        }
    }

    /// Records responses of the outputs to the fault.
    fn responses(&mut self, moment: &Moment<'_>, errors: &[f64], place: Place) {
        let now = self.observation.injected.is_some().then(|| Now {
            place,
            turns: self.turns_before(),
            is_beyond_limit: self.observation.is_beyond_limit,
            stay_turns: self.stay_turns(),
            is_hidden: self.observation.is_hidden,
            program_done: moment.telemetry.program_done,
            errors,
        });
        self.responses.tick(moment, now.as_ref());
    }

    /// Returns the place of an extra pulse. Each further one comes a turn later, at the same place.
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

    /// Records axes that their drives move while another stands.
    fn moves(&mut self, moment: &Moment<'_>) {
        let now = (moment.command_turns, moment.actual_turns);
        let Some((commands, cranks)) = &mut self.before else {
            let kept = |turns: &[f64]| per_axis(turns.len(), |i| turns[i]);
            self.before = Some((kept(now.0), kept(now.1)));
            return;
        };
        if self.observation.injected.is_none() {
            commands.copy_from_slice(now.0);
            cranks.copy_from_slice(now.1);
            return;
        }
        let commanded = per_axis(now.0.len(), |i| (now.0[i] - commands[i]).abs());
        let went = per_axis(now.0.len(), |i| match self.cranks_count[i] {
            true => commanded[i].max((now.1[i] - cranks[i]).abs()),
            false => commanded[i],
        });
        commands.copy_from_slice(now.0);
        cranks.copy_from_slice(now.1);
        let someone_stands = commanded.contains(&0.0);
        let stands = commanded.iter().all(|commanded| *commanded == 0.0);
        self.observation.hold.tick(moment, stands);
        let someone_moves = went.iter().any(|went| *went > 0.0);
        if !moment.drives_enabled || !someone_stands {
            self.apart = 0;
            self.run_on.fill(0.0);
            self.held_on.fill(0.0);
            self.rests_at_flag = None;
            return;
        }
        if stands && self.rests_at_flag.is_none() {
            let axis = self.fault.and_then(|fault| fault.axis);
            let crank = axis.and_then(|axis| moment.actual_turns.get(axis));
            let at_flag = self.flag.zip(crank);
            self.rests_at_flag =
                Some(at_flag.is_some_and(|(flag, crank)| flag.extra_at(*crank).is_harmless));
        }
        if someone_moves {
            self.apart += 1;
        }
        if self.apart > 2 {
            let (run_on, allowed_turns) = if stands {
                let at_flag = usize::from(self.rests_at_flag == Some(true));
                (&mut self.held_on, self.held_turns[at_flag])
            } else {
                (&mut self.run_on, 0.0)
            };
            let faulted = self.fault.and_then(|fault| fault.axis);
            for (axis, (run_on, went)) in run_on.iter_mut().zip(went).enumerate() {
                *run_on += went;
                let allowed_turns = if faulted == Some(axis) {
                    allowed_turns
                } else {
                    0.0
                };
                let left_turns = *run_on - allowed_turns;
                self.observation.left_running_turns =
                    self.observation.left_running_turns.max(left_turns);
            }
        }
    }
}

impl Observer for Watch<'_> {
    fn tick(&mut self, moment: &Moment<'_>) {
        let telemetry = moment.telemetry;
        let tick_hz = f64::from(self.tick_hz);
        let motion = &telemetry.motion;
        let start = Place {
            moment: self.moments,
            t_s: moment.start_ns as f64 * 1e-9,
            turns: self.turns[0],
            speed_hz: speed_hz(motion.speed, self.tick_hz),
            acceleration_hz_per_s: speed_hz(motion.acceleration, self.tick_hz) * tick_hz,
            state: telemetry.state,
        };
        let end = Place {
            moment: self.moments + 1,
            t_s: moment.end_ns as f64 * 1e-9,
            turns: moment.master_turns,
            ..start
        };
        let is_due = |fault: &FaultAt| (nearest(fault.at_s * 1e9) as u64) < moment.end_ns;
        if self.observation.injected.is_none() && self.fault.as_ref().is_some_and(is_due) {
            self.observation.injected = Some(start);
            self.observation.extra = self.extra(moment);
        }
        self.fault_events(telemetry, start);
        let errors = self.truth.errors(moment);
        self.responses(moment, &errors, start);
        self.stops_early(moment);
        self.cranks(moment, &errors, end);
        self.moves(moment);
        let axis = self.fault.and_then(|fault| fault.axis);
        let index = axis.and_then(|axis| moment.index.get(axis));
        if !self.observation.fault_events.is_empty() && index.is_some_and(Option::is_some) {
            self.observation.passed_after = true;
        }
        self.turns.pop_back();
        self.turns.push_front(moment.master_turns);
        self.moments += 1;
        self.observation.end = Some(end);
    }
}
