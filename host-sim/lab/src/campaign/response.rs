//! Responses of a controller's outputs to a fault: the drives go off, a stop begins, or a correction begins.
//!
//! The judge does not rely on the controller's reports. It compares the outputs of the faulty run with those of the case's clean run, its
//! [`Twin`], tick by tick. The two runs differ in the fault alone. So any difference is an effect of the fault, and the judge needs no
//! threshold that separates a response from chance.

use cophase_core::supervisor::State;
use host_sim::axes::{Axes, per_axis};
use host_sim::sim::{Moment, Observer};

use super::watch::Place;

/// Response of a controller to a fault, as its outputs show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// The enable line of the drives goes off, and that of the twin does not.
    Off,
    /// The commanded acceleration falls, and from then on the commanded speed does not recover until it is zero. If the twin moves alike
    /// until a later tick, the stop begins in that tick. It begins with its report if that is earlier, as a stop may coincide with the end
    /// of a ramp. The stop at the end of the program does not count.
    Stop,
    /// The commanded phases, relative to the master and to the twin, move by more than two steps against the true errors of the cranks.
    Correction,
}

/// Response, and the time at which the outputs began it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Responded {
    /// Kind of the response.
    pub response: Response,
    /// Beginning of the tick in which the first output of the response was played.
    pub place: Place,
    /// Turns of the master three ticks before that. Detection may take as many ticks.
    pub turns: f64,
    /// True if cranks were beyond a limit at that place.
    pub is_beyond_limit: bool,
    /// Longest stay beyond a limit until then, as [`super::watch::Observation::stay_turns`].
    pub stay_turns: f64,
    /// True if no index sensor had shown it by then, as [`super::watch::Observation::is_hidden`].
    pub is_hidden: bool,
}

/// Outputs of one tick, as the judge compares them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Commanded speed of the master, in units of 2⁻⁴⁸ turns per tick.
    pub speed: i64,
    /// True if the enable line of the drives is on.
    pub drives_enabled: bool,
    /// True if the reported state is a stop.
    pub stopping: bool,
    /// Commanded phases minus the master's, turns.
    pub offset_turns: Axes<f64>,
}

/// Outputs of a case's clean run, tick by tick since power-up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Twin {
    ticks: Vec<Outputs>,
}

impl Outputs {
    /// Outputs of a tick.
    pub fn new(moment: &Moment<'_>) -> Self {
        let commands = moment.command_turns;
        Self {
            speed: moment.telemetry.motion.speed.to_bits(),
            drives_enabled: moment.drives_enabled,
            stopping: moment.telemetry.state == State::Stop,
            offset_turns: per_axis(commands.len(), |i| commands[i] - moment.master_turns),
        }
    }
}

impl Twin {
    /// Returns the outputs in a tick since power-up. After the end of the run, these are the outputs of its last tick.
    fn at(&self, tick: usize) -> Option<&Outputs> {
        self.ticks.get(tick).or(self.ticks.last())
    }
}

/// Number of a tick since power-up.
fn tick_of(moment: &Moment<'_>) -> usize {
    (moment.start_ns / (moment.end_ns - moment.start_ns)) as usize
}

impl Observer for Twin {
    fn tick(&mut self, moment: &Moment<'_>) {
        let tick = tick_of(moment);
        if self.ticks.len() < tick {
            // A missed tick holds the outputs of the tick before it.
            let before = self.ticks.last().cloned().unwrap_or_default();
            self.ticks.resize(tick, before);
        }
        self.ticks.push(Outputs::new(moment));
    }
}

/// Start of a motion that may be a stop.
#[derive(Clone, Copy, Debug)]
struct Start {
    responded: Responded,
    /// First tick since then in which this run reports a stop and the twin does not.
    reported: Option<Responded>,
    program_done: bool,
    /// True if the commanded speed has begun to fall.
    falls: bool,
}

/// Circumstances of a tick since the fault.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// Beginning of the tick.
    pub place: Place,
    /// Turns of the master three ticks before that.
    pub turns: f64,
    /// True if cranks were beyond a limit at that place.
    pub is_beyond_limit: bool,
    /// Longest stay beyond a limit until then, as [`super::watch::Observation::stay_turns`].
    pub stay_turns: f64,
    /// True if no index sensor had shown it by then, as [`super::watch::Observation::is_hidden`].
    pub is_hidden: bool,
    /// True if the program was over.
    pub program_done: bool,
    /// True errors of the cranks, turns.
    pub errors: &'a [f64],
}

