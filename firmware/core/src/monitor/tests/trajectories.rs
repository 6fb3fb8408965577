//! Cranks that move arbitrarily: any path of the phase error in pieces, and not only known faults.

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

/// First tick up to which a path has been beyond `limit` for `turns` of the master without a break, and `travel` has grown by one turn in
/// that time. An index does not distinguish whole turns. A path that jumps across a whole turn passes through the limit.
fn turn_beyond(
    limit: f64,
    turns: f64,
    ticks: u32,
    error: impl Fn(u32) -> f64,
    travel: impl Fn(u32) -> f64,
) -> Option<u32> {
    let least = (turns / SPEED).ceil() as u32;
    let mut since = None;
    for tick in 0..ticks {
        let error = error(tick);
        let between = error.floor();
        let is_beyond = (error - error.round()).abs() > limit;
        since = since.filter(|&(_, before)| is_beyond && before == between);
        if is_beyond {
            let (since, _) = *since.get_or_insert((tick, between));
            if tick - since >= least && travel(tick) - travel(since) >= 1.0 {
                return Some(tick);
            }
        }
    }
    None
}

/// Sensor that shows the phase error of the crank that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// Its index, once a turn.
    Index,
    /// Its encoder, in every tick.
    Encoder,
    /// Its index, compared with its encoder: the crank moves on its shaft.
    Difference,
}

/// Ticks until a machine stops whose cranks take these paths, from `start` turns after homing on, and ticks until it must stop. Returns the
/// findings too.
fn stop_of(
    shown: Shown,
    count: usize,
    cycle_steps: u32,
    flags: PerAxis<f64>,
    start: f64,
    paths: &[(usize, Vec<Piece>)],
) -> (Option<i32>, Option<f64>, Vec<(i32, Finding)>) {
    let mut settings = settings(count, 3.0, 5.0, 15.0);
    for (axis, flag) in settings.axes.iter_mut().zip(flags) {
        axis.cycle_steps = cycle_steps;
        axis.index_turns = Some(flag);
        axis.encoder = shown != Shown::Index;
    }
    let monitor = configured(&settings);
    let reading = 0.25 / 360.0;
    let mut cranks = Cranks::new(monitor, SPEED);
    cranks.flags = flags;
    let mut cranks = cranks.homed();
    let first = cranks.tick;
    let from = f64::from(first) * SPEED + start;
    let longest = paths
        .iter()
        .map(|(_, path)| duration(path))
        .fold(0.0, f64::max);
    let ticks = ((start + longest + 3.0) / SPEED) as u32;
    let error = |i: usize, t: f64| {
        let path = paths.iter().find(|(axis, _)| *axis == i);
        path.map_or(0.0, |(_, path)| error_at(path, t - from))
    };
    let due = paths.iter().filter_map(|&(axis, _)| {
        let alone = true_alone(count, axis);
        let gate = 4.0 * cranks.monitor.tolerance(axis).to_num::<f64>();
        let at = |tick: u32| (f64::from(first) + f64::from(tick + 1)) * SPEED;
        let error = |tick| error(axis, at(tick));
        // A missing pulse is no evidence against an encoder: the crank has to pass its flag.
        let travel = |tick| match shown {
            Shown::Difference => at(tick) + error(tick),
            Shown::Index | Shown::Encoder => at(tick),
        };
        let turns = 1.0 + alone.max(gate);
        let until = turn_beyond(alone + reading, turns, ticks, error, travel);
        Some(f64::from(until?) + 1.0)
    });
    let due = due.reduce(f64::min);
    let found = if shown == Shown::Difference {
        cranks.turn_shafts(ticks, error)
    } else {
        cranks.turn(ticks, error)
    };
    let stop = found.iter().find(|(_, finding)| !finding.within_limits);
    (stop.map(|(tick, _)| tick - first), due, found)
}

proptest! {
    /// If this fails, a crank can stay beyond its limit for a turn without a stop, whatever its path was.
    #[test]
    fn a_crank_that_is_beyond_its_limit_for_a_turn_stops_the_machine(
        shown in prop_oneof![Just(Shown::Index), Just(Shown::Encoder), Just(Shown::Difference)],
        count in 2..=6_usize,
        who in 0..6_usize,
        start in 0.0..1.0_f64,
        cycle_steps in prop_oneof![Just(0_u32), Just(64), Just(200)],
        flags in flags(),
        path in prop::collection::vec(piece(), 1..6),
    ) {
        let (stop, due, found) = stop_of(shown, count, cycle_steps, flags, start, &[(who % count, path)]);
        if let Some(due) = due {
            prop_assert!(stop.is_some_and(|stop| f64::from(stop) <= due), "{stop:?}, and due {due}: {found:?}");
        }
    }
}
