//! Cranks that move arbitrarily: any path of the phase error in pieces, and not only known faults.

use super::judge::{Machine, Sensors};
use super::*;
use proptest::prelude::*;

/// Turns of the master in one tick.
const SPEED: f64 = 0.01;

/// Part of a path: the phase error changes, at once or at an even rate, and stays.
#[derive(Clone, Copy, Debug)]
struct Piece {
    by_turns: f64,
    over_turns: f64,
    stay_turns: f64,
}

fn piece() -> impl Strategy<Value = Piece> {
    // A blow or lost steps. A crank does not jump by half a turn in a tick.
    let jump = prop_oneof![-0.06..0.06_f64, -0.45..0.45_f64].prop_map(|by| (by, 0.0));
    // From slow drift to four times the speed, ahead or back.
    let rate = prop_oneof![-0.05..0.05_f64, -4.0..4.0_f64];
    let ramp = (rate, 0.03..4.0_f64).prop_map(|(rate, over)| (rate * over, over));
    (prop_oneof![jump, ramp], 0.0..2.5_f64).prop_map(|((by_turns, over_turns), stay_turns)| Piece {
        by_turns,
        over_turns,
        stay_turns,
    })
}

/// Places of the flags: all at one angle, a few ticks apart, so that pulses come while others are evaluated, or anywhere.
fn flags() -> impl Strategy<Value = PerAxis<f64>> {
    prop_oneof![
        Just([0.0; MAX_AXES]),
        prop::array::uniform6(0.0..9.0_f64).prop_map(|ticks| ticks.map(|ticks| ticks * SPEED)),
        prop::array::uniform6(0.0..1.0_f64),
    ]
}

/// Phase error at a time that counts from the beginning of the path.
fn error_at(path: &[Piece], mut time: f64) -> f64 {
    let mut error = 0.0;
    for piece in path {
        if time <= 0.0 {
            return error;
        }
        if time < piece.over_turns {
            return error + piece.by_turns * time / piece.over_turns;
        }
        error += piece.by_turns;
        time -= piece.over_turns + piece.stay_turns;
    }
    error
}

fn duration(path: &[Piece]) -> f64 {
    path.iter()
        .map(|piece| piece.over_turns + piece.stay_turns)
        .sum()
}

/// Errors of readings, in parts of the largest.
#[derive(Clone, Copy, Debug)]
enum Errs {
    None,
    /// Any part, drawn from this seed.
    Uniform(u64),
    /// The largest with either sign, drawn from this seed.
    Extreme(u64),
    /// The largest, with a sign that changes from reading to reading. A bit for each axis has the first sign.
    Alternating(u8),
    /// The largest, with a sign for each axis.
    Constant(u8),
}

impl Errs {
    /// Error of a reading of an axis. Index and encoder count as two axes.
    fn of(self, axis: usize, reading: i64) -> f64 {
        let random = |seed: u64| {
            // SplitMix64.
            let mut z = (seed ^ (axis as u64) << 56).wrapping_add(
                (reading as u64)
                    .wrapping_add(1)
                    .wrapping_mul(0x9e37_79b9_7f4a_7c15),
            );
            z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            (z ^ z >> 31) as i64 as f64 / (i64::MAX as f64)
        };
        let sign = |is_negative: bool| if is_negative { -1.0 } else { 1.0 };
        let bit = |signs: u8| signs >> (axis % 8) & 1 == 1;
        match self {
            Self::None => 0.0,
            Self::Uniform(seed) => random(seed),
            Self::Extreme(seed) => sign(random(seed) < 0.0),
            Self::Alternating(signs) => sign(bit(signs) ^ (reading & 1 == 1)),
            Self::Constant(signs) => sign(bit(signs)),
        }
    }
}

fn errs() -> impl Strategy<Value = Errs> {
    prop_oneof![
        any::<u64>().prop_map(Errs::Uniform),
        any::<u64>().prop_map(Errs::Extreme),
        any::<u8>().prop_map(Errs::Alternating),
        any::<u8>().prop_map(Errs::Constant),
    ]
}

