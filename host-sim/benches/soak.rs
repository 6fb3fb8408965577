//! Soak test over a month of operation: after any number of ticks, commanded phases are exactly equal and step totals
//! are exact.
//!
//! `cargo bench -p host-sim --bench soak -- --days 30` plays 30 days of 2 kHz ticks through the whole core
//! (a quarter of an hour). Without `--days` it plays a tenth of a day. The machine repeats a program of
//! several levels, so that speeds change and the phase wraps many times.
//!
//! The reference is kept here, in 128 bits: the sum of all turns of the master. Every simulated hour, each
//! axis's phase and steps are compared with the values that follow from this sum.

use std::time::Instant;

use cophase_core::signals::{Feedback, Output};
use cophase_core::supervisor::{Command, State};
use cophase_core::units::{FRACTION_BITS, Phase, Turns};
use cophase_scene::load;
use host_sim::checked::Checked;
use indicatif::ProgressBar;

const AXES: usize = 4;

/// Turns of each axis per turn of the master, as numerator and denominator. The first three are equal, mounted in either direction.
const RATIOS: [(i128, i128); AXES] = [(1, 1), (1, 1), (1, 1), (3, 7)];
/// Turns of each motor per turn of its axis, likewise.
const GEARS: [(i128, i128); AXES] = [(1, 1), (17, 9), (1, 1), (57, 11)];
const STEPS_PER_TURN: i128 = 3200;

const SCENE: &str = r#"
name = "soak"
cam = { law = "cycloid", rise_mm = 19.635, rise_deg = 180, dwell_deg = 0, return_deg = 180 }
limits = { speed_hz = 60, acceleration_hz_per_s = 60, jerk_hz_per_s2 = 600, band = [{ from_hz = 25, to_hz = 29 }] }
axes = { count = 4, drive = "stepper", steps_per_turn = 3200, index = false }
axis = [{ number = 1, reversed = true, gear = [17, 9] }, { number = 2, drive = "servo" }, { number = 3, ratio = [3, 7], gear = [57, 11] }]

[[program]]
repeat = 1000
segments = [
  { repeat = 1000, segments = [
    { amax_g = 15, ramp_s = 2, hold_s = 5.3 },
    { amax_g = 120, ramp_s = 3, hold_s = 17 },
    { amax_g = 0, ramp_s = 2, hold_s = 0.7, shape = "linear" },
  ] },
]
"#;

fn main() {
    let days = days();
    let checked = Checked::new(load::parse(SCENE).unwrap()).unwrap();
    let mut controller = checked.controller().unwrap();
    let tick_hz = u64::from(controller.tick_hz());
    let ticks = (days * 86_400.0 * tick_hz as f64) as u64;
    let bar = ProgressBar::new(ticks);
    let began = Instant::now();

    let mut truth = Truth::default();
    controller.tick(&Feedback::with_command(Some(Command::Start)));
    for tick in 1..=ticks {
        let output = controller.tick(&Feedback::with_command(None));
        truth.turned += i128::from(output.telemetry.motion.speed.to_bits());
        if tick.is_multiple_of(3600 * tick_hz) || tick == ticks {
            truth.check(output);
            bar.set_position(tick);
        }
    }
    bar.finish_and_clear();
    println!(
        "{days} days, {ticks} ticks, {:.0} turns, {} wraps of the phase: {} checks of {AXES} axes, all exact exactly ({:.0} s)",
        truth.turned as f64 / f64::exp2(f64::from(FRACTION_BITS)),
        truth.turned >> 64,
        truth.checks,
        began.elapsed().as_secs_f64(),
    );
}

/// Expected state of the axes.
#[derive(Default)]
struct Truth {
    /// Turns of the master, in the unit of [`Turns`].
    turned: i128,
    checks: u32,
}

impl Truth {
    fn check(&mut self, output: &Output) {
        let telemetry = &output.telemetry;
        assert_eq!(telemetry.state, State::Run, "the machine must be at work");
        for (axis, (numerator, denominator)) in RATIOS.into_iter().enumerate() {
            let turned = (self.turned * numerator).div_euclid(denominator);
            let phase = Phase::from_turns(Turns::from_bits(turned as i64)); // wraps like a phase
            assert_eq!(telemetry.axis_phase(axis), phase, "phase of axis {axis}");
            let (motor, shaft) = GEARS[axis];
            let steps = (turned * STEPS_PER_TURN * motor).div_euclid(shaft << FRACTION_BITS);
            assert_eq!(
                i128::from(telemetry.steps(axis)),
                steps,
                "steps of axis {axis}"
            );
        }
        self.checks += 1;
    }
}

/// Returns the days of `--days D`, a tenth of a day by default.
fn days() -> f64 {
    let mut arguments = std::env::args().skip_while(|argument| argument != "--days");
    match (arguments.next(), arguments.next().map(|days| days.parse())) {
        (None, _) => 0.1,
        (Some(_), Some(Ok(days))) if days > 0.0 => days,
        _ => panic!("--days takes a number of days, such as 30"),
    }
}