impl Now<'_> {
    const fn responds(&self, response: Response) -> Responded {
        Responded {
            response,
            place: self.place,
            turns: self.turns,
            is_beyond_limit: self.is_beyond_limit,
            stay_turns: self.stay_turns,
            is_hidden: self.is_hidden,
        }
    }
}

/// Observer of the outputs since the fault. It keeps the first response of each kind.
#[derive(Clone, Debug)]
pub struct Responses<'a> {
    /// Clean run to compare with. Without one, no output counts as a response.
    pub twin: Option<&'a Twin>,
    /// Offset above which a motion counts as a correction, turns.
    min_turns: f64,
    speed: i64,
    acceleration: i64,
    were_enabled: bool,
    /// Offsets relative to the twin's when the fault came.
    offset_turns: Option<Axes<f64>>,
    /// First tick in which the commanded speed differs from the twin's.
    departed: Option<Responded>,
    slows: Option<Start>,
    corrects: Option<Responded>,
    off: Option<Responded>,
    stop: Option<Responded>,
    correction: Option<Responded>,
}

/// Phase offset above which a motion counts as a correction, steps.
const CORRECTION_STEPS: f64 = 2.0;

/// Largest difference of phase offsets that may be rounding. Turns have a resolution of 2⁻⁴⁸ and may be as large as a million.
const ROUNDING_TURNS: f64 = 1e-9;

impl<'a> Responses<'a> {
    /// Observer of a run at power-up. Its axes make `steps_per_turn` of the crank.
    pub fn new(steps_per_turn: f64) -> Self {
        Self {
            twin: None,
            min_turns: CORRECTION_STEPS / steps_per_turn,
            speed: 0,
            acceleration: 0,
            were_enabled: false,
            offset_turns: None,
            departed: None,
            slows: None,
            corrects: None,
            off: None,
            stop: None,
            correction: None,
        }
    }

    /// Returns the first event in which the machine stops or its drives go off.
    pub fn stopped(&self) -> Option<Responded> {
        match (self.stop, self.off) {
            (Some(stop), Some(off)) => Some(first(stop, off)),
            (stop, off) => stop.or(off),
        }
    }

    /// Returns the first correction, whether it suffices or not.
    pub const fn corrected(&self) -> Option<Responded> {
        self.correction
    }

    /// Takes in one tick. `now` is given from the fault on.
    pub fn tick(&mut self, moment: &Moment<'_>, now: Option<&Now<'_>>) {
        match now {
            Some(now) => self.take(tick_of(moment), &Outputs::new(moment), now),
            None => self.before(
                moment.telemetry.motion.speed.to_bits(),
                moment.drives_enabled,
            ),
        }
    }

    const fn before(&mut self, speed: i64, drives_enabled: bool) {
        self.acceleration = speed - self.speed;
        self.speed = speed;
        self.were_enabled = drives_enabled;
    }

    fn take(&mut self, tick: usize, outputs: &Outputs, now: &Now<'_>) {
        if let Some(twin) = self.twin.and_then(|twin| twin.at(tick)) {
            self.stopping(outputs, twin, now);
            self.offsets(outputs, twin, now);
        }
        self.before(outputs.speed, outputs.drives_enabled);
    }

    fn stopping(&mut self, outputs: &Outputs, twin: &Outputs, now: &Now<'_>) {
        if self.were_enabled && !outputs.drives_enabled && twin.drives_enabled {
            self.off.get_or_insert(now.responds(Response::Off));
        }
        let begins = now.responds(Response::Stop);
        if outputs.speed != twin.speed {
            self.departed.get_or_insert(begins);
        }
        let acceleration = outputs.speed - self.speed;
        let jerk = acceleration - self.acceleration;
        if jerk < 0 && self.slows.is_none() && self.speed > 0 {
            self.slows = Some(Start {
                responded: begins,
                reported: None,
                program_done: now.program_done,
                falls: false,
            });
        }
        let Some(slows) = &mut self.slows else {
            return;
        };
        if outputs.stopping && !twin.stopping {
            slows.reported.get_or_insert(begins);
        }
        if outputs.speed == 0 {
            let start = *slows;
            self.slows = None;
            self.rested(start);
            return;
        }
        slows.falls |= acceleration < 0;
        let recovers = if slows.falls {
            acceleration >= 0
        } else {
            jerk > 0 || acceleration == 0 && jerk == 0
        };
        if recovers {
            self.slows = None;
        }
    }