/// Machine whose cranks have known errors, and whose sensors err.
#[derive(Clone, Debug)]
struct Case {
    machine: Machine,
    errs: Errs,
    /// The crank that moves; if `on_shaft` is true, away from its encoder.
    who: usize,
    on_shaft: bool,
    /// Turns after which its path begins: since homing is over, or since it began. An encoder shows no motion before its first reading.
    start: f64,
    path: Vec<Piece>,
}

impl Case {
    /// Largest error of one reading.
    fn reading(&self) -> f64 {
        match self.errs {
            Errs::None => 0.0,
            // A pulse is measured to a cycle.
            _ => 0.999 * self.machine.tolerance().min(self.machine.gate() / 4.0),
        }
    }

    /// Phase error that the index of an axis shows at a time, if the crank has the error `error`.
    fn by_index(&self, axis: usize, error: f64, time: f64) -> f64 {
        // One error for each passage: it changes half a turn from the flag.
        let passage = (time + error - self.machine.flags[axis] + 0.5).floor() as i64;
        error + self.errs.of(axis, passage) * self.reading()
    }

    /// Phase error that an encoder shows at a time before it is rounded down to a step, if the motor has the error `error`.
    fn by_encoder(&self, axis: usize, error: f64, time: f64) -> f64 {
        if self.reading() == 0.0 {
            return error;
        }
        let half_step = 0.5 / 3200.0;
        let tick = (time / SPEED).round() as i64;
        let err = self.errs.of(axis + MAX_AXES, tick) * (self.reading() - half_step);
        error + err + half_step
    }

    /// Turns `cranks` with these phase errors for some ticks, or until the monitor demands a stop. Returns the findings, and the tick of the
    /// demand.
    fn turn(
        &self,
        cranks: &mut Cranks,
        ticks: u32,
        error: impl Fn(usize, f64) -> f64,
    ) -> (Vec<(i32, Finding)>, Option<i32>) {
        let mut found = Vec::new();
        for _ in 0..ticks {
            let tick = cranks.tick;
            let now = cranks.turn_motors(
                1,
                |i, t| self.by_index(i, error(i, t), t),
                |i, _, pulse| pulse.filter(|_| self.machine.sensors[i].has_index()),
                |i, t| {
                    let is_still = self.on_shaft && i == self.who;
                    self.by_encoder(i, if is_still { 0.0 } else { error(i, t) }, t)
                },
            );
            let stops = now.iter().any(|(_, finding)| !finding.within_limits);
            found.extend(now);
            // The controller stops as well if homing finds a crank elsewhere, and beyond a limit.
            let monitor = &mut cranks.monitor;
            let has_moved = monitor.take_moved().is_some_and(|(axis, by)| {
                by.abs() > monitor.swing(axis)
                    && monitor.left_beyond_limits(&PerAxis::default()).is_some()
            });
            if stops || has_moved {
                return (found, Some(tick));
            }
        }
        (found, None)
    }

    /// Cranks at the beginning of homing, with these phase errors.
    fn begun(&self, error: impl Fn(usize, f64) -> f64) -> Cranks {
        let mut cranks = Cranks::new(configured(&self.machine.settings()), SPEED);
        cranks.flags = self.machine.flags;
        cranks.reset(|i, t| self.by_index(i, error(i, t), t));
        cranks
    }

    /// Turns `cranks` with these phase errors up to the end of homing. Nothing may be found.
    fn home(
        &self,
        cranks: &mut Cranks,
        error: impl Fn(usize, f64) -> f64,
    ) -> Result<(), TestCaseError> {
        let (found, stop) = self.turn(cranks, cranks.homing_ticks(), error);
        prop_assert!(found.is_empty() && stop.is_none(), "{found:?}");
        prop_assert!(cranks.monitor.is_homed());
        cranks.monitor.settle();
        Ok(())
    }

