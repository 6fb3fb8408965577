//! Integrates the runs edge by edge and compares them with the phase from which they were planned.

use super::*;
use crate::settings::PulseSettings;
use crate::units::ONE_TURN;
use proptest::prelude::*;
use std::vec::Vec;

const CLOCK_HZ: u32 = 125_000_000;
const QUARTER_MICROSECOND: f64 = 0.25e-6 * CLOCK_HZ as f64;

fn timing(tick_hz: u32) -> Lines {
    timing_of(tick_hz, 200.0, 300.0, 300.0)
}

fn timing_of(tick_hz: u32, width_ns: f64, dir_setup_ns: f64, dir_hold_ns: f64) -> Lines {
    let settings = PulseSettings {
        width_ns,
        dir_setup_ns,
        dir_hold_ns,
    };
    Lines {
        timing: PulseTiming::new(&settings, CLOCK_HZ, tick_hz).unwrap(),
        settings,
    }
}

/// Timing required of the lines, and the planner's timing in cycles.
#[derive(Clone, Copy)]
struct Lines {
    timing: PulseTiming,
    settings: PulseSettings,
}

/// A drive, as its STEP and DIR inputs drive it.
struct Drive {
    lines: Lines,
    cycle: u64,
    high: bool,
    forward: bool,
    last_edge: Option<u64>,
    last_rise: Option<u64>,
    last_turn: Option<u64>,
    position: i64,
    shortest: u64,
    /// Cycle of each rising edge, and the position after it.
    rises: Vec<(u64, i64)>,
}

impl Drive {
    fn new(lines: Lines) -> Self {
        Self {
            lines,
            cycle: 0,
            high: false,
            forward: true,
            last_edge: None,
            last_rise: None,
            last_turn: None,
            position: 0,
            shortest: u64::MAX,
            rises: Vec::new(),
        }
    }

    /// Plays the runs of a tick as the hardware does, and checks the rules that hold for all runs.
    fn play(&mut self, runs: &Runs) {
        let total: u64 = runs.iter().map(|run| u64::from(run.cycles())).sum();
        let tick = self.lines.timing.tick;
        assert_eq!(
            total,
            u64::from(tick),
            "the runs fill {total} cycles of {tick}"
        );
        let start = self.cycle;
        for run in runs {
            if run.is_pause() {
                self.turn(run.forward());
                self.cycle += u64::from(run.period());
            } else {
                assert_eq!(run.forward(), self.forward, "only a pause turns DIR");
            }
            for _ in 0..run.edges() {
                self.cycle += u64::from(run.period());
                self.edge();
            }
        }
        assert_eq!(self.cycle, start + total);
    }

    /// Starts a pause.
    fn turn(&mut self, forward: bool) {
        if forward == self.forward {
            return;
        }
        let at = self.cycle + u64::from(Run::DIR_DELAY);
        if let Some(rise) = self.last_rise {
            assert!(ns(at - rise) >= self.lines.settings.dir_hold_ns, "hold");
        }
        self.forward = forward;
        self.last_turn = Some(at);
    }

    fn edge(&mut self) {
        if let Some(last) = self.last_edge {
            self.shortest = self.shortest.min(self.cycle - last);
        }
        self.last_edge = Some(self.cycle);
        self.high = !self.high;
        if self.high {
            if let Some(turn) = self.last_turn {
                let since_ns = ns(self.cycle - turn);
                assert!(since_ns >= self.lines.settings.dir_setup_ns, "set-up");
            }
            self.position += if self.forward { 1 } else { -1 };
            self.last_rise = Some(self.cycle);
            self.rises.push((self.cycle, self.position));
        }
    }
}

fn ns(cycles: u64) -> f64 {
    cycles as f64 * 1e9 / f64::from(CLOCK_HZ)
}

/// Plays ticks with the given turns. Returns the drive, and the steps that were counted.
fn play_ticks(tick_hz: u32, steps_per_turn: u32, ticks: &[i64]) -> (Drive, i64) {
    play_with(timing(tick_hz), StepsPerTurn::whole(steps_per_turn), ticks)
}

fn play_with(lines: Lines, steps_per_turn: StepsPerTurn, ticks: &[i64]) -> (Drive, i64) {
    let mut planner = Planner::new(lines.timing, steps_per_turn);
    let mut drive = Drive::new(lines);
    let mut step_rate = StepRates::new(lines.timing.tick());
    let mut runs = Runs::new();
    let mut steps = 0;
    for &turns in ticks {
        steps += i64::from(planner.plan(Turns::from_bits(turns), 0, &mut step_rate, &mut runs));
        drive.play(&runs);
        assert_eq!(
            drive.position, steps,
            "the drive and the planner count differently"
        );
    }
    (drive, steps)
}

/// Exact time, in cycles, at which the phase crosses step `position` going up.
fn crossing(ticks: &[i64], steps_per_turn: u32, tick: u32, position: i64) -> f64 {
    let goal = i128::from(position) << FRACTION_BITS;
    let mut phase = 0_i128;
    for (i, &turns) in ticks.iter().enumerate() {
        let end = phase + i128::from(turns) * i128::from(steps_per_turn);
        if end >= goal {
            let part = (goal - phase) as f64 / (end - phase) as f64;
            return (i as f64 + part) * f64::from(tick);
        }
        phase = end;
    }
    panic!("step {position} is never crossed");
}