    /// Records that the commanded speed has fallen to zero without a recovery since `start`.
    fn rested(&mut self, start: Start) {
        // Drives that go off end any motion. It was a stop only if it had slowed down or was reported as one.
        if self.off.is_some() && !start.falls && start.reported.is_none() {
            return;
        }
        let Some(departed) = self.departed else {
            return;
        };
        let in_step = departed.place.moment >= start.responded.place.moment;
        let begin = match start.reported {
            _ if start.program_done && !in_step => return,
            Some(reported) if in_step => first(reported, departed),
            None if in_step => departed,
            reported => reported.unwrap_or(start.responded),
        };
        self.stop.get_or_insert(begin);
    }

    fn offsets(&mut self, outputs: &Outputs, twin: &Outputs, now: &Now<'_>) {
        if self.correction.is_some() {
            return;
        }
        let (own, twin) = (&outputs.offset_turns, &twin.offset_turns);
        let apart = per_axis(own.len().min(twin.len()), |i| own[i] - twin[i]);
        let from = self.offset_turns.get_or_insert_with(|| apart.clone());
        let moved = apart
            .iter()
            .zip(from.iter())
            .map(|(apart, from)| apart - from);
        let against_turns = -along(moved, now.errors);
        if against_turns <= ROUNDING_TURNS {
            self.corrects = None;
            return;
        }
        let begin = *self
            .corrects
            .get_or_insert(now.responds(Response::Correction));
        if against_turns > self.min_turns {
            self.correction = Some(begin);
        }
    }
}

const fn first(a: Responded, b: Responded) -> Responded {
    if a.place.moment < b.place.moment {
        a
    } else {
        b
    }
}