    /// Requires that the machine stops in time.
    fn stops(&self, is_homing: bool) -> Result<(), TestCaseError> {
        let mut cranks = self.begun(|_, _| 0.0);
        let ticks = if is_homing { 0 } else { cranks.homing_ticks() };
        let first = cranks.tick + ticks as i32;
        let from = f64::from(first) * SPEED + self.start;
        let error = |t: f64| error_at(&self.path, t - from);
        let Some(due) = self.due(is_homing, first, error) else {
            return Ok(());
        };
        if !is_homing {
            self.home(&mut cranks, |_, _| 0.0)?;
        }
        let ticks = (due + 2 - first) as u32;
        let (found, stop) = self.turn(&mut cranks, ticks, |i, t| {
            if i == self.who { error(t) } else { 0.0 }
        });
        prop_assert!(stop.is_some(), "due at {due}: {found:?}");
        Ok(())
    }

    /// Last tick before the one in which the machine must stop, if it must. An index does not distinguish whole turns, and a path that jumps
    /// across a whole turn passes through the limit.
    fn due(&self, is_homing: bool, first: i32, error: impl Fn(f64) -> f64) -> Option<i32> {
        let machine = &self.machine;
        let sensors = machine.sensors[self.who];
        let by_encoder = sensors.has_encoder() && !self.on_shaft;
        let alone = machine.single_axis_limit(self.who, is_homing, by_encoder, self.reading());
        let noise = machine.estimates(self.reading())[self.who];
        let limit = alone + noise.max(machine.tolerance());
        let last = first + ((self.start + duration(&self.path) + 4.0) / SPEED) as i32;
        let (mut passages, mut ahead) = (f64::INFINITY, 0.0);
        let mut stay: Option<Stay> = None;
        for tick in first..last {
            let time = f64::from(tick + 1) * SPEED;
            let error = error(time);
            let travel = time + error;
            let passed = (travel - machine.flags[self.who]).floor();
            if passed > core::mem::replace(&mut passages, passed) {
                ahead = (error - error.round()).max(0.0);
            }
            stay = stay.filter(|stay| stay.between == error.floor());
            if (error - error.round()).abs() <= limit {
                stay = None;
                continue;
            }
            let stay = stay.get_or_insert(Stay {
                since: tick,
                travel,
                between: error.floor(),
                ahead: ahead + noise,
            });
            let (turns, passes) = match sensors {
                // A jump is held back for a tick.
                Sensors::Encoder if !is_homing => (SPEED, 0.0),
                _ if !is_homing => (1.0 + (alone + stay.ahead).max(machine.gate()), 1.0),
                _ => (2.0 + alone.max(machine.gate()), 2.0),
            };
            let is_over = tick - stay.since >= (turns / SPEED).ceil() as i32;
            // A missing pulse is no evidence against an encoder: the crank has to pass its flag.
            if is_over && (!self.on_shaft || travel - stay.travel >= passes) {
                return Some(tick);
            }
        }
        None
    }
}

/// Stay of a crank beyond its limit without a break.
#[derive(Clone, Copy, Debug)]
struct Stay {
    since: i32,
    /// Phase of the crank at its beginning.
    travel: f64,
    /// Whole turns that are less than the error.
    between: f64,
    /// How far ahead the last pulse before it showed the crank.
    ahead: f64,
}

/// Machine with these sensors, and one watched crank that moves.
fn case(
    sensors: impl Strategy<Value = Vec<Sensors>>,
    errs: impl Strategy<Value = Errs>,
    start: core::ops::Range<f64>,
) -> impl Strategy<Value = Case> {
    let limits = prop_oneof![
        Just((3.0, 5.0, 15.0)),
        (1.0..30.0_f64, 1.0..45.0_f64, 5.0..90.0_f64)
    ];
    let cycle_steps = prop_oneof![Just(0_u32), Just(64), Just(200)];
    let reading_error_deg = prop_oneof![Just(0.25), 0.02..1.0_f64];
    let machine = (sensors, cycle_steps, reading_error_deg, limits, flags());
    let machine = machine.prop_map(|(sensors, cycle_steps, reading_error_deg, limits, flags)| {
        let (tilt_limit_mrad, warp_limit_deg, common_limit_deg) = limits;
        Machine {
            sensors,
            cycle_steps,
            reading_error_deg,
            tilt_limit_mrad,
            warp_limit_deg,
            common_limit_deg,
            flags,
        }
    });
    let path = prop::collection::vec(piece(), 1..6);
    (
        machine,
        errs,
        any::<prop::sample::Index>(),
        any::<bool>(),
        start,
        path,
    )
        .prop_map(|(machine, errs, who, on_shaft, start, path)| {
            let who = *who.get(&machine.watched());
            let mut case = Case {
                on_shaft: on_shaft && machine.sensors[who] == Sensors::Both,
                machine,
                errs,
                who,
                start,
                path,
            };
            // Some sensors can only be used where readings err less.
            let estimates = case.machine.estimates(case.reading());
            if !case.machine.bears(&estimates) {
                case.errs = Errs::None;
            }
            case
        })
}