/// Converts steps/s to turns a tick.
fn turns_per_tick(step_hz: f64, steps_per_turn: u32, tick_hz: u32) -> i64 {
    (step_hz / f64::from(steps_per_turn) / f64::from(tick_hz) * HALF_STEP as f64) as i64
}

fn any_tick_hz() -> impl Strategy<Value = u32> {
    prop::sample::select(std::vec![500_u32, 1000, 2000, 4000, 8000, 10_000])
}

/// Motor turns and turns of the shaft: belts, gearboxes, and any.
fn any_gear() -> impl Strategy<Value = (u32, u32)> {
    prop_oneof![
        Just((1, 1)),
        prop::sample::select(std::vec![(57, 11), (50, 17), (20, 36), (3, 1), (1000, 999)]),
        (1_u32..=1000, 1_u32..=1000),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// If this fails, an axis behind a belt or gearbox departs from its exact ratio by a step or more within two million ticks, each of
    /// which takes as much of a turn as a tick can count. `cargo bench -p host-sim --bench soak -- --days 30` plays a month with two gears.
    #[test]
    fn steps_of_a_geared_axis_are_exact_after_a_million_turns(
        gear in any_gear(),
        steps_per_turn in prop::sample::select(std::vec![200_u32, 1600, 3217, 20_000, 102_400, 1_048_576]),
        seed: u64,
    ) {
        const MAX_COUNTS: f64 = 8000.0;
        let steps = StepsPerTurn::geared(steps_per_turn, gear);
        prop_assume!((4.0..=StepsPerTurn::MAX).contains(&steps.to_f64()));
        let (motor, shaft) = (i128::from(gear.0), i128::from(gear.1));
        let max = (MAX_COUNTS / steps.to_f64()).min(0.5) * ONE_TURN as f64;
        let goal = (2e6 * max) as i128; // a million turns, or fewer of finer steps
        let lines = timing(2000);
        let mut planner = Planner::new(lines.timing, steps);
        let (mut rates, mut runs) = (StepRates::new(lines.timing.tick()), Runs::new());
        let (mut travel, mut counted, mut random) = (0_i128, 0_i128, seed | 1);
        let mut tick = 0_u32;
        while travel < goal {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            // One tick in eight goes back.
            let sign = if random.is_multiple_of(8) { -1.0 } else { 1.0 };
            let turns = (sign * max * (0.5 + 0.5 * (random >> 11) as f64 / (1_u64 << 53) as f64)) as i64;
            travel += i128::from(turns);
            counted += i128::from(planner.count(Turns::from_bits(turns), 0, &mut rates, &mut runs));
            tick += 1;
            if tick.is_multiple_of(4096) || travel >= goal {
                let exact = travel * i128::from(steps_per_turn) * motor;
                prop_assert_eq!(counted, exact.div_euclid(shaft << FRACTION_BITS), "after {} ticks", tick);
            }
        }
    }
}

proptest! {
    /// Every rising edge of an axis that moves forward, up to 1 M steps/s, is within 0.25 µs of the time at which the
    /// phase crosses its step. No edge is missing, and pulses keep their width.
    #[test]
    fn edges_are_within_250_ns_of_their_phase_crossing(
        tick_hz in any_tick_hz(),
        motor_steps in 4_u32..65_536,
        gear in any_gear(),
        rates in prop::collection::vec(prop_oneof![0.0..1.0_f64, 0.0..1e6_f64, 0.9e6..1e6_f64], 1..12),
        repeats in 1_usize..4,
    ) {
        let per_turn = StepsPerTurn::geared(motor_steps, gear);
        prop_assume!(per_turn.to_f64() >= 4.0);
        // In turns of a shaft that many times as slow, the steps per turn are whole.
        let (steps_per_turn, slower) = (motor_steps * gear.0, i64::from(gear.1));
        let ticks: Vec<i64> = rates
            .iter()
            .flat_map(|&rate| std::iter::repeat_n(turns_per_tick(rate, steps_per_turn, tick_hz) * slower, repeats))
            .collect();
        prop_assume!(ticks.iter().all(|&turns| turns < ONE_TURN / 2));
        let (drive, steps) = play_with(timing(tick_hz), per_turn, &ticks);
        let total: i128 = ticks.iter().map(|&t| i128::from(t) * i128::from(steps_per_turn)).sum();
        prop_assert_eq!(i128::from(steps), total.div_euclid(i128::from(slower) << FRACTION_BITS));
        prop_assert_eq!(drive.rises.len() as i64, steps);
        for (cycle, position) in drive.rises {
            let due = crossing(&ticks, steps_per_turn, drive.lines.timing.tick, position * slower);
            let error = cycle as f64 - due;
            prop_assert!(error.abs() <= QUARTER_MICROSECOND, "step {position}: {error} cycles");
        }
        prop_assert!(drive.shortest >= u64::from(timing(tick_hz).timing.width));
    }

    /// For every motion of the axis and all timing of its drive, ticks are filled, all times are kept, and no step is
    /// lost or added. Speeds stay around zero, where an axis reverses in practice.
    #[test]
    fn changes_of_direction_lose_no_steps(
        tick_hz in any_tick_hz(),
        steps_per_turn in 4_u32..65_536,
        width_ns in 8.0..5000.0_f64,
        dir_setup_ns in 0.0..5000.0_f64,
        dir_hold_ns in 0.0..5000.0_f64,
        parts in prop::collection::vec(
            prop_oneof![-1.1e-3..1.1e-3_f64, -0.02..0.02_f64, -1.0..1.0_f64],
            1..60,
        ),
    ) {
        let lines = timing_of(tick_hz, width_ns, dir_setup_ns, dir_hold_ns);
        let max = lines.timing.max_step_hz(tick_hz);
        let ticks: Vec<i64> =
            parts.iter().map(|&part| turns_per_tick(part * max, steps_per_turn, tick_hz)).collect();
        let (drive, steps) = play_with(lines, StepsPerTurn::whole(steps_per_turn), &ticks);
        let total: i128 = ticks.iter().map(|&t| i128::from(t) * i128::from(steps_per_turn)).sum();
        prop_assert_eq!(i128::from(steps), total >> FRACTION_BITS);
        let width = ((width_ns / 8.0).ceil() as u64).max(u64::from(Run::MIN_CYCLES));
        prop_assert!(drive.shortest >= width, "{} cycles, of {width}", drive.shortest);
    }

    /// The greatest number of edges that settings allow fits the runs of a tick at any spacing.
    #[test]
    fn edges_of_the_fastest_axis_fit_in_a_tick(tick_hz in any_tick_hz(), part in 0.9..1.0_f64, phase in 0..1_i64 << 40) {
        let steps_per_turn = 10_000;
        let max = timing(tick_hz).timing.max_step_hz(tick_hz);
        let turns = turns_per_tick(max * part, steps_per_turn, tick_hz);
        let (drive, steps) = play_ticks(tick_hz, steps_per_turn, &[phase, turns, turns, turns]);
        prop_assert_eq!(drive.position, steps);
    }
}

/// At a steady rate that divides the clock, a tick takes few runs. The last edge is due at the very end of the tick. It
/// keeps the guard, and the last chunk is shortened for it.
#[test]
fn a_steady_rate_needs_few_runs_per_tick() {
    let mut planner = Planner::new(timing(2000).timing, StepsPerTurn::whole(2000));
    let mut runs = Runs::new();
    let turns = Turns::from_num(0.125); // 250 steps in a tick of 62,500 cycles: 125 cycles an edge
    let mut step_rate = StepRates::new(timing(2000).timing.tick());
    planner.plan(turns, 0, &mut step_rate, &mut runs);
    planner.plan(turns, 0, &mut step_rate, &mut runs);
    assert!(runs.len() <= 3, "{runs:?}");
    let exact: u32 = runs
        .iter()
        .filter(|run| run.period() == 125)
        .map(|run| run.edges())
        .sum();
    assert!(exact >= 500 - CHUNK, "{runs:?}");
}

/// STEP stays low for its width before it rises again, even where set-up and hold are shorter than that.
#[test]
fn a_change_of_direction_keeps_the_pulse_width_low() {
    let lines = timing_of(2000, 2500.0, 500.0, 500.0);
    let step = HALF_STEP as f64 / 3200.0;
    let ticks = [1.001, -0.999, 0.9985, -1.0, 1.0].map(|steps| (steps * step) as i64);
    let (drive, _) = play_with(lines, StepsPerTurn::whole(3200), &ticks);
    assert!(drive.shortest >= 313, "{} cycles of 8 ns", drive.shortest);
}

#[test]
fn a_too_long_direction_setup_is_refused() {
    let settings = PulseSettings {
        width_ns: 5000.0,
        dir_setup_ns: 50_000.0,
        dir_hold_ns: 5000.0,
    };
    assert_eq!(
        PulseTiming::new(&settings, CLOCK_HZ, 10_000)
            .unwrap_err()
            .key,
        "pulse.dir_setup_ns"
    );
    assert!(PulseTiming::new(&settings, CLOCK_HZ, 2000).is_ok());
}

/// If this fails, another clock is accepted, and edges come at other times than planned.
#[test]
fn times_follow_the_step_clock() {
    let settings = PulseSettings {
        width_ns: 200.0,
        dir_setup_ns: 300.0,
        dir_hold_ns: 300.0,
    };
    let timing = |clock_hz, tick_hz| PulseTiming::new(&settings, clock_hz, tick_hz);
    let slower = timing(48_000_000, 2000).unwrap();
    assert_eq!((slower.tick(), slower.width), (24_000, 10));
    for (clock_hz, tick_hz) in [
        (0, 2000),
        (125_000_001, 2000),
        (4_000_000, 2000),
        (150_000_000, 500),
    ] {
        assert_eq!(timing(clock_hz, tick_hz).unwrap_err().key, "clock_hz");
    }
}
