//! Every axis is commanded to exactly the phase that follows from the master's travel, whatever
//! happens in a run.
//!
//! Random small scenes run through the whole path. At every tick the test computes the axes' phases
//! and steps from the sum of the master's speeds alone, in integers of 128 bits. It counts the edges
//! of the pulses as a drive counts them.

#[path = "../support/random.rs"]
mod random;

use cophase_core::units::{FRACTION_BITS, ONE_TURN, Phase, Turns};
use cophase_scene::file::Drive;
use host_sim::checked::Checked;
use host_sim::sim::{Moment, Observer, simulate};
use proptest::prelude::*;
use random::{Axis, any_plan};

/// Expected position of an axis, from the travel of the master.
impl Axis {
    /// ⌊master · p / q⌋, 2⁻⁴⁸ turn.
    fn travelled(&self, master: i128) -> i128 {
        (master * i128::from(self.ratio.0)).div_euclid(i128::from(self.ratio.1))
    }

    /// The phase after that travel, wrapped as in the core: 16 bits of turns, 48 of their fraction.
    fn phase(&self, travelled: i128) -> Phase {
        let offset = i128::from(self.offset_eighths) * i128::from(ONE_TURN / 8);
        Phase::from_turns(Turns::from_bits((offset + travelled) as i64))
    }

    /// Whole steps in that travel.
    fn steps(&self, travelled: i128) -> i64 {
        let (motor, crank) = self.gear;
        let steps = travelled * i128::from(self.steps_per_turn) * i128::from(motor);
        steps.div_euclid(i128::from(crank) << FRACTION_BITS) as i64
    }
}

/// Sums the master's travel and compares.
struct Exact<'a> {
    axes: &'a [Axis],
    master: i128,
    /// Levels of each axis's STEP and DIR, and the count of the edges.
    counters: Vec<(bool, bool, i64)>,
    /// Ticks in which anything moved, and whether the drives were off meanwhile.
    moved: u64,
    off_while_moving: bool,
}

impl Observer for Exact<'_> {
    fn tick(&mut self, moment: &Moment<'_>) {
        let (telemetry, played) = (moment.telemetry, moment.played);
        let speed = telemetry.motion.speed.to_bits();
        self.master += i128::from(speed);
        self.moved += u64::from(speed != 0);
        self.off_while_moving |= speed != 0 && !moment.drives_enabled;
        let at = moment.start_ns;
        assert_eq!(
            telemetry.phase,
            Phase::from_turns(Turns::from_bits(self.master as i64))
        );
        for (i, axis) in self.axes.iter().enumerate() {
            let travelled = axis.travelled(self.master);
            let (phase, steps) = (axis.phase(travelled), axis.steps(travelled));
            assert_eq!(
                telemetry.axis_phase(i),
                phase,
                "at {at} ns: phase of axis {i}"
            );
            assert_eq!(telemetry.steps(i), steps, "at {at} ns: steps of axis {i}");
            if axis.ratio == (1, 1) && axis.offset_eighths == 0 {
                assert_eq!(
                    telemetry.axis_phase(i),
                    telemetry.phase,
                    "at {at} ns: axis {i}"
                );
            }
            if axis.servo {
                let setpoint = if axis.reversed {
                    played.setpoints[i].reversed()
                } else {
                    played.setpoints[i]
                };
                assert_eq!(setpoint.position, phase, "at {at} ns: setpoint of axis {i}");
                continue;
            }
            let (high, forward, counted) = &mut self.counters[i];
            for run in played.runs(i) {
                if run.is_pause() {
                    *forward = run.forward();
                }
                for _ in 0..run.edges() {
                    *high = !*high;
                    *counted += i64::from(*high) * if *forward { 1 } else { -1 };
                }
            }
            assert_eq!(*counted, steps, "at {at} ns: edges of axis {i}");
            if !self.off_while_moving {
                let offset_turns = axis.offset_eighths as f64 / 8.0;
                let (motor, crank) = axis.gear;
                let turns = f64::from(crank) / (f64::from(motor) * f64::from(axis.steps_per_turn));
                let whole = steps as f64 * turns;
                let off = moment.actual_turns[i] - offset_turns - whole;
                assert!(
                    off.abs() < 1e-9,
                    "at {at} ns: the crank of axis {i} is {off} turns off"
                );
            }
        }
    }
}

fn run(checked: &Checked, axes: &[Axis]) -> u64 {
    let mut exact = Exact {
        axes,
        master: 0,
        counters: vec![(false, true, 0); axes.len()],
        moved: 0,
        off_while_moving: false,
    };
    simulate(checked, &mut exact, |_, _| {}).expect("it runs");
    exact.moved
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// If this fails, a count is lost or added, and cranks drift apart without limit. The place may be
    /// a gear's remainder, a planner's fraction, or an edge at a change of direction or across a
    /// missed deadline.
    #[test]
    fn axis_is_where_the_master_puts_it(plan in any_plan()) {
        let checked = plan.scene().checked();
        let moved = run(&checked, &plan.axes);
        prop_assert!(moved > 0, "nothing moved, so nothing was shown");
    }
}

/// If this fails, the axes of the four patent machines or the default one differ by one step, or the
/// scenes' sense of rotation affects the phase. No chance is involved here.
#[test]
fn built_in_machines_are_exactly_in_phase() {
    for name in ["default", "patent-1", "patent-2", "patent-3", "patent-4"] {
        let checked = cophase_tests::built_in(name);
        let common = &checked.scene.axes;
        let axes: Vec<Axis> = (0..common.count)
            .map(|i| Axis {
                ratio: (1, 1),
                gear: (1, 1),
                offset_eighths: 0,
                steps_per_turn: common.steps_per_turn,
                reversed: checked.scene.resolved(i).own.reversed,
                servo: common.drive == Drive::Servo,
            })
            .collect();
        assert!(run(&checked, &axes) > 10_000, "{name} moves");
    }
}
