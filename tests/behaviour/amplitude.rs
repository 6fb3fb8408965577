//! The patent's four machines shake as hard as their programs require, measured by the platform's travel.
//!
//! At 100 and 200 Hz a control tick is a twentieth or a tenth of a turn. The largest `accel_mps2`, or a second derivative of
//! `z_m`, therefore misses the peak by percents. The rows show to many digits where the platform is (`z_m`) and where the
//! cranks are (`actual_turns_i`). The test first checks that every row's height is the mechanism's at that crank angle. Then
//! the mean speed over the turns of a hold gives the acceleration amplitude by the mechanism's geometry, differentiated
//! numerically here. The test uses neither `amax_commanded_mps2` nor the law ω = sqrt(amax / (R (1 + λ))).
//!
//! The machines also start from rest, where that law's slope has no limit.

use std::f64::consts::TAU;

use cophase_files::trace::{Every, Window};
use cophase_scene::library;
use cophase_tests::{Trace, built_in, record, scene};

/// The slider-crank: height of the joint over the crank axis.
#[derive(Clone, Copy, Debug)]
struct Mechanism {
    radius_m: f64,
    rod_m: f64,
}

impl Mechanism {
    /// R cos α + sqrt(L² − R² sin² α), from its value at a quarter turn, less the rod.
    fn travel_m(self, alpha: f64) -> f64 {
        let (sin, cos) = alpha.sin_cos();
        let rod = (self.rod_m.powi(2) - (self.radius_m * sin).powi(2)).sqrt();
        self.radius_m * cos + rod
    }

    /// The greatest |d²x/dα²| of a turn, by central differences of fourth order. With h = 0.02 the error is h⁴/90 of the
    /// sixth derivative. That is below 1e-7 of the second even at λ = 0.6. Rounding is 1e-16 L/h².
    fn max_second_derivative_m(self) -> f64 {
        const H: f64 = 0.02;
        let second = |alpha: f64| {
            let x = |steps: f64| self.travel_m(alpha + steps * H);
            (16.0 * (x(1.0) + x(-1.0)) - x(2.0) - x(-2.0) - 30.0 * x(0.0)) / (12.0 * H * H)
        };
        (0..3600)
            .map(|i| second(TAU * f64::from(i) / 3600.0).abs())
            .fold(0.0, f64::max)
    }
}

/// Ranges of rows in which the program requests a constant level.
fn holds(trace: &Trace) -> Vec<std::ops::Range<usize>> {
    let (program, running) = (trace.column("amax_requested_mps2"), trace.first("run"));
    let mut holds = Vec::new();
    let mut from = running.start;
    for row in running.start + 1..=running.end {
        if row == running.end || program[row] != program[from] {
            if row - from > 2000 {
                holds.push(from..row);
            }
            from = row;
        }
    }
    holds
}