/// Component of moves along the errors, without the part that is common to all cranks.
fn along(moved: impl Iterator<Item = f64>, errors: &[f64]) -> f64 {
    let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let (mut sum, mut squares) = (0.0, 0.0);
    for (moved, error) in moved.zip(errors) {
        sum += moved * (error - mean);
        squares += (error - mean) * (error - mean);
    }
    if squares == 0.0 {
        return 0.0;
    }
    sum / squares.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn now(tick: usize, program_done: bool, errors: &[f64]) -> Now<'_> {
        Now {
            place: Place {
                moment: tick as u64,
                t_s: tick as f64,
                turns: 0.0,
                speed_hz: 0.0,
                acceleration_hz_per_s: 0.0,
                state: State::Run,
            },
            turns: 0.0,
            is_beyond_limit: false,
            stay_turns: 0.0,
            is_hidden: false,
            program_done,
            errors,
        }
    }

    fn outputs(speed: i64) -> Outputs {
        Outputs {
            speed,
            drives_enabled: true,
            ..Outputs::default()
        }
    }

    /// Returns the tick of the first stop of a run with these speeds and this twin. The program is over from tick `done` on.
    fn stop(speeds: &[i64], twin: &[i64], done: usize) -> Option<u64> {
        stop_reported(speeds, usize::MAX, twin, done)
    }

    /// Returns the tick of the first stop, if a stop is reported from tick `at` on.
    fn stop_reported(speeds: &[i64], at: usize, twin: &[i64], done: usize) -> Option<u64> {
        let ticks = twin.iter().copied().map(outputs).collect();
        let twin = Twin { ticks };
        let mut responses = Responses::new(3200.0);
        responses.twin = Some(&twin);
        for (tick, &speed) in speeds.iter().enumerate() {
            let mut outputs = outputs(speed);
            outputs.stopping = tick >= at;
            responses.take(tick, &outputs, &now(tick, tick >= done, &[]));
        }
        responses.stopped().map(|stopped| stopped.place.moment)
    }

    /// If this fails, a ramp or the program's own stop counts as a stop, and an undetected fault appears detected. Or a stop counts from
    /// the tick in which the speed falls, and a stop of an accelerating machine appears late.
    #[test]
    fn a_stop_begins_where_the_commanded_acceleration_falls_for_good() {
        let hold = [0, 2, 6, 10, 12, 12, 12, 12, 12, 12, 12, 9, 4, 1, 0, 0];
        assert_eq!(stop(&hold, &hold, 11), None);
        // The stop begins in the hold, and then in the ramp, where the speed rises for one more tick.
        assert_eq!(
            stop(&[0, 2, 6, 10, 12, 12, 11, 8, 4, 1, 0], &hold, 99),
            Some(6)
        );
        assert_eq!(stop(&[0, 2, 6, 9, 9, 6, 2, 0], &hold, 99), Some(3));
        // The machine slows down, speeds up again, and stops later.
        let slower = [0, 2, 6, 10, 12, 12, 10, 10, 12, 11, 8, 4, 0];
        assert_eq!(stop(&slower, &hold, 99), Some(9));
        // Homing takes longer than the twin's, so the program ends later; or the machine stops before.
        let later = [0, 2, 2, 2, 6, 10, 12, 12, 12, 12, 12, 12, 12, 9, 4, 1, 0];
        assert_eq!(stop(&later, &hold, 13), None);
        assert_eq!(stop_reported(&later, 13, &hold, 13), None);
        assert_eq!(stop(&later, &hold, 99), Some(13));
        // A faster stop replaces the program's own.
        assert_eq!(
            stop(
                &[0, 2, 6, 10, 12, 12, 12, 12, 12, 12, 12, 9, 2, 0],
                &hold,
                11
            ),
            Some(12)
        );
    }

    /// If this fails, a stop that coincides with the end of a ramp counts only from the first difference, and appears late although no stop
    /// can be faster. Or the report counts without the outputs, and a loop that only reports a stop passes.
    #[test]
    fn a_reported_stop_counts_only_if_outputs_confirm_it() {
        let ramp = [0, 2, 6, 10, 12, 13, 13, 13, 13, 13, 13, 13];
        let stops = [0, 2, 6, 10, 12, 13, 13, 13, 12, 9, 5, 2, 0];
        assert_eq!(stop_reported(&stops, 5, &ramp, 99), Some(8));
        let through = [0, 2, 6, 10, 12, 13, 12, 9, 5, 2, 0, 0];
        assert_eq!(stop(&through, &ramp, 99), Some(6));
        assert_eq!(stop_reported(&through, 5, &ramp, 99), Some(5));
        assert_eq!(stop_reported(&ramp, 5, &ramp, 99), None);
    }

    /// If this fails, the enable line of the twin does not count, and the end of a scene is a response.
    #[test]
    fn drives_off_counts_only_if_the_twin_stays_enabled() {
        let off = |twin_stays: bool| {
            let mut ticks = vec![outputs(5); 4];
            ticks[3].drives_enabled = twin_stays;
            let twin = Twin { ticks };
            let mut responses = Responses::new(3200.0);
            responses.twin = Some(&twin);
            for tick in 0..4 {
                let mut outputs = outputs(5);
                outputs.drives_enabled = tick < 3;
                responses.take(tick, &outputs, &now(tick, false, &[]));
            }
            responses
                .stopped()
                .map(|off| (off.response, off.place.moment))
        };
        assert_eq!(off(true), Some((Response::Off, 3)));
        assert_eq!(off(false), None);
    }

    /// If this fails, a correction in any direction counts, and one that moves cranks further apart passes. Or a correction counts only
    /// once it exceeds two steps, and a slow correction appears late.
    #[test]
    fn a_correction_moves_against_the_error_and_counts_from_its_first_tick() {
        let corrected = |offsets: [f64; 5], twin_turns: f64, error_turns: f64| {
            let with = |offset_turns| Outputs {
                offset_turns: Axes::from_iter([0.0, offset_turns]),
                ..outputs(5)
            };
            let twin = Twin {
                ticks: vec![with(twin_turns); 5],
            };
            let errors = [0.25, 0.25 + error_turns];
            let mut responses = Responses::new(1000.0);
            responses.twin = Some(&twin);
            for (tick, offset) in offsets.into_iter().enumerate() {
                responses.take(tick, &with(offset), &now(tick, false, &errors));
            }
            responses
                .corrected()
                .map(|corrected| corrected.place.moment)
        };
        // With two cranks, half of a difference belongs to each.
        let moves = [0.0, 0.0, 0.0015, 0.003, 0.004];
        assert_eq!(corrected(moves, 0.0, -0.01), Some(2));
        assert_eq!(corrected(moves, 0.5, -0.01), Some(2));
        assert_eq!(corrected(moves, 0.0, 0.01), None);
        assert_eq!(corrected([0.0, 0.001, 0.002, 0.0, 0.0], 0.0, -0.01), None);
    }
}