/// The same sensors on all axes.
fn alike() -> impl Strategy<Value = Vec<Sensors>> {
    let sensors = prop_oneof![
        Just(Sensors::Index),
        Just(Sensors::Encoder),
        Just(Sensors::Both)
    ];
    (sensors, 2..=MAX_AXES).prop_map(|(sensors, count)| std::vec![sensors; count])
}

/// Any sensors on each axis, and some on one at least.
fn mixed() -> impl Strategy<Value = Vec<Sensors>> {
    let sensors = prop_oneof![
        Just(Sensors::None),
        Just(Sensors::Index),
        Just(Sensors::Encoder),
        Just(Sensors::Both)
    ];
    let all = prop::collection::vec(sensors, 2..=MAX_AXES);
    all.prop_filter("no axis has a sensor", |all| {
        all.iter().any(|sensors| *sensors != Sensors::None)
    })
}

proptest! {
    /// If this fails, a crank can stay beyond its limit for a turn without a stop, whatever its path was.
    #[test]
    fn a_crank_that_is_beyond_its_limit_for_a_turn_stops_the_machine(case in case(alike(), Just(Errs::None), 0.0..1.0)) {
        case.stops(false)?;
    }

    /// If this fails, a crank is detected later, or never, because others have other sensors or none.
    #[test]
    fn a_crank_beyond_its_limit_stops_a_machine_with_different_sensors(case in case(mixed(), Just(Errs::None), 0.0..1.0)) {
        case.stops(false)?;
    }

    /// If this fails, readings that err hide a crank for longer than the proof says.
    #[test]
    fn a_crank_beyond_its_limit_stops_the_machine_whatever_the_readings_err_by(case in case(mixed(), errs(), 0.0..1.0)) {
        case.stops(false)?;
    }

    /// If this fails, homing levels or runs with a crank that moved beyond its limit two turns before.
    #[test]
    fn a_crank_beyond_its_limit_is_detected_within_two_turns_of_homing(case in case(mixed(), Just(Errs::None), 2.0 * SPEED..2.5)) {
        case.stops(true)?;
    }

    /// If this fails, noise stops a machine whose cranks are within their limits and stay where they are.
    #[test]
    fn readings_within_their_error_stop_no_machine(
        case in case(mixed(), errs(), 0.0..1.0),
        direction in prop::array::uniform6(-1.0..1.0_f64),
        part in prop_oneof![Just(0.999), 0.0..0.999_f64],
    ) {
        let machine = &case.machine;
        // An encoder alone shows motion since power-up.
        let errors: Vec<f64> = machine.sensors.iter().zip(direction).map(|(sensors, error)| if sensors.has_index() { error } else { 0.0 }).collect();
        // A count is a whole number of steps.
        let reading = case.reading().max(1.0 / 3200.0);
        let max = machine.max_of(&errors, &machine.estimates(reading));
        let max = if max.is_finite() { max.max(0.0) } else { 0.0 };
        let error = |i: usize, _: f64| errors.get(i).map_or(0.0, |error| error * max * part);
        let mut cranks = case.begun(error);
        case.home(&mut cranks, error)?;
        let (found, stop) = case.turn(&mut cranks, 600, error);
        prop_assert!(found.is_empty() && stop.is_none(), "{found:?}");
    }
}