/// If this fails, a machine built by the patent's tables shakes its load harder or softer than required.
#[test]
fn patent_machines_hold_their_amax() {
    for name in ["patent-1", "patent-2", "patent-3", "patent-4"] {
        let checked = built_in(name);
        let platform = checked.settings.machine.platform().unwrap();
        let radius_m = platform.crank_radius_m;
        let mechanism = Mechanism {
            radius_m,
            rod_m: radius_m / checked.scene.machine.as_ref().unwrap().lambda.unwrap(),
        };
        let trace = record(&checked, Every::Ticks(1), Window::FirstMotion).trace();
        let (turns, z_m) = (trace.axis("actual_turns", 0), trace.column("z_m"));
        // The platforms are below the cranks, so heights are negative. The trace's heights and turns end at 1e-9. An error
        // of 0.5e-9 turns is 2π R · 0.5e-9 of height, below 0.3e-9 m.
        let offset_m = -z_m[0] - mechanism.travel_m(0.0);
        for row in 0..trace.rows() {
            let off = -z_m[row] - mechanism.travel_m(turns[row] * TAU) - offset_m;
            assert!(
                off.abs() < 2e-9,
                "{name}: row {row} is {off} m from the mechanism's place"
            );
        }

        let holds = holds(&trace);
        assert_eq!(holds.len(), 2, "{name} holds two levels");
        for hold in holds {
            // The shaft has the first quarter of a second to reach its speed. Whole turns follow.
            let (from, last) = (hold.start + 500, hold.end - 1);
            let whole = (turns[last] - turns[from]).floor();
            let end = turns[from] + whole;
            let to = from + turns[from..].partition_point(|&turn| turn < end);
            // Between rows the crank turns evenly.
            let part = (end - turns[to - 1]) / (turns[to] - turns[to - 1]);
            let ticks = (to - 1 - from) as f64 + part;
            let omega = TAU * whole / (ticks / f64::from(checked.scene.control.tick_hz));
            let amax = mechanism.max_second_derivative_m() * omega * omega;
            let requested = trace.column("amax_requested_mps2")[from];
            let relative = amax / requested - 1.0;
            assert!(
                relative.abs() < 1e-4,
                "{name}: {amax} m/s² where {requested} was requested"
            );
        }
    }
}

/// If this fails, a motor is commanded at the start of a ramp to turn faster than it can. The root requires an angular
/// acceleration without limit there. It requires more than the machine's until well after the ramp has begun
/// (`docs/reproduced.md`; `host-sim/tests/published.rs` has the times).
#[test]
fn ramp_of_one_second_starts_within_limits() {
    for (name, full_g, full_hz, balance_s) in [
        ("patent-1", 200, 100.0, 8.59e-3),
        ("patent-4", 10, 5.0, 63.27e-3),
    ] {
        let built_in = library::find(name).expect("a built-in scene").text;
        let (machine, _) = built_in.split_once("[[program]]").expect("a program");
        let program = format!("[[program]]\namax_g = {full_g}\nramp_s = 1\nhold_s = 6\n");
        let checked = scene(&(machine.to_owned() + &program));
        let limits = &checked.scene.limits;
        let trace = record(&checked, Every::Ticks(1), Window::FirstMotion).trace();
        let (t_s, omega) = (trace.column("t_s"), trace.column("omega_rad_s"));
        let running = trace.first("run");
        let tick_s = 1.0 / f64::from(checked.scene.control.tick_hz);

        // At the time of the balance the root is w sqrt(t), and its slope is w / (2 sqrt(t)).
        let requested = |t: f64| TAU * full_hz * t.sqrt();
        let slope_hz_per_s = requested(balance_s) / (2.0 * balance_s) / TAU;
        assert!(
            slope_hz_per_s > 2.0 * limits.acceleration_hz_per_s,
            "{name}"
        );
        let at = running.start + (balance_s / tick_s).ceil() as usize;
        // The shaft starts from the slow turn that found the index pulses.
        let gained = omega[at] - omega[running.start];
        assert!(
            gained < 0.1 * requested(balance_s),
            "{name}: {gained} rad/s"
        );

        // The trace's speeds end at 1e-6 rad/s. A difference of three of them is off by up to four halves of that.
        let rounding = |order: i32| 2.0 * 1e-6 / tick_s.powi(order);
        for row in running.start + 2..running.end {
            let slope = (omega[row] - omega[row - 1]) / tick_s;
            let bend = (omega[row] - 2.0 * omega[row - 1] + omega[row - 2]) / tick_s.powi(2);
            let (max, max_jerk) = (
                TAU * limits.acceleration_hz_per_s,
                TAU * limits.jerk_hz_per_s2,
            );
            assert!(
                slope.abs() <= max + rounding(1),
                "{name}, {} s: {slope}",
                t_s[row]
            );
            assert!(
                bend.abs() <= max_jerk + rounding(2),
                "{name}, {} s: {bend}",
                t_s[row]
            );
        }
    }
}
